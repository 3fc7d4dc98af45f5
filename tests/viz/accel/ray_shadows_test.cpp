#include "viz/light/ray_shadows.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>

#include "tests/viz/accel/gpu_frame.h"
#include "tests/viz/accel/support/embree_peer.h"
#include "tests/viz/accel/support/ray_meshes.h"
#include "tests/viz/viz_fixture.h"
#include "viz/light/light_shared.h"
#include "viz/light/shadow_shared.h"

namespace kino {
namespace {

using test::Readback;

constexpr int kWidth = 66;  // the last tiles and texels are cut off
constexpr int kHeight = 47;
constexpr float kOffset = 5e-4f;

MeshNode shadow_node(const std::vector<Triangle>& triangles) {
    auto mesh = std::make_shared<MeshAsset>();
    for (const Triangle& t : triangles) {
        for (const glm::vec3& p : {t.a, t.b, t.c}) {
            mesh->indices.push_back(static_cast<std::uint32_t>(mesh->positions.size()));
            mesh->positions.push_back(p);
            mesh->normals.emplace_back(0, 1, 0);
        }
    }
    return {.id = 1, .mesh = mesh};
}

std::int16_t snorm16(float x) {
    return static_cast<std::int16_t>(std::lround(std::clamp(x, -1.0f, 1.0f) * 32767));
}

std::array<std::int16_t, 2> octahedral(const glm::vec3& n) {
    glm::vec2 o = glm::vec2(n) / (std::abs(n.x) + std::abs(n.y) + std::abs(n.z));
    if (n.z < 0) {
        o = {(1 - std::abs(o.y)) * (o.x >= 0 ? 1.0f : -1.0f),
             (1 - std::abs(o.x)) * (o.y >= 0 ? 1.0f : -1.0f)};
    }
    return {snorm16(o.x), snorm16(o.y)};
}

glm::vec3 from_octahedral(const std::array<std::int16_t, 2>& bits) {
    const float x = std::max(static_cast<float>(bits[0]) / 32767.0f, -1.0f);
    const float y = std::max(static_cast<float>(bits[1]) / 32767.0f, -1.0f);
    glm::vec3 n(x, y, 1 - std::abs(x) - std::abs(y));
    const float fold = std::max(-n.z, 0.0f);
    n.x += n.x >= 0 ? -fold : fold;
    n.y += n.y >= 0 ? -fold : fold;
    return glm::normalize(n);
}

/// A room with balls, seen from a corner, and what a rasteriser would have made of it.
struct Stage {
    Scene scene;
    View view;
    std::vector<float> view_z;
    std::vector<std::array<std::int16_t, 2>> normals;
};

Stage make_stage(int lights, bool spots) {
    Stage stage;
    const auto triangles = test::room_mesh(7, 10, 31);
    stage.scene.meshes = {shadow_node(triangles)};
    // Away from the origin, so that the tree's center matters.
    const glm::dvec3 at(40, -3, 7);
    stage.scene.meshes[0].world_from_object[3] = glm::dvec4(at, 1);
    stage.view = {.width = kWidth, .height = kHeight};
    stage.view.projection = perspective(1.1, kWidth, kHeight);
    stage.view.world_from_view =
        look_at(at + glm::dvec3(2.5, 2.2, 2.1), at + glm::dvec3(-0.5, 0.4, -0.5));
    test::Random random(32);
    for (int i = 0; i < lights; ++i) {
        Light light;
        light.kind = spots && i % 3 == 1 ? LightKind::spot : LightKind::point;
        light.position =
            at + glm::dvec3(random.real(-2.8, 2.8), random.real(0.3, 2.9), random.real(-2.3, 2.3));
        light.direction = {random.real(-1, 1), -1, random.real(-1, 1)};
        light.outer_rad = 0.7f;
        light.radius_m = static_cast<float>(random.real(1.5, 4));
        light.shadow = i % 4 == 3 ? LightShadow::none : LightShadow::raycast;
        stage.scene.lights.push_back(light);
    }
    stage.scene.lights.push_back({.kind = LightKind::directional,
                                  .direction = {0.3, -1, 0.2},
                                  .shadow = LightShadow::raycast});
    const Bvh bvh = build_bvh(triangles);
    const glm::dmat3 rotation = glm::mat3_cast(stage.view.world_from_view.rotation);
    for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
            const Projection& k = stage.view.projection;
            const glm::dvec3 ray((x - k.cx) / k.fx, (y - k.cy) / k.fy, 1);
            const RayHit hit =
                closest_hit(bvh, {.origin = stage.view.world_from_view.translation - at,
                                  .direction = rotation * ray});
            // A hole, and one pixel of a texel alone.
            const bool hole = x < 9 && y < 9 && !(x == 5 && y == 5);
            stage.view_z.push_back(hole ? 0.0f : hit.t);
            const Triangle& t = triangles[hit.triangle];
            glm::dvec3 n = glm::transpose(rotation) *
                           glm::dvec3(glm::normalize(glm::cross(t.b - t.a, t.c - t.a)));
            if (glm::dot(n, ray) > 0) n = -n;
            stage.normals.push_back(octahedral(n));
        }
    }
    return stage;
}

