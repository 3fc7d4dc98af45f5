#pragma once

#include <string>

namespace kino::bench {

/// How a controller answers random steps of the load on a simulated renderer.
struct StepResponse {
    std::string controller;
    int steps = 0;
    double settled_share = 0;   ///< of the steps: within `within` frames
    double median_frames = 0;   ///< until five frames in a row are on time
    double worst_late_run = 0;  ///< longest run of late frames
    double mean_error = 0;      ///< estimated FLIP over all frames
    double changes_a_step = 0;
};
constexpr int kSettleWithin = 15;

/// FrameBudget, with groups of passes measured or whole frames alone.
[[nodiscard]] StepResponse answer_steps_by_budget(bool groups, int steps);
/// ResizeController, which knows light alone.
[[nodiscard]] StepResponse answer_steps_by_resizing(int steps);

}  // namespace kino::bench
