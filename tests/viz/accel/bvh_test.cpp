#include "viz/accel/bvh.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <glm/ext/matrix_transform.hpp>
#include <set>

#include "tests/reference/skinning_reference.h"
#include "tests/viz/accel/support/ray_meshes.h"

namespace kino {
namespace {

using test::NamedMesh;

std::array<float, 3> numbers(const glm::vec3& v) {
    return {v.x, v.y, v.z};
}

bool contains(const shared::BvhNode& outer, const glm::vec3& p) {
    return glm::all(glm::lessThanEqual(outer.lo, p)) && glm::all(glm::lessThanEqual(p, outer.hi));
}

/// Every triangle in one leaf, sizes that sum, boxes that hold what is below and no more.
void expect_whole(const Bvh& bvh, std::size_t triangles) {
    ASSERT_EQ(bvh.nodes.size(), std::size_t{1} << bvh.levels);
    ASSERT_EQ(bvh.triangles.size(), triangles);
    EXPECT_EQ(bvh.nodes[0].word, 0u);
    EXPECT_EQ(triangle_count(bvh.nodes[1]), triangles);
    std::vector<int> seen(triangles, 0);
    for (std::uint32_t n = 1; n < bvh.nodes.size(); ++n) {
        const shared::BvhNode& node = bvh.nodes[n];
        const bool last = 2 * n >= bvh.nodes.size();
        if (node.word == 0) {
            ASSERT_TRUE(last || (bvh.nodes[2 * n].word == 0 && bvh.nodes[2 * n + 1].word == 0));
            continue;
        }
        if (!is_leaf(node)) {
            ASSERT_FALSE(last);
            const shared::BvhNode& left = bvh.nodes[2 * n];
            const shared::BvhNode& right = bvh.nodes[2 * n + 1];
            ASSERT_GT(triangle_count(left), 0u);
            ASSERT_GT(triangle_count(right), 0u);
            ASSERT_EQ(triangle_count(left) + triangle_count(right), triangle_count(node));
            ASSERT_EQ(left.first, node.first);
            ASSERT_EQ(right.first, node.first + triangle_count(left));
            ASSERT_EQ(glm::min(left.lo, right.lo), node.lo);
            ASSERT_EQ(glm::max(left.hi, right.hi), node.hi);
            continue;
        }
        for (std::uint32_t i = node.first; i < node.first + triangle_count(node); ++i) {
            ++seen[bvh.triangles[i].id];
            ASSERT_TRUE(contains(node, bvh.triangles[i].a));
            ASSERT_TRUE(contains(node, bvh.triangles[i].b));
            ASSERT_TRUE(contains(node, bvh.triangles[i].c));
        }
    }
    EXPECT_THAT(seen, ::testing::Each(1));
}

TEST(Morton, codes_equal_those_made_bit_by_bit) {
    test::Random random(1);
    const auto float_in = [&](double from, double to) {
        return static_cast<float>(random.real(from, to));
    };
    for (const glm::vec3 extent : {glm::vec3(3.4f, 2.5f, 0.03f), glm::vec3(1),
                                   glm::vec3(5, 0, 1e-4f), glm::vec3(0, 7, 0), glm::vec3(0)}) {
        const CentroidBox box{glm::vec3(-1, 2, 1000), glm::vec3(-1, 2, 1000) + extent};
        for (const AxisRule rule : {AxisRule::fixed_xyz, AxisRule::longest_cell}) {
            const MortonCoder code(morton_frame(box, rule));
            for (int i = 0; i < 20000; ++i) {
                glm::vec3 p = box.lo;
                for (int k = 0; k < 3; ++k) {
                    // Corners of the box and places outside are among them.
                    const int corner = (i / (k == 0 ? 1 : k == 1 ? 3 : 9)) % 3;
                    p[k] = i < 27 ? box.lo[k] + extent[k] * 0.5f * static_cast<float>(corner)
                                  : box.lo[k] + extent[k] * float_in(-0.01, 1.01);
                }
                if (i == 26) p = box.hi;
                ASSERT_EQ(code(p), reference::morton_code_bit_by_bit(
                                       numbers(p), numbers(box.lo), numbers(box.hi),
                                       rule == AxisRule::longest_cell))
                    << p.x << ' ' << p.y << ' ' << p.z;
            }
        }
    }
}

TEST(Morton, both_ends_of_the_box_are_where_they_belong_and_not_where_the_listing_has_them) {
    const CentroidBox box{glm::vec3(-1), glm::vec3(1)};
    const MortonCoder code(morton_frame(box, AxisRule::fixed_xyz));
    EXPECT_EQ(code(box.lo), 0u);
    EXPECT_EQ(code(box.hi), (1u << 30) - 1);
    const auto printed = [&](const glm::vec3& p) {
        return reference::morton_code_as_printed(numbers(p), numbers(box.lo), numbers(box.hi));
    };
    // The reference must be able to say no: both ends share a cell there, and order is reversed.
    EXPECT_EQ(printed(box.lo), printed(box.hi));
    EXPECT_GT(printed(glm::vec3(-0.5f)), printed(glm::vec3(0.5f)));
}

TEST(Morton, a_flat_wall_spends_no_bit_on_its_thickness) {
    const CentroidBox box{glm::vec3(0), glm::vec3(3.4f, 2.5f, 0)};
    const shared::MortonFrame frame = morton_frame(box, AxisRule::longest_cell);
    for (int bit = 0; bit < kMortonBits; ++bit) EXPECT_NE(axis_of_bit(frame, bit), 2) << bit;
}

TEST(Morton, radix_sort_is_a_stable_sort) {
    test::Random random(2);
    for (const std::size_t count : {0, 1, 2, 255, 4096}) {
        std::vector<CodedTriangle> items(count);
        for (std::uint32_t i = 0; i < count; ++i) {
            items[i] = {static_cast<std::uint32_t>(random.bits()) & (i % 2 ? 0x3Fu : 0x3FFFFFFFu),
                        i};
        }
        auto expected = items;
        std::stable_sort(expected.begin(), expected.end(),
                         [](const auto& a, const auto& b) { return a.code < b.code; });
        radix_sort(items);
        EXPECT_EQ(items, expected);
    }
}

TEST(Bvh, is_whole_for_every_mesh_depth_axis_rule_and_leaf_size) {
    for (const NamedMesh& mesh : test::test_meshes()) {
        SCOPED_TRACE(mesh.name);
        for (const BvhOptions& options :
             {BvhOptions{}, BvhOptions{.levels = 1}, BvhOptions{.levels = 5},
              BvhOptions{.axes = AxisRule::fixed_xyz, .leaf_triangles = 1}}) {
            expect_whole(build_bvh(mesh.triangles, options), mesh.triangles.size());
        }
    }
}

TEST(Bvh, of_nothing_is_empty_and_of_one_is_a_leaf) {
    EXPECT_TRUE(build_bvh({}).empty());
    EXPECT_EQ(stats_of(build_bvh({})).nodes, 0u);
    const std::vector<Triangle> one = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}};
    const Bvh bvh = build_bvh(one);
    EXPECT_EQ(bvh.levels, 1);
    EXPECT_TRUE(is_leaf(bvh.nodes[1]));
}

