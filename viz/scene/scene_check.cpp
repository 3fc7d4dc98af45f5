#include "viz/scene/scene_check.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <set>

namespace kino {
namespace {

/// Says what is wrong with one thing and where.
class SceneChecker {
  public:
    SceneChecker(const SceneFile& file, const std::string& where) : file_(file), where_(where) {}

    Result<void> run() {
        KINO_TRY(materials());
        for (std::size_t i = 0; i < file_.meshes.size(); ++i) {
            KINO_TRY(mesh(file_.meshes[i], fmt::format("/meshes/{}", i)));
        }
        for (std::size_t i = 0; i < file_.lights.size(); ++i) {
            KINO_TRY(light(file_.lights[i], fmt::format("/lights/{}", i)));
        }
        for (std::size_t i = 0; i < file_.roles.size(); ++i) {
            KINO_TRY(role(file_.roles[i], fmt::format("/roles/{}", i)));
        }
        if (glm::distance(file_.camera.eye_m, file_.camera.target_m) < 0.01) {
            return wrong("/camera", "eye_m and target_m must be apart");
        }
        KINO_TRY(quality(file_.quality));
        const SceneCount count = largest_count(file_);
        if (count.lights > kMaxStageLights) {
            return wrong("", fmt::format("has {} lights, at most {} are allowed", count.lights,
                                         kMaxStageLights));
        }
        if (count.nodes > kMaxStageNodes) {
            return wrong("", fmt::format("has {} meshes, at most {} are allowed", count.nodes,
                                         kMaxStageNodes));
        }
        return {};
    }

  private:
    [[nodiscard]] tl::unexpected<Error> wrong(const std::string& pointer, std::string what) const {
        return fail(std::move(what), where_ + "#" + pointer);
    }

    Result<void> materials() {
        for (std::size_t i = 0; i < file_.materials.size(); ++i) {
            const std::string& name = file_.materials[i].name;
            const std::string pointer = fmt::format("/materials/{}/name", i);
            if (name.empty()) return wrong(pointer, "must not be empty");
            if (name == "live") return wrong(pointer, "\"live\" stands for the person");
            if (!names_.insert(name).second) return wrong(pointer, "is there twice");
        }
        return {};
    }

    Result<void> known(const std::string& name, const std::string& pointer) {
        if (names_.contains(name)) return {};
        return wrong(pointer, fmt::format("there is no material \"{}\"", name));
    }

    /// Within the scene file's folder, also once it is made plain.
    Result<void> path(SceneShape shape, const std::string& file, const std::string& pointer) {
        if ((shape == SceneShape::gltf) == file.empty()) {
            return wrong(pointer, "must be there for the shape gltf, and only for it");
        }
        const std::filesystem::path path(file);
        bool inside = path.is_relative() && file.find('\0') == std::string::npos &&
                      file.find('\\') == std::string::npos;
        for (const auto& part : path) inside = inside && part != "..";
        if (!inside) return wrong(pointer, "must be a path within the folder of the scene file");
        return {};
    }

    Result<void> mesh(const SceneMesh& mesh, const std::string& at) {
        KINO_TRY(path(mesh.shape, mesh.file, at + "/file"));
        if (!mesh.material.empty()) KINO_TRY(known(mesh.material, at + "/material"));
        if (mesh.material.empty() && mesh.shape != SceneShape::gltf && names_.empty()) {
            return wrong(at + "/material", "there is no material");
        }
        if (copies_of(mesh) > kMaxStageNodes) {
            return wrong(at + "/repeat", fmt::format("makes more than {} copies", kMaxStageNodes));
        }
        return {};
    }

    Result<void> light(const SceneLight& light, const std::string& at) {
        if (light.kind != LightKind::point && !(glm::length(light.direction) > 1e-6)) {
            return wrong(at + "/direction", "must have a length");
        }
        if (light.kind != LightKind::spot && light.indirect) {
            return wrong(at + "/indirect", "only spots can be indirect");
        }
        for (std::size_t i = 0; i < light.only.size(); ++i) {
            if (light.only[i] == "live") continue;
            KINO_TRY(known(light.only[i], fmt::format("{}/only/{}", at, i)));
        }
        return {};
    }

    Result<void> role(const SceneRole& role, const std::string& at) {
        if (!role.light && !role.trail && !role.prop) {
            return wrong(at, "must have a light, a trail or a prop");
        }
        if (std::set<Joint>(role.joints.begin(), role.joints.end()).size() != role.joints.size()) {
            return wrong(at + "/joints", "must differ");
        }
        if (role.light) KINO_TRY(light(*role.light, at + "/light"));
        if (role.light && role.light->kind == LightKind::directional) {
            return wrong(at + "/light/kind", "must be point or spot: it has a place");
        }
        if (!role.prop) return {};
        KINO_TRY(path(role.prop->shape, role.prop->file, at + "/prop/file"));
        for (std::size_t i = 0; i < role.prop->materials.size(); ++i) {
            KINO_TRY(known(role.prop->materials[i], fmt::format("{}/prop/materials/{}", at, i)));
        }
        if (role.prop->materials.empty() && role.prop->shape != SceneShape::gltf &&
            names_.empty()) {
            return wrong(at + "/prop/materials", "there is no material");
        }
        return {};
    }

    /// A frame's time has one owner.
    Result<void> quality(const SceneQuality& quality) {
        const bool budget = quality.lod_by == SceneLodBy::budget;
        if (budget && quality.zoom_by != SceneZoomBy::fixed) {
            return wrong("/quality/zoom", "must be a number where lod is auto: that chooses both");
        }
        if (!budget && !(quality.lod > 1) && quality.fix > 0) {
            return wrong("/quality/fix", "must be 0 unless light is coarse");
        }
        return {};
    }

    const SceneFile& file_;
    const std::string& where_;
    std::set<std::string> names_;
};

}  // namespace

glm::vec3 to_linear(const SceneColor& color) {
    const auto channel = [](std::uint8_t byte) {
        const double v = byte / 255.0;
        return static_cast<float>(v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4));
    };
    return {channel(color.r), channel(color.g), channel(color.b)};
}

int copies_of(const SceneMesh& mesh) {
    std::int64_t copies = 1;
    for (const SceneRepeat& repeat : mesh.repeat) copies *= repeat.count;
    return static_cast<int>(std::min<std::int64_t>(copies, INT32_MAX));
}

SceneCount largest_count(const SceneFile& file) {
    std::int64_t lights = 0, nodes = 0;
    for (const SceneMesh& mesh : file.meshes) nodes += copies_of(mesh);
    for (const SceneLight& light : file.lights) lights += light.kind != LightKind::directional;
    for (const SceneSwarm& swarm : file.swarms) {
        lights += swarm.count;
        if (swarm.bead_m > 0) nodes += swarm.count;
    }
    for (const SceneRole& role : file.roles) {
        const auto joints =
            static_cast<std::int64_t>(role.joints.empty() ? kJointCount : role.joints.size());
        const std::int64_t places = joints * role.people;
        if (role.light) lights += places;
        if (role.trail) {
            lights += places * role.trail->lights;
            if (role.trail->stroke_m > 0) nodes += places * role.trail->lights;
        }
        if (role.prop) nodes += places * role.prop->copies;
    }
    const auto fits = [](std::int64_t n) {
        return static_cast<int>(std::min<std::int64_t>(n, INT32_MAX));
    };
    return {fits(lights), fits(nodes)};
}

Result<void> check_scene_file(const SceneFile& file, const std::string& where) {
    return SceneChecker(file, where).run();
}

}  // namespace kino
