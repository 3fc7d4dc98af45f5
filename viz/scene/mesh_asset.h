#pragma once

#include <array>
#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <string>
#include <vector>

#include "base/image.h"

namespace kino {

/// One skeleton's rest pose, as glTF has it: a joint's matrix takes the mesh from its bind pose to
/// object space as `object_from_joint * joint_from_bind`.
struct MeshJoint {
    std::string name;
    int parent = -1;  ///< index of a joint before this one; -1: a root
    glm::mat4 parent_from_joint{1};
    glm::mat4 joint_from_bind{1};
};

/// Triangles with one material, immutable once made and shared by count. Object space, metres,
/// y up, counter-clockwise seen from outside. Invariants, checked by whoever makes one: normals as
/// long as positions; uvs, joints and weights empty or as long; indices a multiple of three, each
/// below positions.size(); everything finite.
struct MeshAsset {
    std::string name;
    std::vector<glm::vec3> positions;
    std::vector<glm::vec3> normals;  ///< unit length
    std::vector<glm::vec2> uvs;
    /// Skinned meshes: four joints a vertex and their weights, which sum to one.
    std::vector<std::array<std::uint16_t, 4>> joints;
    std::vector<glm::vec4> weights;
    std::vector<std::uint32_t> indices;
    glm::vec3 sphere_center{0};  ///< bounding sphere of the positions
    float sphere_radius_m = 0;

    [[nodiscard]] bool skinned() const { return !joints.empty(); }
};

}  // namespace kino