TEST(Bvh, equal_centroids_share_a_leaf_and_are_reported) {
    const std::vector<Triangle> equal(3000, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    EXPECT_EQ(stats_of(build_bvh(equal)).longest_leaf, 3000u);
}

TEST(Bvh, longest_cells_halve_the_tests_of_a_noisy_wall_and_leave_a_room_as_it_was) {
    const auto cost = [](const std::vector<Triangle>& triangles, AxisRule axes) {
        const BvhStats stats =
            stats_of(build_bvh(triangles, {.levels = 16, .axes = axes, .leaf_triangles = 1}));
        return stats.box_tests + stats.triangle_tests;
    };
    const auto wall = test::noisy_wall(160, 118, 3);
    EXPECT_GT(cost(wall, AxisRule::fixed_xyz), 2 * cost(wall, AxisRule::longest_cell));
    const auto ball = test::sphere_mesh({0, 0, 0}, 1, 64, 128);
    EXPECT_NEAR(cost(ball, AxisRule::longest_cell) / cost(ball, AxisRule::fixed_xyz), 1, 0.05);
}

TEST(Bvh, refit_fits_moved_triangles_as_a_build_would_and_keeps_the_order) {
    for (const NamedMesh& mesh : test::test_meshes()) {
        SCOPED_TRACE(mesh.name);
        Bvh bvh = build_bvh(mesh.triangles);
        const auto order = bvh.triangles;
        refit_bvh(bvh, mesh.triangles);
        const Bvh again = build_bvh(mesh.triangles);
        for (std::size_t n = 1; n < bvh.nodes.size(); ++n) {
            ASSERT_EQ(bvh.nodes[n].lo, again.nodes[n].lo);
            ASSERT_EQ(bvh.nodes[n].hi, again.nodes[n].hi);
        }
        auto moved = mesh.triangles;
        for (Triangle& t : moved) {
            for (glm::vec3* p : {&t.a, &t.b, &t.c}) *p = glm::vec3(p->z, 1 - p->x, 2 * p->y);
        }
        refit_bvh(bvh, moved);
        expect_whole(bvh, moved.size());
        for (std::size_t i = 0; i < order.size(); ++i) {
            ASSERT_EQ(bvh.triangles[i].id, order[i].id);
            ASSERT_EQ(bvh.triangles[i].a, moved[order[i].id].a);
        }
    }
}

TEST(TriangleSoup, refuses_what_has_no_surface_and_counts_it) {
    TriangleSoup soup;
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float inf = std::numeric_limits<float>::infinity();
    soup.add({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {});
    soup.add({{0, 0, nan}, {1, 0, 0}, {0, 1, 0}}, {});
    soup.add({{0, 0, 0}, {1, -inf, 0}, {0, 1, 0}}, {});
    soup.add({{0, 0, 0}, {1, 0, 0}, {0, 2e9f, 0}}, {});
    soup.add({{3, 3, 3}, {3, 3, 3}, {3, 3, 3}}, {});
    soup.add({{0, 0, 0}, {1, 1, 1}, {2, 2, 2}}, {});
    soup.add({{0, 0, 0}, {1, 1, 1}, {2, 2, 2.0000002f}}, {});  // a sliver is a triangle
    EXPECT_EQ(soup.triangles.size(), 2u);
    EXPECT_EQ(soup.not_finite, 3u);
    EXPECT_EQ(soup.zero_area, 2u);
}

Scene scene_of(const std::vector<Triangle>& triangles, const glm::dvec3& at) {
    auto mesh = std::make_shared<MeshAsset>();
    for (const Triangle& t : triangles) {
        for (const glm::vec3& p : {t.a, t.b, t.c}) {
            mesh->indices.push_back(static_cast<std::uint32_t>(mesh->positions.size()));
            mesh->positions.push_back(p);
            mesh->normals.emplace_back(0, 1, 0);
        }
    }
    Scene scene;
    glm::dmat4 world_from_object(1);
    world_from_object[3] = glm::dvec4(at, 1);
    scene.meshes.push_back({.id = 7, .mesh = mesh, .world_from_object = world_from_object});
    return scene;
}

TEST(TriangleSoup, a_scene_ten_thousand_km_off_loses_nothing) {
    const auto& spot = test::test_meshes()[0].triangles;
    const TriangleSoup near = gather_triangles(scene_of(spot, {0, 0, 0}));
    const TriangleSoup far = gather_triangles(scene_of(spot, {1e7, -1e7, 1e7}));
    ASSERT_EQ(near.triangles.size(), spot.size());
    ASSERT_EQ(far.triangles.size(), spot.size());
    for (std::size_t i = 0; i < spot.size(); ++i) {
        ASSERT_LT(glm::length(near.triangles[i].a - far.triangles[i].a), 1e-7f);
        ASSERT_EQ(far.sources[i], (TriangleSoup::Source{7, static_cast<std::uint32_t>(i)}));
    }
}

TEST(TriangleSoup, skinned_meshes_are_posed) {
    Scene scene = scene_of({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}, {0, 0, 0});
    auto mesh = std::make_shared<MeshAsset>(*scene.meshes[0].mesh);
    mesh->joints.assign(3, {0, 1, 0, 0});
    mesh->weights = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0.5f, 0.5f, 0, 0}};
    glm::mat4 up(1);
    up[3] = glm::vec4(0, 2, 0, 1);
    scene.meshes[0].mesh = mesh;
    scene.meshes[0].pose =
        std::make_shared<const std::vector<glm::mat4>>(std::vector<glm::mat4>{glm::mat4(1), up});
    const TriangleSoup soup = gather_triangles(scene);
    ASSERT_EQ(soup.triangles.size(), 1u);
    const auto world = [&](const glm::vec3& p) { return glm::vec3(glm::dvec3(p) + soup.center); };
    EXPECT_EQ(world(soup.triangles[0].a), glm::vec3(0, 0, 0));
    EXPECT_EQ(world(soup.triangles[0].b), glm::vec3(1, 2, 0));
    EXPECT_EQ(world(soup.triangles[0].c), glm::vec3(0, 2, 0));
}