struct Cast {
    std::vector<glm::uvec4> masks;
    shared::ShadowCounters counters{};
    std::vector<shared::LightRecord> lights;
    std::vector<glm::uvec2> headers;
    std::vector<std::uint32_t> indices;
    LightLists lists;
};

class RayShadowsTest : public test::VizTest {
  protected:
    RayShadowsTest() : pipelines_(device()), executor_(device(), pipelines_) {}

    Cast cast(const Stage& stage, const RayShadowOptions& options,
              const SceneBvhOptions& tree = {}) {
        const VkExtent2D extent{kWidth, kHeight};
        const auto z = test::make_texture(device(), extent, kViewZFormat, stage.view_z);
        const auto n = test::make_texture(device(), extent, kNormalFormat, stage.normals);
        SceneBvh bvh(device());
        if (!bvh.upload(stage.scene, tree)) throw std::runtime_error("no memory for the tree");
        graph::FrameGraph graph(executor_.history());
        const ShadowSurface surface{
            graph.import_texture("z", z.image(), z.view(), {kWidth, kHeight, kViewZFormat}),
            graph.import_texture("n", n.image(), n.view(), {kWidth, kHeight, kNormalFormat})};
        Cast found;
        found.lists =
            add_light_lists(graph, stage.scene, stage.view, surface.view_z, {.tile_px = 16});
        const RayShadows shadows = add_ray_shadows(graph, stage.scene, stage.view, surface,
                                                   found.lists, bvh.add(graph), options);
        const std::size_t pixels = std::size_t{kWidth} * kHeight;
        const Readback<glm::uvec4> masks(device(), graph, shadows.masks, pixels);
        const Readback<shared::ShadowCounters> counters(device(), graph, shadows.counters, 1);
        const Readback<shared::LightRecord> lights(
            device(), graph, found.lists.lights,
            found.lists.global_count + found.lists.local_count);
        const bool has_lists = found.lists.tile_px != 0;
        const std::size_t tiles = has_lists ? found.lists.tiles_x * found.lists.tiles_y : 0;
        std::optional<Readback<glm::uvec2>> headers;
        std::optional<Readback<std::uint32_t>> indices;
        if (has_lists) {
            headers.emplace(device(), graph, found.lists.headers, tiles);
            indices.emplace(device(), graph, found.lists.indices, tiles * 256);
        }
        const auto report = executor_.run(graph, graph::Timing::frame);
        if (!report) throw std::runtime_error(report.error().to_string());
        found.masks = masks.values();
        found.counters = counters.values()[0];
        found.lights = lights.values();
        if (has_lists) {
            found.headers = headers->values();
            found.indices = indices->values();
        }
        return found;
    }

    gpu::Pipelines pipelines_;
    graph::Executor executor_;
};

/// What the processor makes of one pixel: a ray for every light of its list that faces it.
struct PixelRays {
    struct Job {
        std::uint32_t slot;
        Ray ray;
    };
    std::vector<Job> jobs;
};

