#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "skeleton/synthetic/body_model.h"

namespace kino {

enum class Motion : std::uint8_t {
    dance,
    wave,
    swipe,
    raise,
    push,
    walk,
    turn,
    tpose,
    squat,
    idle,
};

/// Every motion is a loop of this length whose end is its beginning.
constexpr double kMotionPeriodS = 10.0;

[[nodiscard]] std::string_view motion_name(Motion motion);
[[nodiscard]] const std::vector<Motion>& all_motions();
[[nodiscard]] std::optional<Motion> motion_from_name(std::string_view name);

/// The person's pose at time t (any finite value; period kMotionPeriodS), world space: the world's
/// origin is on the floor below the camera, the person stands about 2.75 m before it.
[[nodiscard]] BodyPose pose_at(Motion motion, double t_s);

}  // namespace kino
