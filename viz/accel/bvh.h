#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "viz/accel/accel_shared.h"
#include "viz/accel/morton.h"
#include "viz/accel/triangle_soup.h"

namespace kino {

/// Most levels: 2^22 nodes of 32 bytes fill the largest buffer that every device binds.
constexpr int kMostBvhLevels = 22;

struct BvhOptions {
    int levels = 0;  ///< 1 .. kMostBvhLevels; 0: default_levels()
    AxisRule axes = AxisRule::longest_cell;
    std::uint32_t leaf_triangles = 4;  ///< ranges up to this long are cut no further
};

/// The level count at which traversal gains no more (docs/lbvh.md).
[[nodiscard]] int default_levels(std::size_t triangles);

/// A bounding volume hierarchy as a binary heap: the root is node 1, the children of n are 2n and
/// 2n + 1, so that no node holds a pointer (GPU Pro 4, Murguia et al., Bit-Trail Traversal for
/// Stackless LBVH). Triangles lie in Morton order; nodes of the last level are always leaves.
struct Bvh {
    int levels = 0;                              ///< 0: nothing in it, every ray misses
    std::vector<shared::BvhNode> nodes;          ///< 2^levels of them; node 0 is none
    std::vector<shared::BvhTriangle> triangles;  ///< in the tree's order
    shared::MortonFrame frame{};
    AxisRule axes = AxisRule::longest_cell;

    [[nodiscard]] bool empty() const { return levels == 0; }
};

[[nodiscard]] inline bool is_leaf(const shared::BvhNode& node) {
    return (node.word & 4u) != 0;
}
[[nodiscard]] inline std::uint32_t triangle_count(const shared::BvhNode& node) {
    return node.word >> 3;
}

/// Builds the tree of triangles without faults (fault_of()). The device's build makes the same
/// nodes, bit by bit.
[[nodiscard]] Bvh build_bvh(std::span<const Triangle> triangles, const BvhOptions& options = {});

/// Takes moved triangles, as many as before and in the soup's order, and corrects the boxes only.
void refit_bvh(Bvh& bvh, std::span<const Triangle> triangles);

struct BvhStats {
    std::uint32_t nodes = 0;  ///< that exist
    std::uint32_t leaves = 0;
    std::uint32_t longest_leaf = 0;  ///< triangles
    /// Surface-area estimate of box and triangle tests of a random ray that meets the root
    /// (MacDonald and Booth 1990): what a refit makes worse and a rebuild repairs.
    double box_tests = 0;
    double triangle_tests = 0;
};
[[nodiscard]] BvhStats stats_of(const Bvh& bvh);

}  // namespace kino
