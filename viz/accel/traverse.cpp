#include "viz/accel/traverse.h"

#include <algorithm>
#include <array>
#include <bit>

#include "viz/accel/ray_tests.h"

namespace kino {
namespace {

struct NoCount {
    void box() {}
    void triangles(std::uint32_t) {}
};
struct Counting {
    TraceCount& count;
    void box() { ++count.box_tests; }
    void triangles(std::uint32_t n) { count.triangle_tests += n; }
};

/// The next node after all below `n` is done, and what is left of the trail; the traversal is over
/// when the trail is 1.
void pop(std::uint32_t& n, std::uint32_t& trail) {
    const int up = std::countr_zero(trail + 1);
    trail = (trail >> up) + 1;
    n = (n >> up) ^ 1u;
}

bool met_leaf(const Bvh& bvh, const shared::BvhNode& node, const PreparedRay& ray, std::uint32_t n,
              bool any, RayHit& best) {
    const std::uint32_t before = best.triangle;
    const float t_before = best.t;
    const shared::BvhTriangle* triangle = &bvh.triangles[node.first];
    for (std::uint32_t i = 0; i < triangle_count(node); ++i) {
        meet_triangle(ray, triangle[i], best);
        if (any && best.hit()) return true;
    }
    if (best.triangle != before || best.t != t_before) best.leaf = n;
    return false;
}

template <bool kAny, class Count>
RayHit trace(const Bvh& bvh, const Ray& from, std::uint32_t start, Count count) {
    RayHit best;
    const PreparedRay ray(from);
    if (bvh.empty() || !ray.valid) return best;
    best.t = from.t_max;
    std::uint32_t n = start;
    // A bit a level, below a leading one.
    std::uint32_t trail = std::bit_floor(n);
    // The root has no other side: its trail is over before it began, and yet it must be tested.
    do {
        const shared::BvhNode& node = bvh.nodes[n];
        float enter = 0;
        count.box();
        if (meets_box(ray, node.lo, node.hi, best.t, enter)) {
            if (!is_leaf(node)) {
                trail <<= 1;
                n = 2 * n + ((ray.negative >> (node.word & 3u)) & 1u);
                continue;
            }
            count.triangles(triangle_count(node));
            if (met_leaf(bvh, node, ray, n, kAny, best)) break;
        }
        pop(n, trail);
    } while (trail > 1);
    if (!best.hit()) best.t = std::numeric_limits<float>::infinity();
    return best;
}

template <bool kAny, class Count>
RayHit trace_by_stack(const Bvh& bvh, const Ray& from, Count count) {
    struct Pending {
        std::uint32_t node;
        float enter;
    };
    RayHit best;
    const PreparedRay ray(from);
    if (bvh.empty() || !ray.valid) return best;
    best.t = from.t_max;
    std::array<Pending, kMostBvhLevels> stack;
    std::size_t depth = 0;
    float enter = 0;
    count.box();
    std::uint32_t n = meets_box(ray, bvh.nodes[1].lo, bvh.nodes[1].hi, best.t, enter) ? 1 : 0;
    while (n != 0) {
        const shared::BvhNode& node = bvh.nodes[n];
        if (is_leaf(node)) {
            count.triangles(triangle_count(node));
            if (met_leaf(bvh, node, ray, n, kAny, best)) break;
            n = 0;
        } else {
            const shared::BvhNode* child = &bvh.nodes[2 * n];
            float enter_left = 0;
            float enter_right = 0;
            count.box();
            count.box();
            const bool left = meets_box(ray, child[0].lo, child[0].hi, best.t, enter_left);
            const bool right = meets_box(ray, child[1].lo, child[1].hi, best.t, enter_right);
            if (left && right) {
                const bool right_first = enter_right < enter_left;
                stack[depth++] = {2 * n + (right_first ? 0u : 1u),
                                  right_first ? enter_left : enter_right};
                n = 2 * n + (right_first ? 1u : 0u);
            } else {
                n = left ? 2 * n : right ? 2 * n + 1 : 0;
            }
        }
        while (n == 0 && depth > 0) {
            const Pending& next = stack[--depth];
            if (next.enter <= best.t * kBestSlack) n = next.node;
        }
    }
    if (!best.hit()) best.t = std::numeric_limits<float>::infinity();
    return best;
}

}  // namespace

RayHit closest_hit(const Bvh& bvh, const Ray& ray, std::uint32_t start) {
    return trace<false>(bvh, ray, start, NoCount{});
}

bool any_hit(const Bvh& bvh, const Ray& ray, std::uint32_t start) {
    return trace<true>(bvh, ray, start, NoCount{}).hit();
}

RayHit closest_hit_by_stack(const Bvh& bvh, const Ray& ray) {
    return trace_by_stack<false>(bvh, ray, NoCount{});
}

bool any_hit_by_stack(const Bvh& bvh, const Ray& ray) {
    return trace_by_stack<true>(bvh, ray, NoCount{}).hit();
}

RayHit closest_hit_of_all(std::span<const shared::BvhTriangle> triangles, const Ray& from) {
    RayHit best;
    const PreparedRay ray(from);
    if (!ray.valid) return best;
    best.t = from.t_max;
    for (const shared::BvhTriangle& triangle : triangles) meet_triangle(ray, triangle, best);
    if (!best.hit()) best.t = std::numeric_limits<float>::infinity();
    return best;
}

RayHit count_closest_hit(const Bvh& bvh, const Ray& ray, std::uint32_t start, TraceCount& count) {
    return trace<false>(bvh, ray, start, Counting{count});
}

RayHit count_closest_hit_by_stack(const Bvh& bvh, const Ray& ray, TraceCount& count) {
    return trace_by_stack<false>(bvh, ray, Counting{count});
}

std::vector<std::uint32_t> leaves_on_trail(const Bvh& bvh, std::uint32_t start,
                                           std::uint32_t& trail_at_end) {
    std::vector<std::uint32_t> leaves;
    std::uint32_t n = start;
    std::uint32_t trail = std::bit_floor(n);
    do {
        if (!is_leaf(bvh.nodes[n])) {
            trail <<= 1;
            n = 2 * n;
            continue;
        }
        leaves.push_back(n);
        pop(n, trail);
    } while (trail > 1);
    trail_at_end = trail;
    return leaves;
}

float hit_error_m(const glm::vec3& place, float reach) {
    // The place is rounded a few times on the way through the ray's equation, and the corners of
    // the triangle once: some units in the last place of the largest number that took part.
    const float largest =
        std::max({std::abs(place.x), std::abs(place.y), std::abs(place.z), reach});
    return 32 * 5.9604645e-8f * largest;
}

}  // namespace kino
