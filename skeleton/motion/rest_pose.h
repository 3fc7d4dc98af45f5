#pragma once

#include <array>
#include <cstddef>
#include <glm/vec3.hpp>

#include "base/body.h"

namespace kino::motion_export {

/// A node of the exported hierarchy. The first 20 are the joints in their order; the others lie
/// where their parent is, so that each bone that leaves a branching joint has a rotation of its
/// own.
struct RestNode {
    const char* name;
    int parent;  ///< -1 for the root; nodes are not in the order of the tree
    /// Direction of the offset from the parent, person's frame: x to the person's left, y up, z
    /// forward. 0 for nodes that lie on their parent.
    glm::dvec3 direction;
};

constexpr int kLeftPelvis = 20, kRightPelvis = 21, kNeck = 22, kLeftClavicle = 23,
              kRightClavicle = 24;
constexpr std::size_t kNodeCount = 25;

/// The T-pose, with all rotations identity.
[[nodiscard]] const std::array<RestNode, kNodeCount>& rest_nodes();

/// Every node after its parent, children of one node in their joints' order.
[[nodiscard]] const std::array<int, kNodeCount>& tree_order();

/// The bone that ends in the joint in a person of 1.75 m, metres; 0 for the root.
[[nodiscard]] double usual_bone_m(Joint end);

/// What sticks out beyond a last joint (crown, fingers, toes), metres; 0 for other nodes.
[[nodiscard]] double tip_m(int node);

}  // namespace kino::motion_export