TEST(TriangleSoup, dual_quaternions_take_vertices_where_they_are_drawn) {
    Scene scene = scene_of({{{0, 0, 0}, {1, 0.2f, 0}, {0.3f, 1, 0.4f}}}, {0, 0, 0});
    auto mesh = std::make_shared<MeshAsset>(*scene.meshes[0].mesh);
    mesh->joints.assign(3, {0, 1, 2, 0});
    mesh->weights = {{0.6f, 0.4f, 0, 0}, {0.2f, 0.3f, 0.5f, 0}, {0.45f, 0.55f, 0, 0}};
    std::vector<glm::mat4> pose(3, glm::mat4(1));
    pose[1] = glm::rotate(glm::translate(glm::mat4(1), {0.1f, 0.4f, 0}), 2.6f, {1, 0.2f, 0});
    pose[2] = glm::scale(glm::rotate(glm::mat4(1), -1.9f, {0, 1, 0.5f}), {1.2f, 0.8f, 1.1f});
    MeshNode& node = scene.meshes[0];
    node.mesh = mesh;
    node.pose = std::make_shared<const std::vector<glm::mat4>>(pose);
    node.skin = SkinBlend::dual_quaternion;
    const std::vector<test::SkinnedVertex> reference = test::skin_mesh(node);
    const TriangleSoup soup = gather_triangles(scene);
    ASSERT_EQ(soup.triangles.size(), 1u);
    const glm::vec3* corner = &soup.triangles[0].a;
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_LT(glm::length(glm::dvec3(corner[i]) + soup.center - reference[i].position), 1e-6);
    }
}

