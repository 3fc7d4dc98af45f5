#include "apps/bench/governor_steps.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <vector>

#include "apps/bench/timing.h"
#include "apps/viewer/frame_budget.h"
#include "tests/support/random.h"
#include "viz/quality/governor/resize_controller.h"

namespace kino::bench {
namespace {

constexpr glm::ivec2 kSize{1280, 720};
constexpr double kTargetMs = 50;
constexpr double kLateBeyond = 1.1;
constexpr double kNoise = 0.03;
constexpr int kFramesAStep = 120;

struct SimulatedLoad {
    double light_ms = 30, resize_ms = 6, pixels_ms = 8, still_ms = 4;

    static SimulatedLoad random(test::Random& random) {
        // All of them can be held with light at r = 8.
        return {.light_ms = random.real(15, 250),
                .resize_ms = random.real(3, 10),
                .pixels_ms = random.real(4, 12),
                .still_ms = random.real(2, 8)};
    }
};

FrameResult simulate(const SimulatedLoad& load, const FrameOptions& options, bool groups,
                     test::Random& random) {
    PictureLevel level{.zoom = options.zoom.z};
    double resize_ms = 0;
    if (options.lod) {
        level.lod = options.lod->r;
        level.reconstruction = options.lod->reconstruction;
        resize_ms =
            level.reconstruction == Reconstruction::bilinear ? load.resize_ms / 3 : load.resize_ms;
    }
    const PictureShare share = share_of(level, kSize);
    FrameResult result;
    const auto add = [&](const char* group, double ms) {
        ms *= 1 + random.real(-kNoise, kNoise);
        const bool told = options.timing == graph::Timing::every_group;
        if (groups) result.report.groups.push_back({group, told ? ms : -1});
        result.ms += ms;
    };
    add("raster", load.pixels_ms * share.drawn);
    add("meshes", load.still_ms);
    if (options.lod) add("lod", 0.3 * resize_ms * share.drawn);
    add("light", load.light_ms * share.shaded);
    if (options.lod) add("lod", 0.7 * resize_ms * share.drawn);
    return result;
}

struct Answer {
    double ms = 0, error = 0;
};

/// `frame`: draws one under a load, as the controller wants it.
StepResponse answer_steps(std::string controller, int steps,
                          const std::function<Answer(const SimulatedLoad&)>& frame) {
    test::Random random(31);
    StepResponse response{.controller = std::move(controller), .steps = steps};
    std::vector<double> settled;
    double error = 0;
    for (int step = 0; step < steps; ++step) {
        const SimulatedLoad load = SimulatedLoad::random(random);
        int on_time = 0, late = 0;
        std::optional<int> settled_at;
        for (int i = 0; i < kFramesAStep; ++i) {
            const Answer answer = frame(load);
            const bool is_late = answer.ms > kLateBeyond * kTargetMs;
            on_time = is_late ? 0 : on_time + 1;
            late = is_late ? late + 1 : 0;
            response.worst_late_run = std::max<double>(response.worst_late_run, late);
            constexpr int kInARow = 5;
            if (!settled_at && on_time == kInARow) settled_at = i + 1 - kInARow;
            error += answer.error;
        }
        settled.push_back(settled_at.value_or(kFramesAStep));
        response.settled_share += settled.back() <= kSettleWithin ? 1.0 / steps : 0;
    }
    response.median_frames = quantile(settled, 0.5);
    response.mean_error = error / steps / kFramesAStep;
    return response;
}

}  // namespace

StepResponse answer_steps_by_budget(bool groups, int steps) {
    FrameBudget budget({.mode = GovernorMode::automatic, .target_ms = kTargetMs, .most_zoom = 2});
    test::Random random(32);
    Scene scene;
    scene.meshes.emplace_back();
    const View view{.width = kSize.x, .height = kSize.y};
    auto response = answer_steps(
        groups ? "frame budget, groups measured" : "frame budget, whole frames", steps,
        [&](const SimulatedLoad& load) {
            FrameOptions options;
            const double error = budget.begin_frame(scene, view, options).estimated_error;
            const FrameResult result = simulate(load, options, groups, random);
            budget.frame_took(result, result.ms);
            return Answer{result.ms, error};
        });
    response.changes_a_step = static_cast<double>(budget.log().size() - 1) / steps;
    return response;
}

StepResponse answer_steps_by_resizing(int steps) {
    ResizeController controller({.target_ms = kTargetMs});
    test::Random random(32);
    double before = 1;
    int changes = 0;
    auto response = answer_steps("integral controller of r", steps, [&](const SimulatedLoad& load) {
        const double r = controller.begin_frame();
        changes += r != before ? 1 : 0;
        before = r;
        FrameOptions options;
        if (r > 1) options.lod = FramebufferLodOptions{.r = r};
        const FrameResult result = simulate(load, options, false, random);
        controller.frame_took(result.ms);
        return Answer{result.ms, lod_error(r, Reconstruction::geometry_aware)};
    });
    response.changes_a_step = static_cast<double>(changes) / steps;
    return response;
}

}  // namespace kino::bench
