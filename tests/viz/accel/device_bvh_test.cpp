#include "viz/accel/device_bvh.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cstring>
#include <limits>

#include "tests/viz/accel/support/gpu_frame.h"
#include "tests/viz/accel/support/ray_meshes.h"
#include "tests/viz/accel/support/shadow_stage.h"
#include "tests/viz/viz_fixture.h"
#include "viz/accel/scene_bvh.h"

namespace kino {
namespace {

using test::NamedMesh;
using test::Readback;

class DeviceBvhTest : public test::VizTest {
  protected:
    DeviceBvhTest() : pipelines_(device()), executor_(device(), pipelines_) {}

    void expect_same(const Bvh& expected, graph::FrameGraph& graph, const BvhBuffers& made) {
        ASSERT_EQ(made.levels, expected.levels);
        const Readback<shared::BvhNode> nodes(device(), graph, made.nodes, expected.nodes.size());
        const Readback<shared::BvhTriangle> triangles(device(), graph, made.triangles,
                                                      expected.triangles.size());
        ASSERT_TRUE(executor_.run(graph, graph::Timing::frame).has_value());
        const auto found = nodes.values();
        for (std::size_t n = 0; n < found.size(); ++n) {
            ASSERT_EQ(std::memcmp(&found[n], &expected.nodes[n], sizeof(found[n])), 0)
                << "node " << n << ": " << found[n].first << ' ' << found[n].word << " and "
                << expected.nodes[n].first << ' ' << expected.nodes[n].word;
        }
        const auto order = triangles.values();
        for (std::size_t i = 0; i < order.size(); ++i) {
            ASSERT_EQ(std::memcmp(&order[i], &expected.triangles[i], sizeof(order[i])), 0) << i;
        }
    }

