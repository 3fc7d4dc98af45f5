#include <fmt/format.h>

#include <limits>
#include <string>
#include <vector>

#include "apps/bench/lod_stage.h"
#include "apps/bench/registry.h"
#include "viz/quality/edge_band.h"
#include "viz/quality/flip.h"
#include "viz/quality/image_metrics.h"

namespace kino {
namespace {

using bench::LodKind;
using bench::LodPlayer;
using bench::LodStage;

struct KnobLevel {
    std::string knob, level;
    FramebufferLodOptions options;
};

constexpr float kInfinite = std::numeric_limits<float>::infinity();

/// Each knob turned alone, the others as they are if nobody turns them. Without the fine albedo:
/// that would hide most of what guides do.
std::vector<KnobLevel> lod_levels() {
    const FramebufferLodOptions plain{.r = 3, .fine_grained = false};
    std::vector<KnobLevel> levels;
    const auto add = [&](const char* knob, std::string level, auto turn) {
        levels.push_back({knob, std::move(level), plain});
        turn(levels.back().options);
    };
    const auto number = [](float value) {
        return value == kInfinite ? std::string("infinite") : fmt::format("{:g}", value);
    };
    for (const auto& [name, metric] : {std::pair{"depth", RangeMetric::depth},
                                       std::pair{"logarithm of depth", RangeMetric::log_depth},
                                       std::pair{"plane", RangeMetric::plane}}) {
        add("range metric", name, [m = metric](auto& options) { options.metric = m; });
    }
    for (const float sigma : {0.002f, 0.005f, 0.01f, 0.02f, 0.05f, 0.2f, kInfinite}) {
        add("sigma of depth", number(sigma), [&](auto& options) { options.sigma_z = sigma; });
    }
    for (const float sigma : {0.03f, 0.06f, 0.12f, 0.25f, 0.5f, 1.0f, kInfinite}) {
        add("sigma of normals", number(sigma), [&](auto& options) { options.sigma_n = sigma; });
    }
    for (const auto& [name, kernel] :
         {std::pair{"tent", LodKernel::tent}, std::pair{"gauss", LodKernel::gauss}}) {
        add("kernel", name, [k = kernel](auto& options) { options.kernel = k; });
    }
    for (const auto& [name, format] :
         {std::pair{"packed", LodFormat::packed}, std::pair{"wide", LodFormat::wide}}) {
        add("guides", name, [f = format](auto& options) { options.format = f; });
    }
    for (const float tolerance : {0.0f, 0.1f, 0.25f, 0.5f, 1.0f, 2.0f, 4.0f}) {
        add("flat tiles, sigmas", number(tolerance),
            [&](auto& options) { options.flat_tolerance = tolerance; });
    }
    return levels;
}

void turn_knobs(BenchContext& context, gpu::Device& device, const LodStage& stage) {
    const auto player = LodPlayer::create(device, stage);
    if (!player) return context.fail(player.error());
    const auto truth = (*player)->picture();
    if (!truth) return context.fail(truth.error());
    const Image<std::uint8_t> band = depth_edge_band(stage.z);
    const std::vector<KnobLevel> levels = lod_levels();
    std::vector<bench::Candidate> candidates;
    // Shading is the same for all, so reconstruction alone is timed, on the coarse picture of the
    // last resized().
    if (const auto drawn = (*player)->resized(levels.front().options); !drawn) {
        return context.fail(drawn.error());
    }
    const auto draw = [&](const FramebufferLodOptions& options) {
        const auto drawn = (*player)->reconstruction(options);
        if (!drawn) context.fail(drawn.error());
    };
    for (const KnobLevel& level : levels) {
        candidates.push_back({level.knob + " " + level.level, [&] { draw(level.options); }});
    }
    const bench::Comparison times =
        context.compare(stage.name, candidates, {.repeats = 15, .max_seconds = 20});
    for (const KnobLevel& level : levels) {
        const auto picture = (*player)->picture(&level.options);
        if (!picture) return context.fail(picture.error());
        const auto difference = compare_images(*picture, *truth);
        const auto flip = flip_error(*picture, *truth);
        const auto near_edges = band_error(*picture, *truth, band);
        if (!difference || !flip || !near_edges)
            return context.fail({"not compared", level.knob, {}});
        const bench::Timing& time = times[level.knob + " " + level.level];
        const auto row = [&](double error, const char* metric) {
            context.add({.case_name = stage.name,
                         .knob = level.knob,
                         .level = level.level,
                         .ms_median = time.median_ms(),
                         .ms_p95 = time.p95_ms(),
                         .error = error,
                         .metric = fmt::format("{}: {}", stage.name, metric)});
        };
        row(difference->psnr_db, "dB PSNR");
        row(flip->mean, "mean FLIP");
        row(near_edges->mse, "MSE near edges");
    }
}

}  // namespace

void bench_lod_knobs(BenchContext& context) {
    auto device = gpu::Device::create({});
    if (!device) return context.fail(device.error());
    context.set_device(fmt::format("{}, {}", (*device)->info().name, (*device)->info().driver));
    const int width = context.quick() ? 480 : 1280;
    const int height = context.quick() ? 270 : 720;
    turn_knobs(context, **device, bench::made_stage(LodKind::dragon, width, height));
    auto room = bench::room_stage(**device, width, height);
    if (!room) return context.fail(room.error());
    turn_knobs(context, **device, *room);
    context.note(fmt::format(
        "{}x{}, r = 3, geometry-aware without fine grain; each knob is turned alone. Times are of "
        "picking and reconstruction, errors against the same shading at every pixel. Scenes as in "
        "[framebuffer-lod](framebuffer-lod.md).",
        width, height));
}

}  // namespace kino
