#pragma once

#include <string>

#include "skeleton/motion/skeletal_motion.h"

namespace kino::motion_export {

/// Binary glTF 2.0: the nodes at rest, a skinned mesh with one solid a bone so that every viewer
/// shows the skeleton, and one animation with LINEAR samplers. Metres, y up, the person at rest
/// looks along +z.
[[nodiscard]] std::string glb_bytes(const SkeletalMotion& motion);

}  // namespace kino::motion_export
