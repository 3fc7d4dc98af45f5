#pragma once

#include "base/error.h"
#include "calibration/solve/bundle.h"

namespace kino {

/// Initial values of everything by OpenCV: lenses without distortion, board poses, and the pose
/// between two cameras that most views agree with. Every view must have a board that one camera
/// sees; with two cameras one view at least must be seen by both. Errors name view or camera.
[[nodiscard]] Result<BundleState> start_state(const Shots& shots);

/// The lens at the given one, the boards' poses anew: for views that the lens was not made from.
[[nodiscard]] Result<BundleState> start_state(const Shots& shots, const std::vector<Lens>& lenses);

/// One camera alone from nothing: start, distortion of the lowest order, then all of the model's.
[[nodiscard]] Result<BundleResult> solve_camera(const Shots& one_camera, LensModel model,
                                                const BundleOptions& options = {});

}  // namespace kino
