#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <chrono>
#include <memory>
#include <optional>

#include "apps/bench/lbvh_rays.h"
#include "tests/viz/accel/support/ray_meshes.h"
#include "tests/viz/accel/support/shadow_stage.h"

namespace kino {
namespace {

using bench::Candidate;
using bench::Comparison;
using bench::Timing;
using test::ShadowCast;
using test::ShadowStage;

struct ShadowLevel {
    std::string knob, name;
    RayShadowOptions options;
};

std::uint64_t bits_of(const std::vector<glm::uvec4>& masks) {
    std::uint64_t bits = 0;
    for (const glm::uvec4& mask : masks) {
        for (int k = 0; k < 4; ++k) bits += static_cast<std::uint64_t>(std::popcount(mask[k]));
    }
    return bits;
}

std::vector<glm::uvec4> difference(std::vector<glm::uvec4> a, const std::vector<glm::uvec4>& b) {
    for (std::size_t i = 0; i < a.size(); ++i) a[i] ^= b[i];
    return a;
}

/// The live frame as an occluder: its tree is made anew each frame.
void bench_live_shadows(BenchContext& context, gpu::Device& device, graph::Executor& executor) {
    const bool quick = context.quick();
    ShadowStage stage({.width = quick ? 320 : 640,
                       .height = quick ? 180 : 360,
                       .balls = 20,
                       .rings = 16,
                       .lights = 64,
                       .spots = false,
                       .unshadowed = false,
                       .hole = false});
    const std::string what =
        fmt::format("live frame of 640x480, 64 lights, {}x{}", stage.view.width, stage.view.height);
    const RayShadowOptions options{.half_resolution = false, .rays_per_pixel = 128};
    struct Level {
        std::string name;
        int columns = 0;  ///< 0: the frame casts no shadows
        BuildPlace place = BuildPlace::host;
    };
    const std::vector<Level> levels = {
        {"none", 0},         {"every pixel", 640},
        {"160 across", 160}, {"80 across", 80},
        {"40 across", 40},   {"80 across, tree by the device", 80, BuildPlace::device}};
    const LiveDepth live = test::live_shell(stage, 640, 480);
    std::vector<Timing> upload, trace;
    std::vector<ShadowCast> casts(levels.size());
    std::vector<std::size_t> triangles(levels.size());
    std::vector<std::unique_ptr<SceneBvh>> trees;
    for (const Level& level : levels) {
        upload.push_back({level.name, {}});
        trace.push_back({level.name, {}});
        trees.push_back(std::make_unique<SceneBvh>(device));
    }
    for (int round = -1; round < (quick ? 3 : 7); ++round) {
        for (std::size_t i = 0; i < levels.size(); ++i) {
            stage.scene.live = live;
            stage.scene.live->casts_shadows = levels[i].columns > 0;
            // Another frame each time, as a sensor's are.
            stage.scene.live->surface = std::make_shared<DepthSurface>(*live.surface);
            const SceneBvhOptions tree{.place = levels[i].place,
                                       .live_columns = std::max(levels[i].columns, 2)};
            const auto begun = std::chrono::steady_clock::now();
            if (auto made = trees[i]->upload(stage.scene, tree); !made) {
                return context.fail(made.error());
            }
            const std::chrono::duration<double, std::milli> host =
                std::chrono::steady_clock::now() - begun;
            casts[i] = test::cast_shadows(device, executor, stage, *trees[i], options);
            triangles[i] = trees[i]->live_soup().triangles.size();
            if (round < 0) continue;
            upload[i].ms.push_back(host.count() + casts[i].build_ms);
            trace[i].ms.push_back(casts[i].shadow_ms);
        }
    }
    const Comparison comparison(trace);
    std::string table;
    for (std::size_t i = 0; i < levels.size(); ++i) {
        const double off = double(bits_of(difference(casts[i].masks, casts[1].masks))) /
                           double(casts[1].counters.jobs);
        context.add({.case_name = what,
                     .knob = "live frame as occluder",
                     .level = levels[i].name,
                     .ms_median = trace[i].median_ms(),
                     .ms_p95 = trace[i].p95_ms(),
                     .error = off,
                     .metric = "share of bits off every pixel",
                     .baseline = "none",
                     .speedup = comparison.speedup(levels[i].name, "none")});
        table += fmt::format("| {} | {} | {:.2f} | {:.2f} | {:.5f} |\n", levels[i].name,
                             triangles[i], upload[i].median_ms(), trace[i].median_ms(), off);
    }
    context.claim("ray-cast shadows: the live frame's tree is the same by host and device",
                  casts[3].masks == casts[5].masks);
    context.section(
        "## The live frame as an occluder\n\nA shell of depth pixels in the middle of a room. Its "
        "triangles are gathered and built into a tree of their own each frame.\n\n"
        "| vertices | triangles | gather and build, ms | rays, ms | bits off |\n"
        "|---|---:|---:|---:|---:|\n" +
        table);
}

}  // namespace

void bench_ray_shadows(BenchContext& context, gpu::Device& device, graph::Executor& executor) {
    const bool quick = context.quick();
    // About as many rays a pixel as the source has (7.6), and triangles.
    const ShadowStage stage({.width = quick ? 320 : 1280,
                             .height = quick ? 180 : 720,
                             .balls = quick ? 20 : 60,
                             .rings = quick ? 16 : 34,
                             .lights = 512,
                             .smallest_radius = 0.8,
                             .largest_radius = 1.0,
                             .spots = false,
                             .unshadowed = false,
                             .hole = false});
    SceneBvh bvh(device);
    if (auto made = bvh.upload(stage.scene); !made) return context.fail(made.error());
    const std::string what = fmt::format("512 lights, {}x{}, {} triangles", stage.view.width,
                                         stage.view.height, bvh.soup().triangles.size());
    const RayShadowOptions full{.half_resolution = false, .rays_per_pixel = 128};
    std::vector<ShadowLevel> levels = {{"mask", "full", full}};
    const auto add = [&](std::string knob, std::string name, auto change) {
        ShadowLevel level{std::move(knob), std::move(name), full};
        change(level.options);
        levels.push_back(std::move(level));
    };
    add("mask", "full, jobs", [](RayShadowOptions& o) { o.dispatch = ShadowDispatch::jobs; });
    add("mask", "half", [](RayShadowOptions& o) { o.half_resolution = true; });
    add("mask", "half, jobs", [](RayShadowOptions& o) {
        o.half_resolution = true;
        o.dispatch = ShadowDispatch::jobs;
    });
    for (const std::uint32_t rays : {2u, 4u, 8u, 16u, 32u}) {
        add("rays a pixel, half mask", fmt::format("{}", rays), [&](RayShadowOptions& o) {
            o.half_resolution = true;
            o.rays_per_pixel = rays;
        });
    }
    std::vector<Timing> timings;
    std::vector<ShadowCast> casts(levels.size());
    for (const ShadowLevel& level : levels) timings.push_back({level.knob + level.name, {}});
    for (int round = -1; round < 3; ++round) {
        context.progress(fmt::format("shadows: round {}", round));
        for (std::size_t i = 0; i < levels.size(); ++i) {
            casts[i] = test::cast_shadows(device, executor, stage, bvh, levels[i].options);
            if (round >= 0) timings[i].ms.push_back(casts[i].shadow_ms);
        }
    }
    const double pixels = double(stage.view.width) * stage.view.height;
    std::string table;
    const Comparison comparison(timings);
    for (std::size_t i = 0; i < levels.size(); ++i) {
        const double ms = timings[i].median_ms();
        // Of all rays that the full mask asks for, those whose answer is another one.
        const double off = double(bits_of(difference(casts[i].masks, casts[0].masks))) /
                           double(casts[0].counters.jobs);
        context.add({.case_name = what,
                     .knob = levels[i].knob,
                     .level = levels[i].name,
                     .ms_median = ms,
                     .ms_p95 = timings[i].p95_ms(),
                     .error = off,
                     .metric = "share of bits off the full mask",
                     .baseline = "full",
                     .speedup = comparison.speedup(timings[i].name, timings[0].name)});
        table += fmt::format("| {}: {} | {} | {} | {:.2f} |\n", levels[i].knob, levels[i].name,
                             casts[i].counters.jobs, casts[i].counters.capped,
                             mrays_per_s(casts[i].counters.jobs, ms));
    }
    context.note(fmt::format("{}: {:.1f} rays a pixel in the full mask.", what,
                             double(casts[0].counters.jobs) / pixels));
    context.claim("ray-cast shadows: jobs and lanes a pixel make the same masks",
                  casts[0].masks == casts[1].masks && casts[2].masks == casts[3].masks);

    // The same rays by the processor, and whether the masks are Embree's.
    const test::EmbreePeer embree(bvh.soup().triangles, int(kRayThreads));
    std::vector<Ray> rays;
    std::vector<std::uint8_t> ours;
    std::uint64_t jobs = 0;
    const int step = quick ? 1 : 3;
    for (int y = 0; y < stage.view.height; y += step) {
        for (int x = 0; x < stage.view.width; x += step) {
            const glm::uvec4& mask = casts[0].masks[stage.at(x, y)];
            for (const auto& [slot, ray] :
                 test::shadow_rays(stage, casts[0], bvh.soup().center, full.offset, x, y)) {
                rays.push_back(ray);
                ours.push_back(test::shadow_bit(mask, slot));
                ++jobs;
            }
        }
    }
    if (step == 1) {
        context.claim(fmt::format("ray-cast shadows: {} jobs, as the processor counts them", jobs),
                      jobs == casts[0].counters.jobs);
    }
    const auto wide = test::in_double(bvh.soup().triangles);
    std::uint64_t differing = 0;
    std::uint64_t off_edges = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        if (embree.any_hit(rays[i]) == (ours[i] != 0)) continue;
        ++differing;
        if (differing > 500) continue;  // each takes a loop over all triangles
        off_edges += reference::closest_edge(wide, rays[i].origin, rays[i].direction) > 1e-3;
    }
    context.claim(
        fmt::format(
            "ray-cast shadows: {} of {} bits ({:.4f} %) differ from Embree's any-hit, {} of "
            "them farther than 1e-3 from an edge",
            differing, rays.size(), 100.0 * double(differing) / double(rays.size()), off_edges),
        double(differing) <= 1e-3 * double(rays.size()) && off_edges == 0);

