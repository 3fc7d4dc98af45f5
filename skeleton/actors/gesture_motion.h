#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "skeleton/actors/actor_motion.h"
#include "skeleton/synthetic/body_model.h"

namespace kino {

/// Any motion of the posed 1.75 m person as an actor's, e.g. of a test's script; `pose_at` takes
/// seconds, world space, the person about the origin facing +z.
[[nodiscard]] std::shared_ptr<const ActorMotion> posed_motion(
    std::function<BodyPose(double t_s)> pose_at, double seconds, const ActorProps& props = {});

/// Ten seconds each: "gesture-swipe-left", -right, -up, -down, -push (right hand, thrice),
/// -zoom, -rotate (both hands, out and back, twice), -dwell, -raise (right hand, twice).
[[nodiscard]] const std::vector<std::string>& gesture_motions();
/// Null for other names.
[[nodiscard]] std::shared_ptr<const ActorMotion> gesture_motion(const std::string& name);

}  // namespace kino
