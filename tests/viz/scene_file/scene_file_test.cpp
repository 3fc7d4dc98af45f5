#include "viz/scene/scene_file.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "fuzz/target.h"
#include "tests/support/random.h"
#include "tests/support/temp_dir.h"

namespace kino {
namespace {

using nlohmann::json;
using testing::HasSubstr;

std::vector<std::filesystem::path> bundled_files() {
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator("scenes")) {
        const std::string name = entry.path().filename().string();
        if (name.ends_with(".json") && name != "scene.schema.json") files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
    return files;
}

/// Everything that can be in a scene file, with values that are no defaults.
SceneFile everything() {
    SceneFile file{.name = "all \"kinds\"", .about = "äß", .origin = SceneOrigin::world};
    file.color = ColorMode::mixed;
    file.exposure = 0.1 + 0.2;
    file.live = {
        .show = SceneShow::all, .style = DepthStyle::cloud, .splat_px = 7, .margin_m = 0.3};
    file.effects.skeleton = true;
    file.camera.window = SceneWindow{.size_m = {1.0 / 3, 0.2},
                                     .at_m = {0.1, 1, -2},
                                     .turn_deg = -30,
                                     .sensor_m = {0, -0.25, 0.01},
                                     .sensor_tilt_deg = 7.5,
                                     .eye_m = {0.1, 0.1, 0.7},
                                     .deflect = SceneDeflect::depth_warp,
                                     .most_zoom = 3};
    file.quality = {
        .lod = 2.5, .zoom_by = SceneZoomBy::head, .most_zoom = 3, .target_ms = 50.5, .fix = 0.05};
    file.materials = {{.name = "a", .color = {1, 2, 3}, .glow = 1.5, .opacity = 0.25},
                      {.name = "b"}};
    for (const LobeKind kind :
         {LobeKind::lambert, LobeKind::oren_nayar, LobeKind::ggx, LobeKind::rim}) {
        file.materials[0].layers.push_back(
            {.lobes = {{.kind = kind, .weight = 1e-3, .roughness = 0.7}},
             .transmission = {9, 8, 7}});
    }
    for (int shape = 0; shape < 8; ++shape) {
        file.meshes.push_back({.shape = static_cast<SceneShape>(shape),
                               .file = shape == 7 ? "models/chair.glb" : "",
                               .material = shape % 2 == 0 ? "a" : "",
                               .turn_deg = {1, -2, 359.999},
                               .repeat = {{.count = 3, .step_m = {0, 1.0 / 3, 0}}},
                               .scatter = SceneScatter{.seed = 5, .turn_deg = 12}});
    }
    file.lights = {{.kind = LightKind::directional, .direction = {0, -1, 1e-5}},
                   {.kind = LightKind::spot,
                    .cone_deg = {0, 89},
                    .shadow = true,
                    .indirect = true,
                    .only = {"live", "b"}}};
    file.swarms = {{.count = 17,
                    .fill_to = 30,
                    .when = SceneWhen::idle,
                    .movement = SceneMovement::rise,
                    .palette = {{255, 0, 1}},
                    .bead_m = 0.01,
                    .shadow = true}};
    file.roles = {
        {.joints = {Joint::hand_left, Joint::head},
         .people = 6,
         .aim = SceneAim::limb,
         .palette = {{1, 1, 1}, {2, 2, 2}},
         .light = SceneLight{.kind = LightKind::spot},
         .trail = SceneTrail{.lights = 9, .palette = {{3, 3, 3}}},
         .prop = SceneProp{.shape = SceneShape::chair, .materials = {"b", "a"}, .copies = 3}}};
    return file;
}

TEST(SceneFileTest, WhatIsWrittenReadsBackToTheSame) {
    std::vector<SceneFile> files = {SceneFile{}, everything()};
    for (const SceneZoomBy by : {SceneZoomBy::reactive, SceneZoomBy::predictive}) {
        files.emplace_back().quality = {.zoom_by = by, .samples = 4};
    }
    files.emplace_back().quality = {.lod_by = SceneLodBy::budget, .zoom = 3};
    for (const SceneFile& file : files) {
        const std::string text = scene_file_to_json(file);
        const auto back = scene_file_from_json(text, "x");
        ASSERT_TRUE(back.has_value()) << back.error().to_string();
        EXPECT_TRUE(*back == file) << text;
        EXPECT_EQ(scene_file_to_json(*back), text);
    }
}

TEST(SceneFileTest, WhatIsNotThereKeepsItsDefault) {
    const auto read = scene_file_from_json(R"({"kinoscope_scene": 1})", "x");
    ASSERT_TRUE(read.has_value()) << read.error().to_string();
    EXPECT_TRUE(*read == SceneFile{});
}

TEST(SceneFileTest, EveryBundledSceneLoadsAndHasASentence) {
    const auto files = bundled_files();
    EXPECT_GE(files.size(), 7u);
    for (const auto& path : files) {
        const auto read = read_scene_file(path);
        ASSERT_TRUE(read.has_value()) << read.error().to_string();
        EXPECT_EQ(read->name + ".json", path.filename().string());
        EXPECT_GT(read->about.size(), 20u);
        EXPECT_THAT(test::read_bytes("docs/scenes.md"), HasSubstr(read->name));
    }
}

struct Mistake {
    const char* text;  ///< after {"kinoscope_scene": 1,
    const char* where;
    const char* what;
};

TEST(SceneFileTest, MistakesNameTheirJsonPointerAndWhatIsAllowed) {
    const std::vector<Mistake> mistakes = {
        {R"("lamps": [])", "#/lamps", "unknown key \"lamps\""},
        {R"("a/b~c": 1)", "#/a~1b~0c", "unknown key"},
        {R"("lights": [{}, {}, {}, {"raduis": 1}])", "#/lights/3/raduis", "unknown key"},
        {R"("lights": [{}, {}, {}, {"radius_m": "1"}])", "#/lights/3/radius_m",
         "from 0.01 to 1000"},
        {R"("lights": [{"radius_m": 0}])", "#/lights/0/radius_m", "from 0.01 to 1000"},
        {R"("lights": [{"radius_m": -1}])", "#/lights/0/radius_m", "from 0.01 to 1000"},
        {R"("lights": [{"radius_m": null}])", "#/lights/0/radius_m", "number"},
        {R"("lights": [{"color": "red"}])", "#/lights/0/color", "colour"},
        {R"("lights": [{"color": "#ff00zz"}])", "#/lights/0/color", "colour"},
        {R"("lights": [{"kind": "laser"}])", "#/lights/0/kind", "directional, point, spot"},
        {R"("lights": [{"shadow": 1}])", "#/lights/0/shadow", "true or false"},
        {R"("lights": [{"at_m": [0, 1]}])", "#/lights/0/at_m", "3 numbers"},
        {R"("lights": [{"at_m": [0, 1, "2"]}])", "#/lights/0/at_m/2", "number"},
        {R"("lights": [{"at_m": [0, 1, 101]}])", "#/lights/0/at_m/2", "-100 to 100"},
        {R"("lights": [{"kind": "spot", "direction": [0, 0, 0]}])", "#/lights/0/direction",
         "length"},
        {R"("lights": [{"cone_deg": [30, 20]}])", "#/lights/0/cone_deg", "must not fall"},
        {R"("lights": [{"indirect": true}])", "#/lights/0/indirect", "only spots"},
        {R"("lights": [{"only": ["live", "gold"]}])", "#/lights/0/only/1", "no material \"gold\""},
        {R"("lights": {})", "#/lights", "list"},
        {R"("lights": [7])", "#/lights/0", "object"},
        {R"("exposure": 1e999)", "", "JSON"},
        {R"("live": {"splat_px": 2.5})", "#/live/splat_px", "whole number from 1 to 32"},
        {R"("live": {"splat_px": 18446744073709551615})", "#/live/splat_px", "whole number"},
        {R"("effects": {"bloom": true})", "#/effects/bloom", "unknown key"},
        {R"("camera": {"eye_m": [0, 1, 0], "target_m": [0, 1, 0]})", "#/camera", "apart"},
        {R"("materials": [{"name": "a"}, {"name": "a"}])", "#/materials/1/name", "twice"},
        {R"("materials": [{}])", "#/materials/0/name", "empty"},
        {R"("materials": [{"name": "live"}])", "#/materials/0/name", "person"},
        {R"("meshes": [{}])", "#/meshes/0/material", "no material"},
        {R"("meshes": [{"material": "gold"}])", "#/meshes/0/material", "no material \"gold\""},
        {R"("meshes": [{"shape": "gltf"}])", "#/meshes/0/file", "gltf"},
        {R"("meshes": [{"shape": "gltf", "file": "/etc/passwd"}])", "#/meshes/0/file", "within"},
        {R"("meshes": [{"shape": "gltf", "file": "a/../../b.glb"}])", "#/meshes/0/file", "within"},
        {R"("meshes": [{"shape": "gltf", "file": "..\\b.glb"}])", "#/meshes/0/file", "within"},
        {R"("meshes": [{"shape": "gltf", "file": "a\u0000.glb"}])", "#/meshes/0/file", "within"},
        {R"("materials": [{"name": "a"}], "meshes": [{"repeat": [{"count": 512}, {"count": 512}]}])",
         "#/meshes/0/repeat", "more than 8192"},
        {R"("swarms": [{"count": 4096}, {"count": 1}])", "#", "4097 lights"},
        {R"("swarms": [{"count": 0}])", "#/swarms/0/count", "from 1 to 4096"},
        {R"("swarms": [{"intensity": [2, 1]}])", "#/swarms/0/intensity", "must not fall"},
        {R"("roles": [{}])", "#/roles/0", "light, a trail or a prop"},
        {R"("roles": [{"joints": ["tail"], "light": {}}])", "#/roles/0/joints/0", "hip_center"},
        {R"("roles": [{"joints": ["head", "head"], "light": {}}])", "#/roles/0/joints", "differ"},
        {R"("roles": [{"light": {"kind": "directional"}}])", "#/roles/0/light/kind", "has a place"},
        {R"("roles": [{"trail": {"lights": 257}}])", "#/roles/0/trail/lights", "from 1 to 256"},
        {R"("lights": [{"at_m": [0, 1, 2, 3]}])", "#/lights/0/at_m", "3 numbers"},
        {R"("lights": [{"color": "#ff800000"}])", "#/lights/0/color", "colour"},
        {R"("lights": [{"kind": "directional", "indirect": true}])", "#/lights/0/indirect",
         "only spots"},
        {R"("name": "abcdefghijklmnopqrstuvwxyzabcdefghijklmnopqrstuvwxyzabcdefghijklm")", "#/name",
         "at most 64"},
        {R"("swarms": [{}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}])",
         "#/swarms", "at most 16"},
        {R"("materials": [{"name": "a"}], "meshes": [{}, {"repeat": [{"count": 512}, {"count": 16}]}])",
         "#", "8193 meshes"},
        {R"("roles": [{"light": {"only": ["gold"]}}])", "#/roles/0/light/only/0", "no material"},
        {R"("roles": [{"prop": {"shape": "gltf"}}])", "#/roles/0/prop/file", "gltf"},
        {R"("roles": [{"prop": {}}])", "#/roles/0/prop/materials", "no material"},
        {R"("roles": [{"prop": {"materials": ["gold"]}}])", "#/roles/0/prop/materials/0",
         "no material \"gold\""},
        {R"("quality": {"lod": "fast"})", "#/quality/lod", "a number from 1 to 8, or auto"},
        {R"("quality": {"lod": 0.99})", "#/quality/lod", "a number from 1 to 8, or auto"},
        {R"("quality": {"lod": null})", "#/quality/lod", "a number from 1 to 8, or auto"},
        {R"("quality": {"lod": ["auto"]})", "#/quality/lod", "a number from 1 to 8, or auto"},
        {R"("quality": {"zoom": 9})", "#/quality/zoom",
         "from 1 to 8, or reactive, predictive, head"},
        {R"("quality": {"zoom": 1.5})", "#/quality/zoom", "whole number from 1 to 8"},
        {R"("quality": {"zoom": 18446744073709551615})", "#/quality/zoom", "whole number"},
        {R"("quality": {"zoom": "Reactive"})", "#/quality/zoom", "reactive"},
        {R"("quality": {"zoom": ""})", "#/quality/zoom", "reactive"},
        {R"("quality": {"most_zoom": 0})", "#/quality/most_zoom", "from 1 to 8"},
        {R"("quality": {"samples": 2})", "#/quality/samples", "one of 1, 4"},
        {R"("quality": {"samples": "4"})", "#/quality/samples", "one of 1, 4"},
        {R"("quality": {"samples": 4.5})", "#/quality/samples", "one of 1, 4"},
        {R"("quality": {"target_ms": 0})", "#/quality/target_ms", "from 1 to 1000"},
        {R"("quality": {"lod": 2, "fix": 0.51})", "#/quality/fix", "from 0 to 0.5"},
        {R"("quality": {"fix": 0.1})", "#/quality/fix", "unless light is coarse"},
        {R"("quality": {"lod": "auto", "zoom": "head"})", "#/quality/zoom", "chooses both"},
        {R"("quality": {"tier": 2})", "#/quality/tier", "known: lod, zoom"},
        {R"("name": "a", "name": "b")", "", "twice"},
    };
    for (const Mistake& mistake : mistakes) {
        const std::string text = fmt::format("{{\"kinoscope_scene\": 1, {}}}", mistake.text);
        const auto read = scene_file_from_json(text, "x");
        ASSERT_FALSE(read.has_value()) << text;
        EXPECT_EQ(read.error().where, std::string("x") + mistake.where) << text;
        EXPECT_THAT(read.error().what + "; " + read.error().hint, HasSubstr(mistake.what)) << text;
    }
    EXPECT_EQ(scene_file_from_json("{}", "x").error().where, "x#");
    EXPECT_EQ(scene_file_from_json(R"({"kinoscope_scene": 2})", "x").error().where,
              "x#/kinoscope_scene");
    EXPECT_EQ(scene_file_from_json("[]", "x").error().what, "must be an object");
}

TEST(SceneFileTest, PointLightsNeedNoDirection) {
    const auto read = scene_file_from_json(
        R"({"kinoscope_scene": 1, "lights": [{"direction": [0, 0, 0]}]})", "x");
    EXPECT_TRUE(read.has_value()) << read.error().to_string();
}

TEST(SceneFileTest, CountsWhatMayBurnAndStandAtOnce) {
    SceneFile file;
    file.meshes = {{}, {.repeat = {{.count = 3}, {.count = 2}}}};
    file.lights = {{.kind = LightKind::directional}, {}};
    file.swarms = {{.count = 10, .bead_m = 0.01}, {.count = 5}};
    file.roles = {
        {.joints = {Joint::head, Joint::spine},
         .people = 3,
         .light = SceneLight{},
         .trail = SceneTrail{.lights = 4},
         .prop = SceneProp{.copies = 2}},
        {.joints = {Joint::head}, .people = 1, .trail = SceneTrail{.lights = 7, .stroke_m = 0}},
        {.joints = {}, .people = 2, .light = SceneLight{}}};
    const SceneCount count = largest_count(file);
    EXPECT_EQ(count.lights, 1 + 15 + (6 + 6 * 4) + 7 + 2 * static_cast<int>(kJointCount));
    EXPECT_EQ(count.nodes, 7 + 10 + (6 * 4 + 6 * 2));
}

TEST(SceneFileTest, HostileTextsEndEarly) {
    const auto nested = [](int depth) {
        return R"({"kinoscope_scene": 1, "meshes": )" +
               std::string(static_cast<std::size_t>(depth), '[') +
               std::string(static_cast<std::size_t>(depth), ']') + "}";
    };
    EXPECT_THAT(scene_file_from_json(nested(100'000), "x").error().what, HasSubstr("deeper"));
    EXPECT_THAT(scene_file_from_json(nested(kMaxSceneFileDepth), "x").error().what,
                HasSubstr("deeper"));
    EXPECT_THAT(scene_file_from_json(nested(kMaxSceneFileDepth - 1), "x").error().what,
                HasSubstr("object"));
    // Brackets within texts are no depth.
    const std::string quoted =
        R"({"kinoscope_scene": 1, "about": "\")" + std::string(100, '[') + "\"}";
    EXPECT_TRUE(scene_file_from_json(quoted, "x").has_value());
    EXPECT_THAT(scene_file_from_json(std::string(kMaxSceneFileBytes + 1, ' '), "x").error().what,
                HasSubstr("longer"));
    const test::TempDir temp;
    const auto file = temp.write("huge.json", std::string(kMaxSceneFileBytes + 1, ' '));
    EXPECT_FALSE(read_scene_file(file).has_value());
    EXPECT_FALSE(read_scene_file(temp / "none.json").has_value());
}

TEST(SceneFileTest, TheSchemaInTheFolderIsTheReadersOwn) {
    if (std::getenv("KINO_UPDATE_GOLDENS") != nullptr) {
        std::ofstream("scenes/scene.schema.json") << scene_file_schema();
    }
    EXPECT_EQ(test::read_bytes("scenes/scene.schema.json"), scene_file_schema())
        << "KINO_UPDATE_GOLDENS=1 writes it anew";
}

/// As much of JSON Schema as ours uses; the pointer of what does not fit, or empty.
std::string misfit(const json& schema, const json& value, const std::string& at = "") {
    if (schema.contains("enum")) {
        for (const json& word : schema["enum"]) {
            if (word == value) return {};
        }
        return at;
    }
    if (schema.contains("anyOf")) {
        for (const json& way : schema["anyOf"]) {
            if (misfit(way, value, at).empty()) return {};
        }
        return at;
    }
    const std::string type = schema.at("type");
    if (type == "object") {
        if (!value.is_object()) return at;
        for (const auto& [key, inner] : value.items()) {
            if (!schema["properties"].contains(key)) return at + "/" + key;
            const std::string place = misfit(schema["properties"][key], inner, at + "/" + key);
            if (!place.empty()) return place;
        }
        for (const json& key : schema.value("required", json::array())) {
            if (!value.contains(key)) return at + "/";
        }
    } else if (type == "array") {
        if (!value.is_array() || value.size() > schema.at("maxItems") ||
            value.size() < schema.value("minItems", 0u)) {
            return at;
        }
        for (std::size_t i = 0; i < value.size(); ++i) {
            const std::string place =
                misfit(schema.at("items"), value[i], fmt::format("{}/{}", at, i));
            if (!place.empty()) return place;
        }
    } else if (type == "number" || type == "integer") {
        const bool fits = type == "number" ? value.is_number() : value.is_number_integer();
        if (!fits || value < schema.at("minimum") || value > schema.at("maximum")) return at;
    } else if (type == "boolean") {
        if (!value.is_boolean()) return at;
    } else if (!value.is_string()) {
        return at;
    }
    return {};
}

TEST(SceneFileTest, SchemaAndReaderAgree) {
    const json schema = json::parse(scene_file_schema());
    for (const auto& path : bundled_files()) {
        EXPECT_EQ(misfit(schema, json::parse(test::read_bytes(path))), "") << path;
    }
    const json full = json::parse(scene_file_to_json(everything()));
    EXPECT_EQ(misfit(schema, full), "");
    // Spoilt by chance: what the schema refuses the reader refuses, too, in the same place.
    test::Random random(5);
    const std::vector<json> odd = {-1e9,           1e9, "gold", nullptr, true, json::array(),
                                   json::object(), 2.5, 0,      "#00"};
    int refused = 0;
    for (int round = 0; round < 600; ++round) {
        json spoilt = full;
        json* at = &spoilt;
        std::string pointer;
        while (at->is_structured() && !at->empty() && (pointer.empty() || !random.chance(0.2))) {
            auto child = at->begin();
            std::advance(child, random.integer(0, static_cast<int>(at->size()) - 1));
            pointer += at->is_object() ? "/" + child.key()
                                       : fmt::format("/{}", std::distance(at->begin(), child));
            at = &*child;
        }
        *at = odd[static_cast<std::size_t>(random.integer(0, static_cast<int>(odd.size()) - 1))];
        const std::string place = misfit(schema, spoilt);
        if (place.empty()) continue;
        ++refused;
        const auto read = scene_file_from_json(spoilt.dump(), "x");
        ASSERT_FALSE(read.has_value()) << pointer << " " << at->dump();
        if (pointer == place && !place.starts_with("/kino")) {
            EXPECT_EQ(read.error().where, "x#" + place) << at->dump();
        }
    }
    EXPECT_GT(refused, 200);
}

TEST(SceneFileTest, SeededMutationsNeverCrash) {
    std::vector<std::string> seeds = {scene_file_to_json(everything())};
    for (const auto& path : bundled_files()) seeds.push_back(test::read_bytes(path));
    const std::vector<std::string> words = {
        "NaN", "null",   "1e999",   "-1", "[", "{", "\"",       "true",
        "]",   "1e-320", "\\ud800", ",",  "}", ":", "\"live\"", "18446744073709551615"};
    test::Random random(6);
    for (int i = 0; i < 1500; ++i) {
        std::string text = seeds[static_cast<std::size_t>(i) % seeds.size()];
        for (int n = random.integer(1, 4); n > 0 && !text.empty(); --n) {
            const auto at =
                static_cast<std::size_t>(random.integer(0, static_cast<int>(text.size()) - 1));
            switch (random.integer(0, 3)) {
                case 0:
                    text[at] = static_cast<char>(random.integer(0, 255));
                    break;
                case 1:
                    text.insert(at, words[static_cast<std::size_t>(random.integer(0, 15))]);
                    break;
                case 2:
                    text.erase(at, static_cast<std::size_t>(random.integer(1, 12)));
                    break;
                default:
                    if (i % 7 == 0) text.resize(at);
            }
        }
        fuzz::scene_file({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
    }
}

}  // namespace
}  // namespace kino