PixelRays rays_of(const Stage& stage, const Cast& cast, const glm::dvec3& center, int x, int y) {
    PixelRays rays;
    const auto i = static_cast<std::size_t>(y * kWidth + x);
    const float z = stage.view_z[i];
    if (!(z > 0)) return rays;
    const Projection& k = stage.view.projection;
    const glm::vec2 inverse(1 / k.fx, 1 / k.fy);
    const glm::vec3 at((static_cast<float>(x) - static_cast<float>(k.cx)) * inverse.x * z,
                       (static_cast<float>(y) - static_cast<float>(k.cy)) * inverse.y * z, z);
    const glm::vec3 n = from_octahedral(stage.normals[i]);
    const bool has_lists = cast.lists.tile_px != 0;
    const glm::uvec2 header =
        has_lists ? cast.headers[static_cast<std::size_t>(y / 16) * cast.lists.tiles_x +
                                 static_cast<std::size_t>(x / 16)]
                  : glm::uvec2(0, cast.lists.local_count);
    for (std::uint32_t slot = 0; slot < cast.lists.global_count + header.y && slot < 128; ++slot) {
        const std::uint32_t entry = slot - cast.lists.global_count;
        const std::uint32_t light = slot < cast.lists.global_count ? slot
                                    : has_lists                    ? cast.indices[header.x + entry]
                                                : cast.lists.global_count + entry;
        const shared::LightRecord& record = cast.lights[light];
        const glm::vec3 way = record.kind == 0 ? record.place : record.place - at;
        const float squared = way.x * way.x + way.y * way.y + way.z * way.z;
        if (record.casts_shadow == 0) continue;
        if (!(way.x * n.x + way.y * n.y + way.z * n.z > 0)) continue;
        if (record.kind != 0 && !(squared < record.radius * record.radius)) continue;
        if (record.kind == 2 &&
            !(-(way.x * record.axis.x + way.y * record.axis.y + way.z * record.axis.z) >
              record.cone_cos * std::sqrt(squared))) {
            continue;
        }
        // The ray itself in double.
        const Pose& pose = stage.view.world_from_view;
        const glm::dvec3 place = pose * glm::dvec3(at) - center;
        const glm::dvec3 normal = pose.rotation * glm::dvec3(n);
        const double step = double{kOffset} * std::max({std::abs(place.x), std::abs(place.y),
                                                        std::abs(place.z), double{at.z}});
        const glm::dvec3 to_light = pose.rotation * glm::dvec3(way);
        Ray ray{.origin = place + normal * step};
        ray.direction = record.kind == 0 ? to_light : to_light - normal * step;
        if (record.kind != 0) {
            ray.t_max = static_cast<float>(1 - step / glm::length(ray.direction));
        }
        rays.jobs.push_back({slot, ray});
    }
    return rays;
}

bool bit_of(const glm::uvec4& mask, std::uint32_t slot) {
    return ((mask[static_cast<int>(slot / 32)] >> (slot % 32)) & 1u) != 0;
}

