#pragma once

#include <optional>
#include <vector>

#include "base/error.h"
#include "base/pose.h"
#include "calibration/solve/lens_model.h"
#include "calibration/solve/shots.h"
#include "calibration/solve/turned_pose.h"

namespace kino {

/// A camera from the board's homographies (OpenCV's initCameraMatrix2D); where that gives nothing
/// usable, one with 60 degrees across and the centre in the middle. No distortion.
[[nodiscard]] Lens initial_lens(const Shots& shots, std::size_t camera);

/// camera_from_board of one view (OpenCV's solvePnP). None where the view has fewer than four
/// corners or they do not fix a pose.
[[nodiscard]] std::optional<Pose> initial_pose(const Shots& shots, std::size_t camera,
                                               std::size_t view, const Lens& lens);

/// The one of these poses that is nearest to all others: metres and radians count alike.
[[nodiscard]] Pose middle_pose(const std::vector<Pose>& poses);
[[nodiscard]] double rotation_angle_rad(const Pose& pose);

}  // namespace kino
