#pragma once

#include <span>
#include <string_view>

#include "skeleton/synthetic/scene.h"

namespace kino {

constexpr std::string_view kPerformanceName = "performance";

/// A gesture of the performance, by the names of skeleton/gestures.
struct Cue {
    double time_s = 0;  ///< when somebody who watches would say that it was done
    std::string_view gesture, phase, hand;
};

/// Somebody comes into a dark hall, waves, paints with either hand, swipes, pushes, turns and zooms
/// with both hands, raises one hand and both, makes a T, waves and goes: everything that the demo
/// knows, once. Only the person and the floor near them give readings, and there is neither
/// colour nor joints, so it is small when it is recorded. Sizes as make_scene().
[[nodiscard]] SyntheticScene make_performance(int width, int height);

/// What it shows, in order of time: the written script, not what some recogniser made of it.
[[nodiscard]] std::span<const Cue> performance_script();

constexpr double kPerformanceSeconds = 48;

}  // namespace kino
