#pragma once

#include <memory>

#include "skeleton/actors/actor_motion.h"
#include "skeleton/actors/joint_recording.h"

namespace kino {

/// Bone directions of a recording, resampled to 30 poses a second and eased over five of them,
/// about the origin and facing +z at first; long ways are shortened to 1.4 m. With `airborne` the
/// body leaves the floor where the recorded feet do.
[[nodiscard]] std::shared_ptr<const ActorMotion> recorded_motion(const JointRecording& recording,
                                                                 bool airborne);

/// The recordings within the program, which training may use.
struct BuiltInRecording {
    const char* name;
    bool airborne;
};
[[nodiscard]] const std::vector<BuiltInRecording>& built_in_recordings();
/// Null for other names. Parsed at the first call.
[[nodiscard]] std::shared_ptr<const ActorMotion> built_in_motion(const std::string& name);

}  // namespace kino
