#pragma once

#include <glm/vec3.hpp>

#include "skeleton/tracking/jointed_model.h"
#include "skeleton/tracking/part_modes.h"

namespace kino {

/// A pose from nothing but where parts gather.
struct PoseGuess {
    bool usable = false;  ///< false: too little of a trunk is seen
    JointedPose pose;
};

/// `up`: against gravity, depth-camera space. `turn_rad`: the trunk turned about its own axis
/// against what the parts say, the limbs staying where they are seen.
[[nodiscard]] PoseGuess guess_pose(const PartModes& modes, const BodyShape& shape,
                                   const glm::vec3& up, float turn_rad);

/// The directions of one limb (0, 1: arms; 2, 3: legs) as the parts say, the rest as in `pose`.
/// False where they say nothing.
[[nodiscard]] bool guess_limb(const PartModes& modes, int limb, JointedPose& pose);

/// The same pose, left taken for right.
[[nodiscard]] JointedPose mirrored(const JointedPose& pose);

}  // namespace kino
