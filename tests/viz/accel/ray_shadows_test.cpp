#include "viz/light/ray_shadows.h"

#include <gmock/gmock.h>

#include <bit>
#include <cmath>

#include "tests/viz/accel/support/embree_peer.h"
#include "tests/viz/accel/support/ray_meshes.h"
#include "tests/viz/accel/support/shadow_stage.h"
#include "tests/viz/viz_fixture.h"

namespace kino {
namespace {

using test::ShadowCast;
using test::ShadowStage;

constexpr float kOffset = 5e-4f;

class RayShadowsTest : public test::VizTest {
  protected:
    RayShadowsTest() : pipelines_(device()), executor_(device(), pipelines_) {}

    ShadowCast cast(const ShadowStage& stage, const RayShadowOptions& options,
                    const SceneBvhOptions& tree = {}) {
        SceneBvh bvh(device());
        EXPECT_TRUE(bvh.upload(stage.scene, tree).has_value());
        return test::cast_shadows(device(), executor_, stage, bvh, options);
    }

    gpu::Pipelines pipelines_;
    graph::Executor executor_;
};

TEST_F(RayShadowsTest, jobs_are_exactly_those_the_processor_counts_and_masks_are_embrees) {
    for (const int lights : {40, 6}) {  // with lists, and without
        SCOPED_TRACE(lights);
        const ShadowStage stage({.lights = lights});
        const ShadowCast found = cast(stage, {.half_resolution = false,
                                              .rays_per_pixel = 128,
                                              .dispatch = ShadowDispatch::jobs,
                                              .offset = kOffset});
        const TriangleSoup soup = gather_triangles(stage.scene);
        const test::EmbreePeer embree(soup.triangles);
        const auto wide = test::in_double(soup.triangles);
        std::uint32_t jobs = 0;
        std::uint32_t shadowed = 0;
        std::uint32_t differing = 0;
        for (int y = 0; y < stage.view.height; ++y) {
            for (int x = 0; x < stage.view.width; ++x) {
                const glm::uvec4& mask = found.masks[stage.at(x, y)];
                std::uint32_t set = 0;
                for (int k = 0; k < 4; ++k) {
                    set += static_cast<std::uint32_t>(std::popcount(mask[k]));
                }
                for (const auto& [slot, ray] :
                     test::shadow_rays(stage, found, soup.center, kOffset, x, y)) {
                    ++jobs;
                    const bool ours = test::shadow_bit(mask, slot);
                    set -= ours;
                    shadowed += ours;
                    if (ours == embree.any_hit(ray)) continue;
                    ++differing;
                    EXPECT_LT(reference::closest_edge(wide, ray.origin, ray.direction), 1e-3)
                        << x << ' ' << y << ' ' << slot;
                }
                ASSERT_EQ(set, 0u) << "bits without a ray at " << x << ' ' << y;
            }
        }
        EXPECT_EQ(found.counters.jobs, jobs);
        EXPECT_EQ(found.counters.capped, 0u);
        EXPECT_GT(shadowed, jobs / 50);
        EXPECT_LT(shadowed, jobs / 2);
        EXPECT_LE(differing, jobs / 1000);
    }
}

TEST_F(RayShadowsTest, every_dispatch_every_band_and_every_place_of_the_tree_makes_the_same_masks) {
    const ShadowStage stage({.lights = 60, .spots = false});
    const RayShadowOptions jobs{
        .half_resolution = false, .rays_per_pixel = 128, .dispatch = ShadowDispatch::jobs};
    const ShadowCast expected = cast(stage, jobs);
    RayShadowOptions bands = jobs;
    bands.job_room = 3 * 66 * 128;
    RayShadowOptions pixels = jobs;
    pixels.dispatch = ShadowDispatch::per_pixel;
    const ShadowCast in_bands = cast(stage, bands);
    EXPECT_EQ(in_bands.masks, expected.masks);
    EXPECT_EQ(in_bands.counters.jobs, expected.counters.jobs);
    const ShadowCast by_pixels = cast(stage, pixels);
    EXPECT_EQ(by_pixels.masks, expected.masks);
    EXPECT_EQ(by_pixels.counters.jobs, expected.counters.jobs);
    EXPECT_EQ(cast(stage, pixels, {.place = BuildPlace::device}).masks, expected.masks);
    EXPECT_EQ(cast(stage, pixels).masks, expected.masks);  // and so does another run
}

TEST_F(RayShadowsTest, a_half_mask_is_the_full_one_at_a_pixel_traced_nearby_on_the_same_surface) {
    const ShadowStage stage({.lights = 40});
    const RayShadowOptions full{.half_resolution = false, .rays_per_pixel = 128};
    RayShadowOptions half = full;
    half.half_resolution = true;
    const ShadowCast at_full = cast(stage, full);
    // The pixel that stands for a texel.
    const auto traced = [&](int tx, int ty) {
        std::size_t from = stage.at(2 * tx, 2 * ty);
        for (int i = 3; i >= 0; --i) {
            const int px = 2 * tx + (i & 1);
            const int py = 2 * ty + (i >> 1);
            if (px < stage.view.width && py < stage.view.height &&
                stage.view_z[stage.at(px, py)] > 0) {
                from = stage.at(px, py);
            }
        }
        return from;
    };
    for (const ShadowDispatch dispatch : {ShadowDispatch::per_pixel, ShadowDispatch::jobs}) {
        half.dispatch = dispatch;
        const ShadowCast at_half = cast(stage, half);
        int from_neighbours = 0;
        for (int y = 0; y < stage.view.height; ++y) {
            for (int x = 0; x < stage.view.width; ++x) {
                const glm::uvec4& mask = at_half.masks[stage.at(x, y)];
                const std::size_t own = traced(x / 2, y / 2);
                if (mask == at_full.masks[own]) continue;
                ++from_neighbours;
                // Only where the texel's own pixel is off: other depth or another normal.
                const float z = stage.view_z[stage.at(x, y)];
                EXPECT_TRUE(std::abs(stage.view_z[own] - z) > 0.005f * z ||
                            stage.normals[own] != stage.normals[stage.at(x, y)]);
                bool found = false;
                for (int dy = 0; dy < 2; ++dy) {
                    for (int dx = 0; dx < 2; ++dx) {
                        const int tx = x / 2 + dx * ((x & 1) * 2 - 1);
                        const int ty = y / 2 + dy * ((y & 1) * 2 - 1);
                        if (tx < 0 || ty < 0 || 2 * tx >= stage.view.width ||
                            2 * ty >= stage.view.height || tx / 8 != x / 16 || ty / 8 != y / 16) {
                            continue;
                        }
                        found |= mask == at_full.masks[traced(tx, ty)];
                    }
                }
                ASSERT_TRUE(found) << x << ' ' << y;
            }
        }
        EXPECT_GT(from_neighbours, 0);
        EXPECT_LT(from_neighbours, stage.view.width * stage.view.height / 10);
        EXPECT_LT(at_half.counters.jobs, at_full.counters.jobs * 3 / 10);
    }
}

TEST_F(RayShadowsTest, rays_beyond_a_pixels_share_are_counted_and_leave_no_shadow) {
    const ShadowStage stage({.lights = 60, .spots = false});
    RayShadowOptions options{.half_resolution = false, .rays_per_pixel = 128};
    const ShadowCast all = cast(stage, options);
    for (const ShadowDispatch dispatch : {ShadowDispatch::per_pixel, ShadowDispatch::jobs}) {
        options.dispatch = dispatch;
        options.rays_per_pixel = 3;
        const ShadowCast few = cast(stage, options);
        EXPECT_GT(few.counters.capped, 0u);
        EXPECT_EQ(few.counters.jobs + few.counters.capped, all.counters.jobs);
        for (std::size_t i = 0; i < all.masks.size(); ++i) {
            for (int k = 0; k < 4; ++k) ASSERT_EQ(few.masks[i][k] & ~all.masks[i][k], 0u);
        }
    }
}

TEST_F(RayShadowsTest, the_live_frame_casts_the_shadows_that_embree_finds) {
    ShadowStage stage({.width = 48, .height = 34, .lights = 24});
    const RayShadowOptions options{
        .half_resolution = false, .rays_per_pixel = 128, .offset = kOffset};
    const ShadowCast without = cast(stage, options);
    stage.scene.live = test::live_shell(stage, 160, 120);
    for (const int columns : {27, 80}) {
        for (const bool with_meshes : {true, false}) {
            SCOPED_TRACE(columns);
            SCOPED_TRACE(with_meshes);
            ShadowStage seen = stage;
            if (!with_meshes) seen.scene.meshes.clear();
            SceneBvh bvh(device());
            ASSERT_TRUE(bvh.upload(seen.scene, {.live_columns = columns}).has_value());
            const ShadowCast found = test::cast_shadows(device(), executor_, seen, bvh, options);
            const TriangleSoup& shell = bvh.live_soup();
            // Somewhat more or less than half of the coarse grid's cells.
            const double cells = 0.75 * columns * columns;
            EXPECT_GT(static_cast<double>(shell.triangles.size()), 0.15 * 2 * cells);
            EXPECT_LT(static_cast<double>(shell.triangles.size()), 0.65 * 2 * cells);
            const test::EmbreePeer live(shell.triangles);
            const test::EmbreePeer meshes(bvh.soup().triangles);
            const auto wide = test::in_double(shell.triangles);
            std::uint32_t rays = 0, by_shell = 0, differing = 0;
            for (int y = 0; y < seen.view.height; ++y) {
                for (int x = 0; x < seen.view.width; ++x) {
                    for (auto [slot, ray] :
                         test::shadow_rays(seen, found, bvh.soup().center, kOffset, x, y)) {
                        ++rays;
                        const bool by_mesh = with_meshes && meshes.any_hit(ray);
                        ray.t_min = options.live_bias_m / glm::length(ray.direction);
                        const bool by_live = live.any_hit(ray);
                        by_shell += by_live && !by_mesh;
                        const bool ours = test::shadow_bit(found.masks[seen.at(x, y)], slot);
                        if (ours == (by_live || by_mesh)) continue;
                        ++differing;
                        EXPECT_TRUE(by_mesh ||
                                    reference::closest_edge(wide, ray.origin, ray.direction) < 2e-3)
                            << x << ' ' << y << ' ' << slot;
                    }
                }
            }
            EXPECT_GT(by_shell, rays / 100);
            EXPECT_LE(differing, rays / 500);
            // The tree may be built by passes, and jobs may do the work of lanes.
            RayShadowOptions jobs = options;
            jobs.dispatch = ShadowDispatch::jobs;
            EXPECT_EQ(
                cast(seen, jobs, {.place = BuildPlace::device, .live_columns = columns}).masks,
                found.masks);
        }
    }
    // A frame that does not ask for it has no tree, and the masks are the bits that they were.
    stage.scene.live->casts_shadows = false;
    SceneBvh bvh(device());
    ASSERT_TRUE(bvh.upload(stage.scene).has_value());
    EXPECT_TRUE(bvh.live_soup().triangles.empty());
    EXPECT_EQ(test::cast_shadows(device(), executor_, stage, bvh, options).masks, without.masks);
}

// What stands is not built again because somebody moves, and a frame that is shown twice is
// gathered once.
TEST_F(RayShadowsTest, the_live_frames_tree_leaves_that_of_the_meshes_alone) {
    ShadowStage stage({.lights = 9});
    stage.scene.live = test::live_shell(stage, 160, 120);
    SceneBvh bvh(device());
    ASSERT_TRUE(bvh.upload(stage.scene).has_value());
    const std::uint64_t with_live = bvh.bytes();
    for (int frame = 0; frame < 3; ++frame) {
        stage.scene.live->surface = std::make_shared<DepthSurface>(*stage.scene.live->surface);
        ASSERT_TRUE(bvh.upload(stage.scene).has_value());
    }
    EXPECT_EQ(bvh.counts().builds, 1u);
    EXPECT_EQ(bvh.counts().refits, 0u);
    EXPECT_EQ(bvh.counts().kept, 3u);
    stage.scene.live->casts_shadows = false;
    ASSERT_TRUE(bvh.upload(stage.scene).has_value());
    EXPECT_LT(bvh.bytes(), with_live);
}

TEST_F(RayShadowsTest, nothing_that_casts_shadows_costs_nothing) {
    ShadowStage stage({.lights = 20});
    const auto passes = [&](bool with_tree) {
        graph::FrameGraph graph(executor_.history());
        const auto z = graph.create_texture("z", {66, 47, kViewZFormat});
        const auto n = graph.create_texture("n", {66, 47, kNormalFormat});
        const LightLists lists = add_light_lists(graph, stage.scene, stage.view, z, {});
        const std::size_t before = graph.passes().size();
        SceneBvh bvh(device());
        if (with_tree) {
            EXPECT_TRUE(bvh.upload(stage.scene).has_value());
        }
        const RayShadows shadows =
            add_ray_shadows(graph, stage.scene, stage.view, {z, n}, lists, bvh.add(graph), {});
        EXPECT_EQ(shadows.masks.valid(), graph.passes().size() > before);
        return graph.passes().size() - before;
    };
    EXPECT_TRUE(wants_ray_shadows(stage.scene));
    EXPECT_EQ(passes(true), 3u);
    EXPECT_EQ(passes(false), 0u);  // nothing to hide behind
    for (Light& light : stage.scene.lights) light.shadow = LightShadow::none;
    EXPECT_FALSE(wants_ray_shadows(stage.scene));
    EXPECT_EQ(passes(true), 0u);
    stage.scene.lights[0].shadow = LightShadow::raycast;
    stage.scene.lights[0].radius_m = -1;  // is dropped on the way to the device
    EXPECT_FALSE(wants_ray_shadows(stage.scene));
    EXPECT_TRUE(pipelines_.names().empty());
}

}  // namespace
}  // namespace kino
