#include "apps/viewer/zoom_work.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <memory>
#include <vector>

#include "tests/support/random.h"
#include "viz/surface/mesh_shapes.h"

namespace kino {
namespace {

View small_view(int width = 640, int height = 360) {
    return {.width = width,
            .height = height,
            .projection = perspective(0.9, width, height),
            .world_from_view = look_at({0, 0, 0}, {0, 0, -1})};
}

void put_box(Scene& scene, const glm::vec3& size, const glm::dvec3& at,
             std::uint32_t material = 0) {
    MeshNode node{.id = static_cast<std::uint32_t>(scene.meshes.size() + 1),
                  .mesh = make_box(size),
                  .material = material};
    node.world_from_object[3] = glm::dvec4(at, 1);
    scene.meshes.push_back(std::move(node));
}

/// By a ray through every pixel's centre, and boxes whose sides are parallel to the axes.
struct Counted {
    double covered = 0, lobes = 0;
};
Counted by_every_pixel(const Scene& scene, const View& view) {
    Counted counted;
    for (int v = 0; v < view.height; ++v) {
        for (int u = 0; u < view.width; ++u) {
            const glm::dvec3 ray = view.world_from_view.rotation *
                                   glm::dvec3((u - view.projection.cx) / view.projection.fx,
                                              (v - view.projection.cy) / view.projection.fy, 1);
            const glm::dvec3 eye = view.world_from_view.translation;
            double best = 1e30;
            std::uint32_t material = 0;
            for (const MeshNode& node : scene.meshes) {
                glm::dvec3 least(1e30), most(-1e30);
                for (const glm::vec3& p : node.mesh->positions) {
                    const glm::dvec3 at = glm::dvec3(p) + glm::dvec3(node.world_from_object[3]);
                    least = glm::min(least, at);
                    most = glm::max(most, at);
                }
                double in = 0.05, out = 1e30;
                for (int axis = 0; axis < 3; ++axis) {
                    double a = (least[axis] - eye[axis]) / ray[axis];
                    double b = (most[axis] - eye[axis]) / ray[axis];
                    if (a > b) std::swap(a, b);
                    in = std::max(in, a);
                    out = std::min(out, b);
                }
                if (in < out && in < best) {
                    best = in;
                    material = node.material;
                }
            }
            if (best > 1e29) continue;
            counted.covered += 1;
            for (const Light& light : scene.lights) {
                const bool near = glm::distance(eye + best * ray, light.position) < light.radius_m;
                if (near && (light.material_mask >> material & 1u) != 0) counted.lobes += 1;
            }
        }
    }
    return counted;
}

TEST(ZoomWork, CountsAsARayThroughEveryPixelWould) {
    test::Random random(11);
    const View view = small_view(96, 54);
    WorkCounter counter;
    double covered_off = 0, lobes_off = 0;
    constexpr int kRounds = 40;
    for (int round = 0; round < kRounds; ++round) {
        Scene scene;
        scene.materials.resize(3);
        for (int i = random.integer(1, 6); i > 0; --i) {
            put_box(
                scene,
                {static_cast<float>(random.real(0.3, 3)), static_cast<float>(random.real(0.3, 3)),
                 static_cast<float>(random.real(0.1, 1))},
                {random.real(-2, 2), random.real(-1, 1), random.real(-6, -2)},
                static_cast<std::uint32_t>(random.integer(1, 3)));
        }
        for (int i = 0; i < 30; ++i) {
            scene.lights.push_back(
                {.kind = LightKind::point,
                 .position = {random.real(-3, 3), random.real(-2, 2), random.real(-6, 0)},
                 .radius_m = static_cast<float>(random.real(0.5, 4)),
                 .material_mask = static_cast<std::uint32_t>(random.integer(0, 15))});
        }
        const FrameWork work = counter.count(scene, view);
        const Counted truth = by_every_pixel(scene, view);
        EXPECT_NEAR(work.covered, truth.covered, 0.12 * work.pixels) << round;
        covered_off += (work.covered - truth.covered) / work.pixels / kRounds;
        lobes_off += (work.lobes - truth.lobes) / truth.lobes / kRounds;
    }
    // No bias: what one picture's rays miss another's hit.
    EXPECT_LT(std::abs(covered_off), 0.015);
    EXPECT_LT(std::abs(lobes_off), 0.05);
}

TEST(ZoomWork, WhatCannotBeSeenIsNoWork) {
    WorkCounter counter;
    Scene scene;
    put_box(scene, {1, 1, 1}, {0, 0, 5});    // behind
    put_box(scene, {1, 1, 1}, {50, 0, -3});  // beside
    scene.lights.push_back({.kind = LightKind::directional});
    const FrameWork hidden = counter.count(scene, small_view());
    EXPECT_EQ(hidden.draws, 0);
    EXPECT_EQ(hidden.triangles, 0);
    EXPECT_EQ(hidden.covered, 0);
    EXPECT_EQ(hidden.lobes, 0);
    EXPECT_EQ(hidden.pixels, 640 * 360);
    // Who stands in a room sees nothing but the room.
    put_box(scene, {10, 10, 10}, {0, 0, 0});
    const FrameWork within = counter.count(scene, small_view());
    EXPECT_EQ(within.draws, 1);
    EXPECT_EQ(within.triangles, 12);
    EXPECT_NEAR(within.covered, within.pixels, 1);
    EXPECT_NEAR(within.lobes, within.pixels, 1);
    EXPECT_EQ(counter.count(scene, View{}).pixels, 0);
}

TEST(ZoomWork, LobesShadowsAndKindsOfLightCount) {
    WorkCounter counter;
    Scene scene;
    scene.materials = {{.layers = {{.lobes = {{}, {}}}, {.lobes = {{}}}}},
                       {.kind = MaterialKind::unlit}};
    put_box(scene, {40, 40, 0.1f}, {0, 0, -4}, 1);
    scene.lights = {{.kind = LightKind::point, .position = {0, 0, -2}, .radius_m = 50},
                    {.kind = LightKind::spot,  // turned away
                     .position = {0, 0, -2},
                     .direction = {0, 0, 1},
                     .radius_m = 50},
                    {.kind = LightKind::directional, .shadow = LightShadow::raycast},
                    {.kind = LightKind::point, .radius_m = 50, .material_mask = ~2u}};
    const FrameWork work = counter.count(scene, small_view());
    EXPECT_NEAR(work.lobes, 2 * 3 * work.pixels, 1);
    EXPECT_NEAR(work.shadowed, work.pixels, 1);
    scene.meshes[0].material = 2;
    EXPECT_EQ(counter.count(scene, small_view()).lobes, 0);
    EXPECT_NEAR(counter.count(scene, small_view()).covered, work.pixels, 1);
}

TEST(ZoomWork, TheLiveSurfaceCoversWhereItIs) {
    auto surface = std::make_shared<DepthSurface>();
    surface->depth_m = Image<float>(160, 120);
    auto rays = std::make_shared<Image<RayXy>>(160, 120);
    for (int y = 0; y < 120; ++y) {
        for (int x = 0; x < 160; ++x) {
            rays->at(x, y) = {(static_cast<float>(x) - 79.5f) / 140,
                              (static_cast<float>(y) - 59.5f) / 140};
            surface->depth_m.at(x, y) = x < 80 ? 2.0f : 0.0f;
        }
    }
    surface->rays = rays;
    Scene scene;
    scene.live = LiveDepth{.surface = surface};
    View view = small_view(640, 480);
    view.world_from_view = {};
    view.projection = {.fx = 560, .fy = 560, .cx = 319.5, .cy = 239.5};
    const FrameWork work = WorkCounter().count(scene, view);
    EXPECT_EQ(work.live_points, 160 * 120);
    EXPECT_NEAR(work.covered / work.pixels, 0.5, 0.02);
}

}  // namespace
}  // namespace kino
