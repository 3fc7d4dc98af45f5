#pragma once

#include <string>
#include <thread>
#include <vector>

#include "apps/bench/bench.h"
#include "tests/viz/accel/support/embree_peer.h"
#include "tests/viz/accel/support/ray_meshes.h"
#include "viz/accel/device_bvh.h"

namespace kino {

/// The cores that rays of the processor's own get, as many as the device has.
constexpr std::size_t kRayThreads = 2;

/// `body(i)` for i in [0, count), the indices cut in as many runs as there are threads.
template <class Body>
void for_each_ray(std::size_t count, const Body& body) {
    std::vector<std::thread> threads;
    for (std::size_t part = 0; part < kRayThreads; ++part) {
        threads.emplace_back([&, part] {
            const std::size_t end = count * (part + 1) / kRayThreads;
            for (std::size_t i = count * part / kRayThreads; i < end; ++i) body(i);
        });
    }
    for (std::thread& thread : threads) thread.join();
}

/// Millions of rays a second.
[[nodiscard]] inline double mrays_per_s(std::size_t rays, double ms) {
    return static_cast<double>(rays) / ms / 1000;
}

struct MeshBox {
    glm::vec3 lo{3e38f}, hi{-3e38f};
};
inline MeshBox box_of(const std::vector<Triangle>& triangles) {
    MeshBox box;
    for (const Triangle& t : triangles) {
        box.lo = glm::min(box.lo, glm::min(t.a, glm::min(t.b, t.c)));
        box.hi = glm::max(box.hi, glm::max(t.a, glm::max(t.b, t.c)));
    }
    return box;
}

/// Ours against Embree, ray by ray.
void bench_ray_equality(BenchContext& context, const std::vector<test::NamedMesh>& meshes,
                        std::size_t total);
/// From inside closed meshes through vertices and points of edges.
void bench_watertight_rays(BenchContext& context, const std::vector<test::NamedMesh>& meshes,
                           std::size_t total);

/// The part of `bench lbvh` about shadows.
void bench_ray_shadows(BenchContext& context, gpu::Device& device, graph::Executor& executor);

}  // namespace kino
