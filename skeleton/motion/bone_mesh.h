#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "skeleton/motion/skeletal_motion.h"

namespace kino::motion_export {

/// Something to look at: a slim octahedron for each bone and each tip, each fixed to one node.
struct BoneMesh {
    struct Vertex {
        glm::dvec3 position_m;  ///< at rest, root at the origin
        int node;
    };
    std::vector<Vertex> vertices;
    std::vector<std::uint16_t> indices;  ///< triangles, counter-clockwise seen from outside
};

[[nodiscard]] BoneMesh bone_mesh(const SkeletalMotion& motion);

/// Nodes at rest with the root at the origin, metres.
[[nodiscard]] std::array<glm::dvec3, kNodeCount> rest_positions(const SkeletalMotion& motion);

}  // namespace kino::motion_export
