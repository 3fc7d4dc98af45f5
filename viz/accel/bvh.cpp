#include "viz/accel/bvh.h"

#include <algorithm>
#include <bit>
#include <cstdlib>
#include <limits>

#include "base/check.h"

namespace kino {
namespace {

using shared::BvhNode;
using shared::BvhTriangle;

constexpr std::uint32_t kLeafBit = 4;

void grow(BvhNode& box, const glm::vec3& p) {
    for (int k = 0; k < 3; ++k) {
        box.lo[k] = std::min(box.lo[k], p[k]);
        box.hi[k] = std::max(box.hi[k], p[k]);
    }
}

void fit_leaf(Bvh& bvh, BvhNode& node) {
    constexpr float kInf = std::numeric_limits<float>::infinity();
    node.lo = glm::vec3(kInf);
    node.hi = glm::vec3(-kInf);
    for (std::uint32_t i = node.first; i < node.first + triangle_count(node); ++i) {
        const BvhTriangle& t = bvh.triangles[i];
        grow(node, t.a);
        grow(node, t.b);
        grow(node, t.c);
    }
}

void fit_inner(Bvh& bvh, std::uint32_t n) {
    BvhNode& node = bvh.nodes[n];
    const BvhNode& left = bvh.nodes[2 * n];
    const BvhNode& right = bvh.nodes[2 * n + 1];
    node.lo = left.lo;
    node.hi = left.hi;
    grow(node, right.lo);
    grow(node, right.hi);
}

class Builder {
  public:
    Builder(Bvh& bvh, std::span<const CodedTriangle> order, std::uint32_t leaf_triangles)
        : bvh_(bvh), order_(order), leaf_triangles_(leaf_triangles) {}

    /// Node `n` over the triangles [first, last], and all below it.
    void build(std::uint32_t n, std::uint32_t first, std::uint32_t last) {
        BvhNode& node = bvh_.nodes[n];
        const std::uint32_t count = last - first + 1;
        node.first = first;
        const std::uint32_t differing = order_[first].code ^ order_[last].code;
        if (differing == 0 || count <= leaf_triangles_ || 2 * n >= bvh_.nodes.size()) {
            node.word = kLeafBit | (count << 3);
            fit_leaf(bvh_, node);
            return;
        }
        const int bit = static_cast<int>(std::bit_width(differing)) - 1;
        node.word = static_cast<std::uint32_t>(axis_of_bit(bvh_.frame, bit)) | (count << 3);
        // First code with the bit set: all above it are equal in the range.
        const auto right = std::partition_point(
            order_.begin() + first, order_.begin() + last + 1,
            [&](const CodedTriangle& t) { return ((t.code >> bit) & 1u) == 0; });
        const auto split = static_cast<std::uint32_t>(right - order_.begin());
        build(2 * n, first, split - 1);
        build(2 * n + 1, split, last);
        fit_inner(bvh_, n);
    }

  private:
    Bvh& bvh_;
    std::span<const CodedTriangle> order_;
    std::uint32_t leaf_triangles_;
};

double area_of(const BvhNode& node) {
    const glm::dvec3 e = glm::dvec3(node.hi) - glm::dvec3(node.lo);
    return e.x * e.y + e.y * e.z + e.z * e.x;
}

}  // namespace

int default_levels(std::size_t triangles) {
    return std::clamp(static_cast<int>(std::bit_width(triangles)), 1, kMostBvhLevels);
}

Bvh build_bvh(std::span<const Triangle> triangles, const BvhOptions& options) {
    KINO_CHECK(options.levels >= 0 && options.levels <= kMostBvhLevels);
    KINO_CHECK(triangles.size() < (1u << 28) && options.leaf_triangles > 0);
    Bvh bvh;
    bvh.axes = options.axes;
    if (triangles.empty()) return bvh;
    bvh.levels = options.levels > 0 ? options.levels : default_levels(triangles.size());
    bvh.frame = morton_frame(centroid_box(triangles), options.axes);
    const MortonCoder code(bvh.frame);
    std::vector<CodedTriangle> order(triangles.size());
    for (std::uint32_t i = 0; i < triangles.size(); ++i) {
        order[i] = {code(centroid_of(triangles[i])), i};
    }
    radix_sort(order);
    bvh.triangles.resize(triangles.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
        const Triangle& t = triangles[order[i].triangle];
        bvh.triangles[i] = {.a = t.a, .id = order[i].triangle, .b = t.b, .c = t.c};
    }
    bvh.nodes.resize(std::size_t{1} << bvh.levels);
    Builder(bvh, order, options.leaf_triangles)
        .build(1, 0, static_cast<std::uint32_t>(order.size() - 1));
    return bvh;
}

void refit_bvh(Bvh& bvh, std::span<const Triangle> triangles) {
    KINO_CHECK_EQ(triangles.size(), bvh.triangles.size());
    for (BvhTriangle& triangle : bvh.triangles) {
        const Triangle& moved = triangles[triangle.id];
        triangle.a = moved.a;
        triangle.b = moved.b;
        triangle.c = moved.c;
    }
    for (std::size_t n = bvh.nodes.size(); n-- > 1;) {
        BvhNode& node = bvh.nodes[n];
        if (node.word == 0) continue;
        if (is_leaf(node)) {
            fit_leaf(bvh, node);
        } else {
            fit_inner(bvh, static_cast<std::uint32_t>(n));
        }
    }
}

BvhStats stats_of(const Bvh& bvh) {
    BvhStats stats;
    if (bvh.empty()) return stats;
    const double whole = std::max(area_of(bvh.nodes[1]), 1e-30);
    for (std::size_t n = 1; n < bvh.nodes.size(); ++n) {
        const BvhNode& node = bvh.nodes[n];
        if (node.word == 0) continue;
        ++stats.nodes;
        const double met = area_of(node) / whole;
        // Both children of a node that is met are tested.
        if (!is_leaf(node)) {
            stats.box_tests += 2 * met;
            continue;
        }
        ++stats.leaves;
        stats.longest_leaf = std::max(stats.longest_leaf, triangle_count(node));
        stats.triangle_tests += met * triangle_count(node);
    }
    return stats;
}

}  // namespace kino