TEST_F(RayShadowsTest, jobs_are_exactly_those_the_processor_counts_and_masks_are_embrees) {
    for (const int lights : {40, 6}) {  // with lists, and without
        SCOPED_TRACE(lights);
        const Stage stage = make_stage(lights, true);
        const Cast found = cast(stage, {.half_resolution = false,
                                        .rays_per_pixel = 128,
                                        .dispatch = ShadowDispatch::jobs,
                                        .offset = kOffset});
        const TriangleSoup soup = gather_triangles(stage.scene);
        const test::EmbreePeer embree(soup.triangles);
        const auto wide = test::in_double(soup.triangles);
        std::uint32_t jobs = 0;
        std::uint32_t shadowed = 0;
        std::uint32_t differing = 0;
        for (int y = 0; y < kHeight; ++y) {
            for (int x = 0; x < kWidth; ++x) {
                const glm::uvec4& mask = found.masks[static_cast<std::size_t>(y * kWidth + x)];
                std::uint32_t set = 0;
                for (int k = 0; k < 4; ++k)
                    set += static_cast<std::uint32_t>(std::popcount(mask[k]));
                for (const auto& job : rays_of(stage, found, soup.center, x, y).jobs) {
                    ++jobs;
                    const bool ours = bit_of(mask, job.slot);
                    set -= ours;
                    shadowed += ours;
                    if (ours == embree.any_hit(job.ray)) continue;
                    ++differing;
                    const double edge =
                        reference::closest_edge(wide, job.ray.origin, job.ray.direction);
                    EXPECT_LT(edge, 1e-3) << x << ' ' << y << ' ' << job.slot;
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
    const Stage stage = make_stage(60, false);
    const RayShadowOptions jobs{
        .half_resolution = false, .rays_per_pixel = 128, .dispatch = ShadowDispatch::jobs};
    const Cast expected = cast(stage, jobs);
    RayShadowOptions bands = jobs;
    bands.job_room = 3 * kWidth * 128;
    RayShadowOptions pixels = jobs;
    pixels.dispatch = ShadowDispatch::per_pixel;
    const Cast in_bands = cast(stage, bands);
    EXPECT_EQ(in_bands.masks, expected.masks);
    EXPECT_EQ(in_bands.counters.jobs, expected.counters.jobs);
    const Cast by_pixels = cast(stage, pixels);
    EXPECT_EQ(by_pixels.masks, expected.masks);
    EXPECT_EQ(by_pixels.counters.jobs, expected.counters.jobs);
    EXPECT_EQ(cast(stage, pixels, {.place = BuildPlace::device}).masks, expected.masks);
    EXPECT_EQ(cast(stage, pixels).masks, expected.masks);  // and so does another run
}

TEST_F(RayShadowsTest, a_half_mask_is_the_full_one_at_the_first_covered_pixel) {
    const Stage stage = make_stage(40, true);
    const RayShadowOptions full{.half_resolution = false, .rays_per_pixel = 128};
    RayShadowOptions half = full;
    half.half_resolution = true;
    const Cast at_full = cast(stage, full);
    for (const ShadowDispatch dispatch : {ShadowDispatch::per_pixel, ShadowDispatch::jobs}) {
        half.dispatch = dispatch;
        const Cast at_half = cast(stage, half);
        const auto at = [&](int x, int y) { return static_cast<std::size_t>(y * kWidth + x); };
        for (int y = 0; y < kHeight; ++y) {
            for (int x = 0; x < kWidth; ++x) {
                std::size_t from = at(x & ~1, y & ~1);
                for (int i = 3; i >= 0; --i) {
                    const int px = (x & ~1) + (i & 1);
                    const int py = (y & ~1) + (i >> 1);
                    if (px < kWidth && py < kHeight && stage.view_z[at(px, py)] > 0)
                        from = at(px, py);
                }
                ASSERT_EQ(at_half.masks[at(x, y)], at_full.masks[from]) << x << ' ' << y;
            }
        }
        EXPECT_LT(at_half.counters.jobs, at_full.counters.jobs * 3 / 10);
    }
}

TEST_F(RayShadowsTest, rays_beyond_a_pixels_share_are_counted_and_leave_no_shadow) {
    const Stage stage = make_stage(60, false);
    RayShadowOptions options{.half_resolution = false, .rays_per_pixel = 128};
    const Cast all = cast(stage, options);
    for (const ShadowDispatch dispatch : {ShadowDispatch::per_pixel, ShadowDispatch::jobs}) {
        options.dispatch = dispatch;
        options.rays_per_pixel = 3;
        const Cast few = cast(stage, options);
        EXPECT_GT(few.counters.capped, 0u);
        EXPECT_EQ(few.counters.jobs + few.counters.capped, all.counters.jobs);
        for (std::size_t i = 0; i < all.masks.size(); ++i) {
            for (int k = 0; k < 4; ++k) ASSERT_EQ(few.masks[i][k] & ~all.masks[i][k], 0u);
        }
    }
}

TEST_F(RayShadowsTest, nothing_that_casts_shadows_costs_nothing) {
    Stage stage = make_stage(20, false);
    const auto passes = [&](bool with_tree) {
        graph::FrameGraph graph(executor_.history());
        const auto z = graph.create_texture("z", {kWidth, kHeight, kViewZFormat});
        const auto n = graph.create_texture("n", {kWidth, kHeight, kNormalFormat});
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
