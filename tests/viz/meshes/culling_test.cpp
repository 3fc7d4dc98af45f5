#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <random>
#include <set>

#include "mesh_world.h"
#include "tests/reference/mesh_reference.h"
#include "viz/surface/mesh_shapes.h"

namespace kino::test {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

class CullingTest : public VizTest {
  protected:
    CullingTest() : world(device()) {}
    MeshWorld world;
    View view = view_from({0, 0, 0}, {0, 0, -1}, 32, 24);
};

/// Signed distances of a view-space point from the five planes, in double, from the projection's
/// own definition.
std::array<double, 5> plane_distances(const View& view, const glm::dvec3& p) {
    const Projection& k = view.projection;
    const double left = (-0.5 - k.cx) / k.fx;
    const double right = (view.width - 0.5 - k.cx) / k.fx;
    const double top = (-0.5 - k.cy) / k.fy;
    const double bottom = (view.height - 0.5 - k.cy) / k.fy;
    return {(p.x - left * p.z) / std::hypot(1, left), (right * p.z - p.x) / std::hypot(1, right),
            (p.y - top * p.z) / std::hypot(1, top), (bottom * p.z - p.y) / std::hypot(1, bottom),
            p.z - k.near_m};
}

// Item 3: small triangles whose spheres are random.
TEST_F(CullingTest, DeviceKeepsWhatTheDoubleTestKeepsAndOnlyAtThePlanesMore) {
    std::mt19937 random(11);
    const auto uniform = [&](double low, double high) {
        return low + (high - low) * (static_cast<double>(random()) / 4294967296.0);
    };
    // The box is what is drawn; its sphere, which alone is culled by, is of radius 1.
    MeshAsset unit = *make_box({0.01f, 0.01f, 0.01f});
    unit.sphere_radius_m = 1;
    const auto mesh = std::make_shared<const MeshAsset>(unit);
    Scene scene;
    constexpr int kSpheres = 20000;
    for (int i = 0; i < kSpheres; ++i) {
        const double far = std::pow(10.0, uniform(-1, 3));
        const glm::dvec3 center(uniform(-far, far), uniform(-far, far), uniform(-far, far));
        const double radius = std::pow(10.0, uniform(-3, 1));
        scene.meshes.push_back(node_of(
            mesh, 1, glm::scale(glm::translate(glm::dmat4(1.0), center), glm::dvec3(radius))));
    }
    const MeshPicture picture = world.draw(scene, view);
    ASSERT_EQ(picture.commands.size(), static_cast<std::size_t>(kSpheres));
    const Pose view_from_world = inverse(view.world_from_view);
    std::uint32_t kept = 0;
    int close_calls = 0;
    for (int i = 0; i < kSpheres; ++i) {
        const glm::dmat4& m = scene.meshes[static_cast<std::size_t>(i)].world_from_object;
        const glm::dvec3 center = view_from_world * glm::dvec3(m[3]);
        const double radius = m[0][0];
        const auto distances = plane_distances(view, center);
        const double least = *std::min_element(distances.begin(), distances.end()) + radius;
        const bool seen = least >= 0;
        const bool device = picture.commands[static_cast<std::size_t>(i)].instanceCount == 1;
        kept += device;
        if (seen) {
            EXPECT_TRUE(device) << i;
        } else if (device) {
            ++close_calls;
            EXPECT_LT(-least, 2.1e-5 * (glm::length(center) + radius)) << i;
        }
    }
    EXPECT_EQ(picture.counters.drawn, kept);
    EXPECT_EQ(picture.counters.culled, kSpheres - kept);
    EXPECT_EQ(picture.counters.refused, 0u);
    EXPECT_GT(kept, 500u);
    EXPECT_LT(close_calls, kSpheres / 100);
}

TEST_F(CullingTest, NothingWithATriangleInTheFrustumIsDropped) {
    const Scene scene = mixed_scene(300, 23);
    const View turned = view_from({1, 0.5, -2}, {2, 0, -5}, 32, 24);
    const MeshPicture picture = world.draw(scene, turned, {.cull_on_device_from = 0});
    const Pose view_from_world = inverse(turned.world_from_view);
    int inside = 0;
    int dropped = 0;
    for (std::size_t n = 0; n < scene.meshes.size(); ++n) {
        const WorldVertices placed = place_vertices(scene.meshes[n]);
        const auto& indices = scene.meshes[n].mesh->indices;
        bool seen = false;
        for (std::size_t t = 0; t < indices.size() && !seen; t += 3) {
            seen = in_frustum(turned, {view_from_world * placed.positions[indices[t]],
                                       view_from_world * placed.positions[indices[t + 1]],
                                       view_from_world * placed.positions[indices[t + 2]]});
        }
        inside += seen;
        const bool kept = picture.commands[n].instanceCount == 1;
        dropped += !kept;
        EXPECT_TRUE(kept || !seen) << n;
    }
    EXPECT_GT(inside, 20);
    EXPECT_GT(dropped, 100);
}

TEST_F(CullingTest, SpheresThatAreNotNumbersAreRefusedAndCounted) {
    const auto with_sphere = [](const glm::vec3& center, float radius) {
        MeshAsset mesh = *make_box({1, 1, 1});
        mesh.sphere_center = center;
        mesh.sphere_radius_m = radius;
        return std::make_shared<const MeshAsset>(mesh);
    };
    const glm::dmat4 ahead = glm::translate(glm::dmat4(1.0), {0, 0, -3});
    Scene scene;
    scene.meshes = {node_of(with_sphere({0, 0, 0}, 1), 1, ahead),
                    node_of(with_sphere({kNan, 0, 0}, 1), 2, ahead),
                    node_of(with_sphere({0, 0, kInfinity}, 1), 3, ahead),
                    node_of(with_sphere({0, 0, 0}, -1), 4, ahead),
                    node_of(with_sphere({0, 0, 0}, kNan), 5, ahead),
                    node_of(with_sphere({0, 0, 0}, 1e20f), 6, ahead)};
    for (const MeshCulling culling : {MeshCulling::zero_instance, MeshCulling::compact}) {
        const MeshPicture picture =
            world.draw(scene, view, {.culling = culling, .cull_on_device_from = 0});
        EXPECT_EQ(picture.counters.drawn, 2u);
        // The NaN radius was left out by the host already.
        EXPECT_EQ(picture.counters.refused, 3u);
        const MeshPicture on_host = world.draw(scene, view, {.culling = culling});
        EXPECT_TRUE(same(picture, on_host));
    }
    scene.meshes[0].world_from_object[3][1] = kNan;
    EXPECT_EQ(world.draw(scene, view, {.cull_on_device_from = 0}).counters.drawn, 1u);
}

// Item 10.
TEST_F(CullingTest, WhatPassesTheCapacityIsDroppedInOrderAndCounted) {
    const auto box = make_box({0.2f, 0.2f, 0.2f});
    Scene scene;
    for (int i = 0; i < 1000; ++i) {
        scene.meshes.push_back(
            node_of(box, static_cast<std::uint32_t>(i + 1),
                    glm::translate(glm::dmat4(1.0), {0.001 * (i % 50), 0.02 * (i / 50), -3})));
    }
    const MeshPicture picture =
        world.draw(scene, view, {.culling = MeshCulling::compact, .capacity = 16});
    EXPECT_EQ(picture.counters.drawn, 16u);
    EXPECT_EQ(picture.counters.overflow, 984u);
    ASSERT_EQ(picture.commands.size(), 16u);
    for (std::uint32_t i = 0; i < 16; ++i) {
        EXPECT_EQ(picture.commands[i].firstInstance, i);
        EXPECT_EQ(picture.commands[i].instanceCount, 1u);
        EXPECT_EQ(picture.commands[i].vertexOffset, 0);
    }
    Scene first = scene;
    first.meshes.resize(16);
    EXPECT_TRUE(same(picture, world.draw(first, view)));
}

// Item 12, and the case "all culled".
TEST_F(CullingTest, NothingToDrawCostsNothing) {
    const auto mesh_passes = [](const MeshPicture& picture) {
        return std::count_if(picture.report.passes.begin(), picture.report.passes.end(),
                             [](const std::string& p) {
                                 return p.starts_with("meshes/") && p != "meshes/seed depth";
                             });
    };
    Scene scene;
    EXPECT_EQ(mesh_passes(world.draw(scene, view)), 0);
    EXPECT_EQ(world.drawer.bytes(), 0u);
    for (const std::string& name : world.pipelines.names()) EXPECT_EQ(name, "meshes/seed depth");
    scene = mixed_scene(8, 1);
    EXPECT_EQ(mesh_passes(world.draw(scene, view)), 1);  // few draws: no dispatch
    EXPECT_GT(world.drawer.bytes(), 0u);
    for (MeshNode& node : scene.meshes) node.world_from_object[3][2] += 1000;
    EXPECT_EQ(mesh_passes(world.draw(scene, view)), 0);
    for (const MeshCulling culling : {MeshCulling::zero_instance, MeshCulling::compact}) {
        const MeshPicture picture =
            world.draw(scene, view, {.culling = culling, .cull_on_device_from = 0});
        EXPECT_EQ(picture.counters.drawn, 0u);
        for (const std::uint32_t object : picture.object.pixels()) ASSERT_EQ(object, 0u);
    }
    (void)world.draw(Scene(), view);
    EXPECT_EQ(world.drawer.bytes(), 0u);
}

TEST(Stretch, IsTheLargestSingularValue) {
    std::mt19937 random(3);
    const auto uniform = [&] { return static_cast<double>(random()) / 2147483648.0 - 1; };
    for (int round = 0; round < 200; ++round) {
        glm::dmat3 m;
        for (int c = 0; c < 3; ++c) m[c] = glm::dvec3(uniform(), uniform(), uniform());
        if (round % 4 == 0) m[2] = m[1] * 2.0;                      // flat
        if (round % 4 == 1) m = glm::dmat3(1.0) * (1 + uniform());  // even
        // Power iteration.
        glm::dvec3 v(0.3, 0.5, 0.7);
        for (int i = 0; i < 3000; ++i) {
            const glm::dvec3 next = glm::transpose(m) * (m * v);
            if (glm::length(next) == 0) break;
            v = glm::normalize(next);
        }
        const double truth = glm::length(m * v);
        EXPECT_GE(largest_stretch(m), truth * (1 - 1e-12));
        EXPECT_LE(largest_stretch(m), truth * (1 + 1e-4) + 1e-12) << round;
    }
}

}  // namespace
}  // namespace kino::test
