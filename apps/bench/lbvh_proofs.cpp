#include <fmt/format.h>

#include <atomic>
#include <cmath>

#include "apps/bench/lbvh_rays.h"

namespace kino {

using test::NamedMesh;

void bench_ray_equality(BenchContext& context, const std::vector<NamedMesh>& meshes,
                        std::size_t total) {
    std::atomic<std::uint64_t> rays = 0, same = 0, on_edges = 0, wrong = 0;
    for (const NamedMesh& mesh : meshes) {
        context.progress(fmt::format("equality: {}", mesh.name));
        const Bvh bvh = build_bvh(mesh.triangles);
        const test::EmbreePeer embree(mesh.triangles);
        const std::size_t runs = 64;
        const std::size_t in_run = total / meshes.size() / runs;
        for_each_ray(runs, [&](std::size_t run) {
            test::Random random(100 + run);
            for (std::size_t i = 0; i < in_run; ++i) {
                const Ray ray = test::random_ray(random, mesh.triangles);
                const RayHit ours = closest_hit(bvh, ray);
                const RayHit theirs = embree.closest_hit(ray);
                ++rays;
                if (ours.hit() == theirs.hit() &&
                    (!ours.hit() || ours.triangle == theirs.triangle ||
                     std::abs(ours.t - theirs.t) <= 1e-5f * std::abs(theirs.t))) {
                    ++same;
                    continue;
                }
                // If it is rounding that parts them, the ray is on an edge of what one of them met.
                std::vector<reference::RayTriangle> met;
                for (const RayHit& hit : {ours, theirs}) {
                    if (!hit.hit()) continue;
                    const Triangle& t = mesh.triangles[hit.triangle];
                    met.push_back({t.a, t.b, t.c});
                }
                const double edge = reference::closest_edge(met, ray.origin, ray.direction);
                ++(edge < 1e-6 ? on_edges : wrong);
            }
        });
    }
    context.claim(
        fmt::format("{} random rays over {} meshes, degenerate ones among them: {} hits equal "
                    "Embree's, {} differ on rays within 1e-6 of an edge, {} elsewhere",
                    rays.load(), meshes.size(), same.load(), on_edges.load(), wrong.load()),
        wrong.load() == 0 && rays.load() == same.load() + on_edges.load());
}

void bench_watertight_rays(BenchContext& context, const std::vector<NamedMesh>& meshes,
                           std::size_t total) {
    std::atomic<std::uint64_t> ours = 0, theirs = 0;
    for (const NamedMesh& mesh : meshes) {
        const MeshBox box = box_of(mesh.triangles);
        const glm::vec3 inside =
            mesh.name == "spot" ? glm::vec3(0, 0, 0.25f) : 0.5f * (box.lo + box.hi) + 0.01f;
        const Bvh bvh = build_bvh(mesh.triangles);
        const test::EmbreePeer embree(mesh.triangles);
        for_each_ray(total / meshes.size(), [&](std::size_t i) {
            test::Random random(i);
            const Triangle& t = mesh.triangles[static_cast<std::size_t>(
                random.integer(0, int(mesh.triangles.size()) - 1))];
            const float share = i % 3 == 0 ? 0.0f : static_cast<float>(random.real(0, 1));
            const Ray ray{.origin = inside, .direction = t.a + share * (t.b - t.a) - inside};
            ours += !any_hit(bvh, ray);
            theirs += !embree.any_hit(ray);
        });
    }
    context.claim(fmt::format("{} rays from inside closed meshes through their vertices and "
                              "edges: {} escape (of Embree's: {})",
                              total / meshes.size() * meshes.size(), ours.load(), theirs.load()),
                  ours.load() == 0);
}

}  // namespace kino
