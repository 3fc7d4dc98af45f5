#pragma once

#include <string>

#include "skeleton/motion/joint_track.h"

namespace kino::motion_export {

constexpr std::size_t kC3dMostFrames = 65'535;  ///< the header counts them in 16 bits

/// The 20 joints as points, millimetres, floats in the PC's byte order; what was not seen has
/// residual -1.
[[nodiscard]] std::string c3d_bytes(const JointTrack& track, double rate_hz);

}  // namespace kino::motion_export
