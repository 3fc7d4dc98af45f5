#pragma once

#include <array>
#include <cstdint>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "viz/scene/material.h"
#include "viz/scene/mesh_asset.h"
#include "viz/scene/scene.h"

namespace kino {

/// A node's place in its parent, in the parts that animations move.
struct GltfPlace {
    glm::dvec3 translation{0};
    glm::dquat rotation{1, 0, 0, 0};
    glm::dvec3 scale{1};

    [[nodiscard]] glm::dmat4 matrix() const;
};

struct GltfNode {
    std::string name;
    int parent = -1;                   ///< index of a node before this one; -1: a root
    GltfPlace place;                   ///< at rest
    std::optional<glm::dmat4> matrix;  ///< of nodes that are placed by one, instead of `place`
    std::vector<int> meshes;           ///< into GltfModel::meshes
    int skin = -1;
};

struct GltfMesh {
    std::shared_ptr<const MeshAsset> asset;
    int material = -1;  ///< into GltfModel::materials; -1: none
};

struct GltfSkin {
    std::vector<MeshJoint> joints;  ///< parents first, as MeshAsset::joints count them
    std::vector<int> nodes;         ///< the node of each joint
};

enum class GltfPath : std::uint8_t { translation, rotation, scale };
enum class GltfInterpolation : std::uint8_t { step, linear, cubic };

struct GltfChannel {
    int node = 0;
    GltfPath path = GltfPath::translation;
    GltfInterpolation interpolation = GltfInterpolation::linear;
    std::vector<double> times_s;     ///< rising strictly
    std::vector<glm::dvec4> values;  ///< one a time; cubic: in-tangent, value, out-tangent
};

struct GltfAnimation {
    std::string name;
    double duration_s = 0;
    std::vector<GltfChannel> channels;
};

/// A glTF file's first scene, checked: indices lie in range, meshes keep MeshAsset's invariants,
/// nodes form trees. Model space: metres, y up.
struct GltfModel {
    std::vector<GltfNode> nodes;  ///< parents first
    std::vector<GltfMesh> meshes;
    std::vector<Material> materials;
    std::vector<GltfSkin> skins;
    std::vector<GltfAnimation> animations;
    /// What was in the file and is not in here, or was mended; for the user.
    std::vector<std::string> notes;

    /// Index of the animation called `name`; -1: none.
    [[nodiscard]] int find_animation(const std::string& name) const;
};

/// Where every node is at `time_s` of an animation (null: at rest), model_from_node. Times before
/// the first key take its value, times behind the last key the last one; see loop_time().
[[nodiscard]] std::vector<glm::dmat4> model_from_nodes(const GltfModel& model,
                                                       const GltfAnimation* animation,
                                                       double time_s);

/// `time_s` within an animation that repeats; 0 where it has no length.
[[nodiscard]] double loop_time(const GltfAnimation& animation, double time_s);

/// MeshNode::pose of a skin, in model space.
[[nodiscard]] std::vector<glm::mat4> pose_of(const GltfSkin& skin,
                                             std::span<const glm::dmat4> model_from_node);

/// The scene nodes of a model put at `world_from_model`. Ids count up from `first_id`; materials
/// from `first_material`, the index (into Scene::materials) that the model's first one got.
/// Skinned meshes get a pose.
struct GltfInstance {
    glm::dmat4 world_from_model{1};
    std::uint32_t first_id = 1;
    std::uint32_t first_material = 0;
    int animation = -1;  ///< -1: at rest
    double time_s = 0;
};
[[nodiscard]] std::vector<MeshNode> mesh_nodes(const GltfModel& model, const GltfInstance& at);

}  // namespace kino
