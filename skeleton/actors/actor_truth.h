#pragma once

#include "base/body.h"
#include "skeleton/actors/actor_canvas.h"
#include "skeleton/actors/actor_pose.h"

namespace kino {

/// True joints in view space. Tracked: the picture (before noise) shows flesh of the joint's own
/// bones in front of it; inferred: something else is in front, or it lies outside the picture.
[[nodiscard]] Body actor_truth(const PosedBones& bones, const Pose& view_from_world, int actor,
                               const Image<float>& z_m, const Image<std::int32_t>& id,
                               const CameraModel& camera);

}  // namespace kino
