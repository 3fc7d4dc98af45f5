#pragma once

#include <string>
#include <vector>

#include "base/error.h"
#include "calibration/solve/bundle.h"

namespace kino {

/// What the views of a pair of cameras say about each other.
struct PairFindings {
    std::vector<bool> keep;          ///< views that one rigid pair explains
    std::vector<std::string> notes;  ///< why the others were left out, one sentence each
};

/// Looks for views that no rigid pair of cameras with one board explains: the board moved between
/// the two pictures, or boards of different size were mixed (each such view is named), or one
/// camera's pictures are mirrored (an error). `alone`: each camera's own solution of the views that
/// it saw, as only_camera() gives them. Fails also where fewer than half of the views agree.
[[nodiscard]] Result<PairFindings> check_pair(const Shots& shots,
                                              const std::vector<BundleResult>& alone);

/// One camera's pictures mirrored left to right, the corner ids too, so that a chessboard becomes
/// one again.
[[nodiscard]] CameraShots mirrored(const Shots& shots, std::size_t camera);

}  // namespace kino
