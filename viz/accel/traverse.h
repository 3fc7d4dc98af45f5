#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <limits>
#include <span>

#include "viz/accel/bvh.h"

namespace kino {

constexpr std::uint32_t kNoTriangle = ~0u;

/// In the soup's space. Places are origin + t * direction for t in [t_min, t_max]; the direction
/// may have any length but 0. What is not finite hits nothing.
struct Ray {
    glm::vec3 origin{0};
    float t_min = 0;
    glm::vec3 direction{0, 0, 1};
    float t_max = std::numeric_limits<float>::infinity();
    std::uint32_t skip = kNoTriangle;  ///< the triangle that a secondary ray leaves
};

struct RayHit {
    float t = std::numeric_limits<float>::infinity();
    std::uint32_t triangle = kNoTriangle;  ///< place in the soup; of equal t the smallest one
    float v = 0, w = 0;                    ///< weights of corners b and c; that of a is 1 - v - w
    std::uint32_t leaf = 0;  ///< node in which it was found: where a secondary ray may start

    [[nodiscard]] bool hit() const { return triangle != kNoTriangle; }
};

/// What traversals did, for the tables.
struct TraceCount {
    std::uint64_t box_tests = 0;
    std::uint64_t triangle_tests = 0;
};

/// Bit-trail traversal: no stack, one word that says at which levels the other side is done.
/// `start` may be any node of the tree; every leaf is visited from there all the same, once.
[[nodiscard]] RayHit closest_hit(const Bvh& bvh, const Ray& ray, std::uint32_t start = 1);
[[nodiscard]] bool any_hit(const Bvh& bvh, const Ray& ray, std::uint32_t start = 1);

/// The rival on the same tree: a stack, nearer box first. The same hits.
[[nodiscard]] RayHit closest_hit_by_stack(const Bvh& bvh, const Ray& ray);
[[nodiscard]] bool any_hit_by_stack(const Bvh& bvh, const Ray& ray);

/// The same triangle test on every triangle; what a tree must agree with to the last bit.
[[nodiscard]] RayHit closest_hit_of_all(std::span<const shared::BvhTriangle> triangles,
                                        const Ray& ray);

/// closest_hit() and closest_hit_by_stack() that count what they do.
[[nodiscard]] RayHit count_closest_hit(const Bvh& bvh, const Ray& ray, std::uint32_t start,
                                       TraceCount& count);
[[nodiscard]] RayHit count_closest_hit_by_stack(const Bvh& bvh, const Ray& ray, TraceCount& count);

/// Leaves in the order in which the trail visits them when every box is hit: for the proof that
/// each is visited once whatever the start.
[[nodiscard]] std::vector<std::uint32_t> leaves_on_trail(const Bvh& bvh, std::uint32_t start,
                                                         std::uint32_t& trail_at_end);

/// How far a place found by a ray may be off, metres, along each axis: what a secondary ray must
/// step away from the surface. `place` is where it was found, `reach` its distance.
[[nodiscard]] float hit_error_m(const glm::vec3& place, float reach);

}  // namespace kino
