#pragma once

#include <functional>
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

/// Where somebody who walks is.
struct Placement {
    glm::dvec3 place_m{0};  ///< world, on the floor
    double yaw_rad = 0;     ///< about y; 0 faces world +z
};

/// Somebody who follows `path` (of t in s; it may wind): feet stay where they were put down while
/// the body moves over them. `strides`: double steps in kMotionPeriodS. Where the path rests, it is
/// a step on the spot.
[[nodiscard]] BodyPose stepping_pose(double t_s, int strides, double lift_m,
                                     const std::function<Placement(double)>& path);

}  // namespace kino
