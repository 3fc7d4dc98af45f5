#include "viz/accel/traverse.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <set>

#include "tests/viz/accel/support/embree_peer.h"
#include "tests/viz/accel/support/ray_meshes.h"

namespace kino {
namespace {

using test::NamedMesh;

TEST(Traverse, a_full_trees_leaves_are_visited_once_from_any_start) {
    for (int levels = 2; levels <= 12; ++levels) {
        Bvh bvh;
        bvh.levels = levels;
        bvh.nodes.resize(std::size_t{1} << levels);
        const std::size_t leaves = bvh.nodes.size() / 2;
        for (std::size_t n = 1; n < bvh.nodes.size(); ++n) {
            bvh.nodes[n].word = n < leaves ? 8u : 12u;
        }
        // All starts up to depth 8; then a sample, for the work grows with the square.
        const std::size_t step = levels <= 8 ? 1 : bvh.nodes.size() / 64 + 1;
        for (std::size_t start = 1; start < bvh.nodes.size(); start += step) {
            std::uint32_t trail = 0;
            const auto visited = leaves_on_trail(bvh, static_cast<std::uint32_t>(start), trail);
            EXPECT_EQ(trail, 1u);
            ASSERT_EQ(visited.size(), leaves);
            EXPECT_EQ(std::set<std::uint32_t>(visited.begin(), visited.end()).size(), leaves);
            if (start >= leaves) {
                EXPECT_EQ(visited.front(), start);
            }
        }
    }
}

TEST(Traverse, finds_exactly_what_a_loop_over_all_triangles_finds) {
    for (const NamedMesh& mesh : test::test_meshes()) {
        SCOPED_TRACE(mesh.name);
        const Bvh bvh = build_bvh(mesh.triangles);
        test::Random random(11);
        int hits = 0;
        const int rays = mesh.triangles.size() > 3000 ? 400 : 1000;
        for (int i = 0; i < rays; ++i) {
            const Ray ray = test::random_ray(random, mesh.triangles);
            const RayHit all = closest_hit_of_all(bvh.triangles, ray);
            const RayHit trail = closest_hit(bvh, ray);
            const RayHit stack = closest_hit_by_stack(bvh, ray);
            ASSERT_EQ(trail.triangle, all.triangle) << i;
            ASSERT_EQ(trail.t, all.t) << i;
            ASSERT_EQ(trail.v, all.v) << i;
            ASSERT_EQ(stack.triangle, all.triangle) << i;
            ASSERT_EQ(stack.t, all.t) << i;
            ASSERT_EQ(any_hit(bvh, ray), all.hit()) << i;
            ASSERT_EQ(any_hit_by_stack(bvh, ray), all.hit()) << i;
            if (all.hit()) {
                ++hits;
                // A secondary ray may start anywhere.
                const RayHit restarted = closest_hit(bvh, ray, trail.leaf);
                ASSERT_EQ(restarted.triangle, all.triangle) << i;
                ASSERT_EQ(restarted.t, all.t) << i;
            }
        }
        EXPECT_GT(hits, rays / 20);
    }
}

TEST(Traverse, agrees_with_a_loop_in_double_but_for_rays_on_edges) {
    for (const NamedMesh& mesh : test::test_meshes()) {
        SCOPED_TRACE(mesh.name);
        const Bvh bvh = build_bvh(mesh.triangles);
        const auto wide = test::in_double(mesh.triangles);
        test::Random random(12);
        for (int i = 0; i < 400; ++i) {
            const Ray ray = test::random_ray(random, mesh.triangles);
            const RayHit ours = closest_hit(bvh, ray);
            const auto exact = reference::first_triangle_on_ray(wide, ray.origin, ray.direction,
                                                                ray.t_min, ray.t_max);
            const bool same = ours.hit() == (exact.triangle >= 0) &&
                              (!ours.hit() || ours.triangle == exact.triangle ||
                               std::abs(ours.t - exact.t) <= 1e-5 * std::abs(exact.t));
            if (same) continue;
            EXPECT_LT(reference::closest_edge(wide, ray.origin, ray.direction), 1e-6) << i;
        }
    }
}

TEST(Traverse, agrees_with_embree_but_for_rays_on_edges) {
    for (const NamedMesh& mesh : test::test_meshes()) {
        SCOPED_TRACE(mesh.name);
        const Bvh bvh = build_bvh(mesh.triangles);
        const test::EmbreePeer embree(mesh.triangles);
        const auto wide = test::in_double(mesh.triangles);
        test::Random random(13);
        int differing = 0;
        const int rays = mesh.name == "equal triangles" ? 500 : 10000;
        for (int i = 0; i < rays; ++i) {
            const Ray ray = test::random_ray(random, mesh.triangles);
            const RayHit ours = closest_hit(bvh, ray);
            const RayHit theirs = embree.closest_hit(ray);
            const bool same = ours.hit() == theirs.hit() &&
                              (!ours.hit() || ours.triangle == theirs.triangle ||
                               std::abs(ours.t - theirs.t) <= 1e-5f * std::abs(theirs.t));
            if (same) continue;
            const double edge = reference::closest_edge(wide, ray.origin, ray.direction);
            // Rays through the outermost vertices are among them on purpose: both answers are
            // right.
            differing += edge > 1e-9;
            EXPECT_LT(edge, 1e-6) << i << ": " << ours.t << ' ' << ours.triangle << ", theirs "
                                  << theirs.t << ' ' << theirs.triangle;
        }
        EXPECT_LE(differing, rays / 1000);
    }
}

TEST(Traverse, no_ray_leaves_a_closed_mesh_through_its_vertices_or_edges) {
    struct Closed {
        const char* name;
        glm::vec3 inside;
    };
    for (const auto& [name, inside] :
         {Closed{"spot", {0.0f, 0.0f, 0.25f}}, Closed{"sphere", {0.1f, -0.2f, 0.3f}},
          Closed{"room", {0.3f, 2.0f, 0.2f}}, Closed{"1e6 m off", {1e6f, -1e6f, 1e6f}}}) {
        SCOPED_TRACE(name);
        const auto mesh = std::find_if(test::test_meshes().begin(), test::test_meshes().end(),
                                       [&](const NamedMesh& m) { return m.name == name; });
        const Bvh bvh = build_bvh(mesh->triangles);
        test::Random random(14);
        int escapes = 0;
        for (int i = 0; i < 20000; ++i) {
            const Triangle& t = mesh->triangles[static_cast<std::size_t>(
                random.integer(0, int(mesh->triangles.size()) - 1))];
            const glm::vec3 target = i % 3 == 0   ? t.a
                                     : i % 3 == 1 ? 0.5f * (t.a + t.b)
                                                  : t.b + 0.25f * (t.c - t.b);
            Ray ray{.origin = inside, .direction = target - inside};
            escapes += !closest_hit(bvh, ray).hit();
            ray.direction *= 1e-3f;
            escapes += !any_hit(bvh, ray);
        }
        EXPECT_EQ(escapes, 0);
    }
}

TEST(Traverse, rays_that_make_no_sense_hit_nothing) {
    const Bvh bvh = build_bvh(test::test_meshes()[1].triangles);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float inf = std::numeric_limits<float>::infinity();
    for (const Ray& ray :
         {Ray{.origin = {0.1f, -0.2f, 0.3f}, .direction = {0, 0, 0}},
          Ray{.origin = {nan, 0, 0}, .direction = {0, 0, 1}},
          Ray{.origin = {0, 0, 0}, .direction = {0, nan, 1}},
          Ray{.origin = {0, 0, 0}, .direction = {0, inf, 1}},
          Ray{.origin = {0, inf, 0}, .direction = {0, -1, 0}},
          Ray{.origin = {0.1f, -0.2f, 0.3f}, .t_min = 1, .direction = {0, 0, 1}, .t_max = 0.5f},
          Ray{.origin = {0.1f, -0.2f, 0.3f}, .t_min = nan, .direction = {0, 0, 1}}}) {
        EXPECT_FALSE(closest_hit(bvh, ray).hit());
        EXPECT_FALSE(closest_hit_by_stack(bvh, ray).hit());
        EXPECT_FALSE(any_hit(bvh, ray));
    }
    EXPECT_FALSE(closest_hit(Bvh{}, Ray{}).hit());
    EXPECT_FALSE(any_hit_by_stack(Bvh{}, Ray{}));
}

TEST(Traverse, a_ray_in_a_boxs_face_meets_what_is_in_it) {
    // The box of this triangle has the ray's origin on its planes x = 0 and y = 0, and the ray
    // runs in both: 0 * infinity on two axes.
    const std::vector<Triangle> one = {{{0, 0, 1}, {1, 0, 1}, {0, 1, 1}}};
    const Bvh bvh = build_bvh(one);
    for (const float x : {0.0f, -0.0f}) {
        for (const float y : {0.0f, -0.0f}) {
            const Ray ray{.origin = {0, 0, 0}, .direction = {x, y, 2}};
            EXPECT_TRUE(closest_hit(bvh, ray).hit());
            EXPECT_FLOAT_EQ(closest_hit(bvh, ray).t, 0.5f);
        }
    }
    EXPECT_TRUE(any_hit(bvh, {.origin = {1, 0, 0}, .direction = {0, 0, 1}}));
}

TEST(Traverse, of_equal_distances_the_smallest_triangle_wins_and_one_can_be_skipped) {
    const Bvh bvh = build_bvh(std::vector<Triangle>(100, {{0, 0, 1}, {1, 0, 1}, {0, 1, 1}}));
    Ray ray{.origin = {0.2f, 0.2f, 0}, .direction = {0, 0, 1}};
    EXPECT_EQ(closest_hit(bvh, ray).triangle, 0u);
    EXPECT_EQ(closest_hit_by_stack(bvh, ray).triangle, 0u);
    ray.skip = 0;
    EXPECT_EQ(closest_hit(bvh, ray).triangle, 1u);
}

TEST(Traverse, a_restart_at_the_leaf_needs_fewer_box_tests) {
    const auto& mesh = test::test_meshes()[0].triangles;
    const Bvh bvh = build_bvh(mesh);
    test::Random random(15);
    TraceCount from_root, from_leaf;
    for (int i = 0; i < 3000; ++i) {
        const Ray ray = test::random_ray(random, mesh);
        const RayHit hit = closest_hit(bvh, ray);
        if (!hit.hit()) continue;
        (void)count_closest_hit(bvh, ray, 1, from_root);
        (void)count_closest_hit(bvh, ray, hit.leaf, from_leaf);
    }
    EXPECT_LT(from_leaf.box_tests, from_root.box_tests);
}

}  // namespace
}  // namespace kino
