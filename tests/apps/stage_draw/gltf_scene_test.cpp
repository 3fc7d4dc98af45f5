#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "apps/stage/director.h"
#include "apps/stage/stage.h"
#include "tests/support/temp_dir.h"
#include "tests/viz/meshes/gltf_sample.h"
#include "tests/viz/viz_fixture.h"

namespace kino::test {
namespace {

constexpr int kWidth = 96;
constexpr int kHeight = 64;

/// The sample's strip, 4 m each way in its own scene, opaque and without a texture.
std::string strip_file() {
    GltfSample sample = make_gltf_sample();
    nlohmann::json& material = sample.json["materials"][0];
    material.erase("alphaMode");
    material.erase("emissiveFactor");
    material["pbrMetallicRoughness"] = {
        {"baseColorFactor", {0.05, 0.1, 0.2, 1}}, {"metallicFactor", 0}, {"roughnessFactor", 1}};
    const auto bytes = sample.as_glb();
    return {bytes.begin(), bytes.end()};
}

double linear_of(std::uint8_t coded) {
    const double c = coded / 255.0;
    return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

class GltfSceneTest : public VizTest {
  protected:
    /// What a scene file with these meshes looks like from the origin, along -z.
    Image<Rgba8> draw(const std::string& meshes) {
        folder_.write("models/strip.glb", strip_file());
        const auto path =
            folder_.write("scene.json",
                          "{\"kinoscope_scene\": 1, \"name\": \"strips\", \"origin\": \"world\", "
                          "\"ambient\": \"#ffffff\", \"background_top\": \"#000000\", "
                          "\"background_bottom\": \"#000000\", \"materials\": [{\"name\": "
                          "\"paint\", \"color\": \"#804020\"}], \"meshes\": [" +
                              meshes + "]}");
        auto stage = open_stage(path.string());
        EXPECT_TRUE(stage) << (stage ? "" : stage.error().to_string());
        if (!stage) return {};
        Director director(std::move(*stage));
        director.step({.dt_s = 1.0 / 30});
        Scene scene;
        director.fill(scene);
        scene.color_mode = director.file().color;
        Renderer renderer(device());
        auto frame = renderer.render_to_image(scene,
                                              {.width = kWidth,
                                               .height = kHeight,
                                               .projection = perspective(0.8, kWidth, kHeight),
                                               .world_from_view = look_at({0, 0, 0}, {0, 0, -1})},
                                              {});
        EXPECT_TRUE(frame) << (frame ? "" : frame.error().to_string());
        return frame ? std::move(frame->picture) : Image<Rgba8>{};
    }

    TempDir folder_;
};

// The file's node is scaled by 2, the scene's mesh by a quarter: 1 m each way, standing on at_m.
TEST_F(GltfSceneTest, ModelStandsWhereTheSceneFilePutsIt) {
    const Image<Rgba8> picture =
        draw(R"({"shape": "gltf", "file": "models/strip.glb", "at_m": [0.4, -0.5, -3],
                 "scale": [0.25, 0.25, 0.25]})");
    ASSERT_EQ(picture.width(), kWidth);
    const Projection k = perspective(0.8, kWidth, kHeight);
    int inside = 0;
    for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
            const double at_x = (x - k.cx) / k.fx * 3;
            const double at_y = -(y - k.cy) / k.fy * 3;
            const double off = std::max(std::abs(at_x - 0.4), std::abs(at_y)) - 0.5;
            const Rgba8 p = picture.at(x, y);
            if (std::abs(off) < 0.03) continue;  // a pixel on the edge
            if (off > 0) {
                ASSERT_LE(std::max({p.r, p.g, p.b}), 1) << x << " " << y;
                continue;
            }
            ++inside;
            // Its own colour, as the file says it, under white light from everywhere.
            ASSERT_NEAR(linear_of(p.r), 0.05, 0.01);
            ASSERT_NEAR(linear_of(p.g), 0.1, 0.02);
            ASSERT_NEAR(linear_of(p.b), 0.2, 0.04);
        }
    }
    EXPECT_GT(inside, 300);
}

TEST_F(GltfSceneTest, ModelTakesTheScenesMaterial) {
    const Image<Rgba8> picture =
        draw(R"({"shape": "gltf", "file": "models/strip.glb", "at_m": [0, -0.5, -3],
                 "scale": [0.25, 0.25, 0.25], "material": "paint"})");
    const Rgba8 p = picture.at(kWidth / 2, kHeight / 2);
    EXPECT_NEAR(p.r, 0x80, 1);
    EXPECT_NEAR(p.g, 0x40, 1);
    EXPECT_NEAR(p.b, 0x20, 1);
}

TEST_F(GltfSceneTest, ModelsOutsideOfTheFolderAreRefused) {
    folder_.write("scene/scene.json",
                  R"({"kinoscope_scene": 1, "name": "thief",
                      "meshes": [{"shape": "gltf", "file": "../strip.glb"}]})");
    folder_.write("strip.glb", strip_file());
    const auto stage = open_stage((folder_ / "scene/scene.json").string());
    ASSERT_FALSE(stage);
    EXPECT_NE(stage.error().to_string().find("within the folder"), std::string::npos)
        << stage.error().to_string();
}

}  // namespace
}  // namespace kino::test