    std::vector<std::uint8_t> found(rays.size());
    const auto by = [&](auto hit) {
        return [&, hit] {
            for_each_ray(rays.size(), [&](std::size_t i) { found[i] = hit(rays[i]); });
        };
    };
    const Bvh& tree = bvh.host_tree();
    const std::vector<Candidate> candidates = {
        {"bit trail", by([&](const Ray& r) { return any_hit(tree, r); })},
        {"stack", by([&](const Ray& r) { return any_hit_by_stack(tree, r); })},
        {"Embree", by([&](const Ray& r) { return embree.any_hit(r); })}};
    const Comparison peers = context.compare("shadow rays", candidates, {.repeats = 7});
    for (const Candidate& candidate : candidates) {
        const double speed = mrays_per_s(rays.size(), peers[candidate.name].median_ms());
        table += fmt::format("| the processor: {} | {} | 0 | {:.2f} |\n", candidate.name,
                             rays.size(), speed);
        context.add({.case_name = fmt::format("512 lights, {} of the rays", rays.size()),
                     .knob = "traversal",
                     .level = candidate.name,
                     .error = speed,
                     .metric = "Mray/s",
                     .baseline = "Embree"},
                    peers);
    }
    bench_live_shadows(context, device, executor);
    context.section(
        "## Shadows of 512 lights\n\nJob creation and all passes included on the device.\n\n"
        "| | rays | lights without a ray | Mray/s |\n|---|---:|---:|---:|\n" +
        table);
}

}  // namespace kino
