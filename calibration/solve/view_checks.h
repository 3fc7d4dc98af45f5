#pragma once

#include "base/error.h"
#include "calibration/solve/shots.h"

namespace kino {

/// Share of a grid of 8 x 6 fields of the picture that hold a corner in some view.
[[nodiscard]] double coverage(const CameraShots& camera);

/// The largest angle between two of the boards as this camera sees them, degrees. Holds without
/// knowing the lens: parallel planes have one vanishing line.
[[nodiscard]] double largest_tilt_deg(const Shots& shots, std::size_t camera);

/// Refuses what cannot lead to a calibration of this camera, and says why and what to do: fewer
/// than three views, boards all parallel, boards in one part of the picture only.
[[nodiscard]] Result<void> check_views(const Shots& shots, std::size_t camera);

}  // namespace kino