TEST(TriangleSoup, the_depth_frame_tears_where_it_is_drawn_torn) {
    Scene scene;
    auto surface = std::make_shared<DepthSurface>();
    surface->depth_m.resize(4, 3);
    auto rays = std::make_shared<Image<RayXy>>(4, 3);
    for (int y = 0; y < 3; ++y) {
        for (int x = 0; x < 4; ++x) {
            surface->depth_m.at(x, y) = x < 2 ? 1.0f : 2.0f;
            rays->at(x, y) = {0.01f * static_cast<float>(x), 0.01f * static_cast<float>(y)};
        }
    }
    surface->depth_m.at(0, 0) = 0;
    surface->rays = rays;
    surface->focal_px = 100;
    scene.live = LiveDepth{.surface = surface};
    EXPECT_TRUE(gather_triangles(scene).triangles.empty());  // only where asked for
    const TriangleSoup soup = gather_triangles(scene, {.live = true});
    // Columns 0-1 and 2-3 hold together, 1-2 do not; the corner without a reading takes a triangle.
    std::set<std::uint32_t> faces;
    for (const auto& source : soup.sources) faces.insert(source.face);
    EXPECT_EQ(faces, (std::set<std::uint32_t>{1, 4, 5, 6, 7, 10, 11}));
    // Nearer than 10 cm there are no readings.
    auto near = std::make_shared<DepthSurface>(*surface);
    for (float& z : near->depth_m.pixels()) z = 0.09f;
    scene.live->surface = near;
    EXPECT_TRUE(gather_triangles(scene, {.live = true}).triangles.empty());
}

}  // namespace
}  // namespace kino
