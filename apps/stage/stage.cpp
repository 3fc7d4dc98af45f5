#include "apps/stage/stage.h"

#include <fmt/format.h>

#include <array>
#include <glm/gtc/matrix_transform.hpp>
#include <map>
#include <utility>

#include "apps/stage/bundled.h"
#include "apps/stage/cast.h"
#include "apps/stage/chance.h"
#include "apps/stage/stage_shapes.h"
#include "sensor/file_bytes.h"
#include "viz/surface/assets/gltf_loader.h"

namespace kino {
namespace {

Lobe lobe_of(const SceneLobe& file) {
    return {.kind = file.kind,
            .color = to_linear(file.color),
            .weight = static_cast<float>(file.weight),
            .roughness = static_cast<float>(file.roughness)};
}

Material material_of(const SceneMaterial& file) {
    Material material{.name = file.name,
                      .base_color = to_linear(file.color),
                      .emission = to_linear(file.color) * static_cast<float>(file.glow),
                      .opacity = static_cast<float>(file.opacity),
                      .kind = file.kind,
                      .steps = static_cast<std::uint32_t>(file.steps)};
    for (const SceneLayer& of_file : file.layers) {
        MaterialLayer& layer = material.layers.emplace_back();
        layer.transmission = to_linear(of_file.transmission);
        for (const SceneLobe& lobe : of_file.lobes) layer.lobes.push_back(lobe_of(lobe));
    }
    return material;
}

/// As in MeshNode: one more than the index.
std::uint32_t material_index(const SceneFile& file, const std::string& name) {
    for (std::size_t i = 0; i < file.materials.size(); ++i) {
        if (file.materials[i].name == name) return static_cast<std::uint32_t>(i + 1);
    }
    return file.materials.empty() ? 0 : 1;
}

/// A colour each, made once.
class GlowMaterials {
  public:
    explicit GlowMaterials(std::vector<Material>& materials) : materials_(materials) {}

    std::vector<std::uint32_t> of(const std::vector<SceneColor>& palette) {
        std::vector<std::uint32_t> indices;
        for (const SceneColor& color : palette.empty() ? std::vector<SceneColor>(1) : palette) {
            const std::array<int, 3> key = {color.r, color.g, color.b};
            const auto [found, is_new] =
                known_.emplace(key, static_cast<std::uint32_t>(materials_.size() + 1));
            if (is_new) {
                materials_.push_back(
                    {.name = fmt::format("glow #{:02x}{:02x}{:02x}", color.r, color.g, color.b),
                     .base_color = glm::vec3(0),
                     .emission = kStageGlow * to_linear(color)});
            }
            indices.push_back(found->second);
        }
        return indices;
    }

  private:
    std::vector<Material>& materials_;
    std::map<std::array<int, 3>, std::uint32_t> known_;
};

glm::dmat4 turn_of(const glm::dvec3& deg) {
    const glm::dvec3 rad = glm::radians(deg);
    glm::dmat4 turn = glm::rotate(glm::dmat4(1), rad.y, glm::dvec3(0, 1, 0));
    turn = glm::rotate(turn, rad.x, glm::dvec3(1, 0, 0));
    return glm::rotate(turn, rad.z, glm::dvec3(0, 0, 1));
}

/// Shapes that several objects have in common are made once.
class Workshop {
  public:
    Workshop(std::filesystem::path folder, std::vector<Material>& materials)
        : folder_(std::move(folder)), materials_(materials) {}

    /// The parts about the origin. `material` 0: the file's own, where it has any.
    Result<std::vector<StandingMesh>> parts(SceneShape shape, const glm::dvec3& size_m,
                                            const std::string& file, std::uint32_t material) {
        if (shape == SceneShape::gltf) {
            return model_parts(file, material);
        }
        auto& mesh = shapes_[{static_cast<int>(shape), size_m.x, size_m.y, size_m.z}];
        if (!mesh) mesh = make_stage_shape(shape, size_m);
        return std::vector<StandingMesh>{{.mesh = mesh, .material = material}};
    }

  private:
    /// A model at rest. Its materials come after those that are there.
    Result<std::vector<StandingMesh>> model_parts(const std::string& file, std::uint32_t material) {
        auto found = models_.find(file);
        if (found == models_.end()) {
            KINO_ASSIGN(const std::filesystem::path path, path_inside(folder_, file));
            KINO_ASSIGN(const GltfModel model, load_gltf(path));
            const auto first = static_cast<std::uint32_t>(materials_.size());
            materials_.insert(materials_.end(), model.materials.begin(), model.materials.end());
            std::vector<StandingMesh> parts;
            for (MeshNode& node : mesh_nodes(model, {.first_material = first})) {
                parts.push_back({.mesh = std::move(node.mesh),
                                 .stage_from_object = node.world_from_object,
                                 .material = node.material,
                                 .pose = std::move(node.pose)});
            }
            found = models_.emplace(file, std::move(parts)).first;
        }
        std::vector<StandingMesh> parts = found->second;
        for (StandingMesh& part : parts) {
            if (material != 0) part.material = material;
        }
        return parts;
    }

