#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "base/body.h"
#include "skeleton/actors/actor_bone.h"

namespace kino {

struct BoneWeights {
    std::array<std::uint8_t, 4> bone{};
    std::array<float, 4> weight{};  ///< sum 1; largest first, none after a zero
};

/// The person everybody is varied from, as it stands in skeleton/actors/data: arms half raised,
/// metres, x to the person's left, y up from the floor, z where the person faces.
struct BaseMesh {
    std::vector<glm::dvec3> vertex_m;
    std::vector<BoneWeights> weights;
    std::vector<std::array<std::uint32_t, 3>> triangles;  ///< anticlockwise from outside
    std::vector<std::uint32_t> mirror;                    ///< the vertex at (-x, y, z)
    std::array<glm::dvec3, kActorBoneCount> head_m, tail_m;
    std::array<glm::dvec3, kJointCount> joint_m;

    [[nodiscard]] const glm::dvec3& joint(Joint j) const {
        return joint_m[static_cast<std::size_t>(j)];
    }
    /// Share of a vertex that follows these bones.
    [[nodiscard]] double share(std::size_t vertex, std::initializer_list<std::size_t> bones) const;
};

/// Built into the program; unpacked at the first call.
[[nodiscard]] const BaseMesh& base_mesh();

}  // namespace kino