    gpu::Pipelines pipelines_;
    graph::Executor executor_;
};

std::vector<Triangle> moved(std::vector<Triangle> triangles) {
    for (Triangle& t : triangles) {
        for (glm::vec3* p : {&t.a, &t.b, &t.c}) *p = glm::vec3(p->z, 1 - p->x, 2 * p->y);
    }
    return triangles;
}

TEST_F(DeviceBvhTest, builds_and_refits_the_hosts_tree_bit_by_bit) {
    for (const NamedMesh& mesh : test::test_meshes()) {
        for (const BvhOptions& options :
             {BvhOptions{},
              BvhOptions{.levels = 7, .axes = AxisRule::fixed_xyz, .leaf_triangles = 1}}) {
            SCOPED_TRACE(mesh.name);
            DeviceBvh tree(device());
            ASSERT_TRUE(tree.upload_soup(mesh.triangles, options).has_value());
            Bvh expected = build_bvh(mesh.triangles, options);
            {
                graph::FrameGraph graph(executor_.history());
                expect_same(expected, graph, tree.add_build(graph));
            }
            const auto later = moved(mesh.triangles);
            ASSERT_TRUE(tree.upload_soup(later, options).has_value());
            refit_bvh(expected, later);
            graph::FrameGraph graph(executor_.history());
            expect_same(expected, graph, tree.add_refit(graph));
            if (HasFatalFailure()) return;
        }
    }
}

TEST_F(DeviceBvhTest, traces_the_hosts_hits) {
    for (const NamedMesh& mesh : test::test_meshes()) {
        SCOPED_TRACE(mesh.name);
        const Bvh bvh = build_bvh(mesh.triangles);
        DeviceBvh tree(device());
        ASSERT_TRUE(tree.upload(bvh).has_value());
        test::Random random(21);
        std::vector<Ray> rays;
        std::vector<shared::TraceRay> records;
        for (int i = 0; i < 1500; ++i) {
            Ray ray = test::random_ray(random, mesh.triangles);
            if (i == 0) ray.direction = glm::vec3(0);
            if (i == 1) ray.origin.x = std::numeric_limits<float>::quiet_NaN();
            rays.push_back(ray);
            records.push_back({ray.origin, ray.t_min, ray.direction, ray.t_max});
        }
        auto buffer = gpu::Buffer::create(device(), "rays", records.size() * sizeof(records[0]),
                                          gpu::MemoryUse::upload);
        ASSERT_TRUE(buffer.has_value());
        buffer->write(std::span<const shared::TraceRay>(records));
        graph::FrameGraph graph(executor_.history());
        const BvhBuffers made = tree.add(graph);
        const graph::BufferId in = graph.import_buffer("rays", *buffer);
        const auto count = static_cast<std::uint32_t>(rays.size());
        const Readback<shared::TraceHit> closest(device(), graph,
                                                 add_trace(graph, made, in, count, false), count);
        const Readback<shared::TraceHit> any(device(), graph,
                                             add_trace(graph, made, in, count, true), count);
        ASSERT_TRUE(executor_.run(graph, graph::Timing::frame).has_value());
        const auto found = closest.values();
        const auto found_any = any.values();
        for (std::size_t i = 0; i < rays.size(); ++i) {
            const RayHit hit = closest_hit(bvh, rays[i]);
            ASSERT_EQ(found[i].triangle, hit.triangle) << i;
            ASSERT_EQ(found[i].t, hit.t) << i;
            ASSERT_EQ(found_any[i].triangle == 0, hit.hit()) << i;
        }
    }
}

TEST_F(DeviceBvhTest, a_still_scene_is_built_once_and_a_moving_one_refitted) {
    for (const BuildPlace place : {BuildPlace::host, BuildPlace::device}) {
        Scene scene;
        scene.meshes = {test::mesh_node(test::sphere_mesh({0, 0, 0}, 1, 8, 16)),
                        test::mesh_node(test::sphere_mesh({3, 0, 0}, 1, 8, 16))};
        scene.meshes[1].id = 2;
        const SceneBvhOptions options{.place = place};
        SceneBvh bvh(device());
        const auto frame = [&] {
            ASSERT_TRUE(bvh.upload(scene, options).has_value());
            graph::FrameGraph graph(executor_.history());
            const SceneBvhPasses made = bvh.add(graph);
            const Bvh expected = build_bvh(bvh.soup().triangles, options.tree);
            // A refitted tree has the same root.
            const Readback<shared::BvhNode> nodes(device(), graph, made.tree.nodes, 2);
            ASSERT_TRUE(executor_.run(graph, graph::Timing::frame).has_value());
            EXPECT_EQ(nodes.values()[1].lo, expected.nodes[1].lo);
            EXPECT_EQ(nodes.values()[1].hi, expected.nodes[1].hi);
        };
        for (int i = 0; i < 5; ++i) frame();
        EXPECT_EQ(bvh.counts().builds, 1u);
        EXPECT_EQ(bvh.counts().kept, 4u);
        EXPECT_GT(bvh.bytes(), 0u);
        scene.meshes[1].world_from_object[3].y = 0.25;
        frame();
        EXPECT_EQ(bvh.counts().refits, 1u);
        scene.meshes.pop_back();
        frame();
        EXPECT_EQ(bvh.counts().builds, 2u);
        scene.meshes.clear();
        ASSERT_TRUE(bvh.upload(scene, options).has_value());
        graph::FrameGraph graph(executor_.history());
        EXPECT_TRUE(bvh.add(graph).tree.empty());
        EXPECT_TRUE(graph.passes().empty());
        EXPECT_EQ(bvh.bytes(), 0u);
    }
}

TEST_F(DeviceBvhTest, a_refitted_tree_that_has_become_poor_is_built_again) {
    Scene scene;
    for (int i = 0; i < 12; ++i) {
        scene.meshes.push_back(
            test::mesh_node(test::sphere_mesh({2.0f * float(i), 0, 0}, 0.5f, 6, 12)));
        scene.meshes.back().id = static_cast<std::uint32_t>(i + 1);
    }
    SceneBvh bvh(device());
    ASSERT_TRUE(bvh.upload(scene).has_value());
    // The balls change places, so that neighbours in the tree are far from each other.
    for (int i = 0; i < 12; ++i) {
        scene.meshes[static_cast<std::size_t>(i)].world_from_object[3].x = 2.0 * ((7 * i) % 12 - i);
    }
    ASSERT_TRUE(bvh.upload(scene).has_value());
    EXPECT_EQ(bvh.counts().builds, 2u);
    EXPECT_EQ(bvh.counts().refits, 0u);
}

}  // namespace
}  // namespace kino