    std::filesystem::path folder_;
    std::vector<Material>& materials_;
    std::map<std::string, std::vector<StandingMesh>> models_;
    std::map<std::tuple<int, double, double, double>, std::shared_ptr<const MeshAsset>> shapes_;
};

}  // namespace

std::vector<glm::dmat4> mesh_places(const SceneMesh& mesh) {
    std::array<SceneRepeat, 3> rows;
    for (std::size_t i = 0; i < mesh.repeat.size(); ++i) rows[i] = mesh.repeat[i];
    const SceneScatter scatter = mesh.scatter.value_or(SceneScatter{});
    Chance chance(static_cast<std::uint64_t>(scatter.seed));
    std::vector<glm::dmat4> places;
    for (int k = 0; k < rows[2].count; ++k) {
        for (int j = 0; j < rows[1].count; ++j) {
            for (int i = 0; i < rows[0].count; ++i) {
                glm::dvec3 at = mesh.at_m + double(i) * rows[0].step_m +
                                double(j) * rows[1].step_m + double(k) * rows[2].step_m;
                glm::dvec3 turn = mesh.turn_deg;
                if (mesh.scatter) {
                    for (int axis = 0; axis < 3; ++axis) {
                        at[axis] += scatter.by_m[axis] * chance.between(-1, 1);
                    }
                    turn.y += scatter.turn_deg * chance.between(-1, 1);
                }
                places.push_back(
                    glm::scale(glm::translate(glm::dmat4(1), at) * turn_of(turn), mesh.scale));
            }
        }
    }
    return places;
}

Result<StageSet> make_stage(SceneFile file, const std::filesystem::path& folder) {
    StageSet stage;
    for (const SceneMaterial& material : file.materials) {
        stage.materials.push_back(material_of(material));
    }
    Workshop workshop(folder, stage.materials);
    for (const SceneMesh& mesh : file.meshes) {
        const std::uint32_t material = mesh.shape == SceneShape::gltf && mesh.material.empty()
                                           ? 0
                                           : material_index(file, mesh.material);
        KINO_ASSIGN(const auto parts, workshop.parts(mesh.shape, mesh.size_m, mesh.file, material));
        for (const glm::dmat4& place : mesh_places(mesh)) {
            for (StandingMesh part : parts) {
                part.stage_from_object = place * part.stage_from_object;
                stage.standing.push_back(std::move(part));
            }
        }
    }
    for (const SceneRole& role : file.roles) {
        StageProp& prop = stage.props.emplace_back();
        if (!role.prop) continue;
        for (const std::string& name : role.prop->materials) {
            prop.materials.push_back(material_index(file, name));
        }
        const bool own = role.prop->shape == SceneShape::gltf && prop.materials.empty();
        KINO_ASSIGN(prop.parts, workshop.parts(role.prop->shape, role.prop->size_m, role.prop->file,
                                               own ? 0 : material_index(file, {})));
    }
    GlowMaterials glow(stage.materials);
    for (const SceneSwarm& swarm : file.swarms) {
        stage.swarm_glow.push_back(swarm.bead_m > 0 ? glow.of(swarm.palette)
                                                    : std::vector<std::uint32_t>());
        if (swarm.bead_m > 0 && !stage.bead) {
            stage.bead = make_bead();
            stage.spark = make_spark();
        }
    }
    for (const SceneRole& role : file.roles) {
        const bool drawn = role.trail && role.trail->stroke_m > 0;
        stage.trail_glow.push_back(drawn ? glow.of(role.trail->palette)
                                         : std::vector<std::uint32_t>());
        if (drawn && !stage.stroke) stage.stroke = make_stroke();
    }
    std::size_t standing = stage.standing.size();
    for (std::size_t i = 0; i < stage.props.size(); ++i) {
        const SceneRole& role = file.roles[i];
        if (!role.prop) continue;
        const std::size_t joints = role.joints.empty() ? kJointCount : role.joints.size();
        standing += stage.props[i].parts.size() * static_cast<std::size_t>(role.prop->copies) *
                    joints * Cast::kPlaces;
    }
    if (standing > static_cast<std::size_t>(kMaxStageNodes)) {
        return fail(fmt::format("its models have {} parts in all, at most {} are possible",
                                standing, kMaxStageNodes),
                    file.name);
    }
    if (stage.materials.size() > kMaxMaterials - 1) {
        return fail(fmt::format("needs {} materials, glowing colours included; at most {} are "
                                "possible",
                                stage.materials.size(), kMaxMaterials - 1),
                    file.name, "fewer colours in palettes of trails and beads");
    }
    stage.file = std::move(file);
    return stage;
}

Result<StageSet> open_stage(const std::string& name_or_file) {
    if (const auto bundled = bundled_scene(name_or_file)) {
        KINO_ASSIGN(SceneFile file, scene_file_from_json(bundled->json, name_or_file));
        return make_stage(std::move(file), {});
    }
    std::error_code error;
    if (!std::filesystem::exists(name_or_file, error)) {
        return fail("there is no such scene or scene file", name_or_file,
                    "scenes:\n" + list_of_scenes());
    }
    KINO_ASSIGN(SceneFile file, read_scene_file(name_or_file));
    return make_stage(std::move(file), std::filesystem::path(name_or_file).parent_path());
}

std::uint32_t material_mask(const SceneFile& file, const std::vector<std::string>& names) {
    if (names.empty()) return ~0u;
    std::uint32_t mask = 0;
    for (const std::string& name : names) {
        mask |= 1u << (name == "live" ? 0 : material_index(file, name));
    }
    return mask;
}

}  // namespace kino
