#pragma once

#include "skeleton/actors/actor_pose.h"
#include "skeleton/actors/actor_random.h"

namespace kino {

struct DrawnPose {
    ActorPose pose;  ///< at the world's origin, facing about +z
    bool seated = false;
};

/// One pose of the training distribution: procedural, from the synthetic motions or from
/// recordings.
[[nodiscard]] DrawnPose draw_pose(ActorRandom& random);

}  // namespace kino
