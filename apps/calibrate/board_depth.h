#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/calibrate/session_shots.h"
#include "base/camera_model.h"
#include "calibration/boards/board.h"
#include "calibration/solve/calibrate.h"
#include "calibration/solve/depth_fit.h"

namespace kino {

/// Looks at the depth of the boards in the views that were used. Says in `notes` if the stated
/// square size disagrees with it; raw disparity gives `rig` its disparity parameters; what is left
/// over gives the bias of each part of the picture. None where boards were in too small a part of
/// it, or where a bias takes away less than a tenth of the error. Nothing is said where no depth
/// lies on boards.
[[nodiscard]] std::optional<BiasFit> use_board_depth(const Calibration& calibration,
                                                     const Board& board,
                                                     const std::vector<ViewDepth>& depth,
                                                     RigParameters& rig,
                                                     std::vector<std::string>& notes);

/// For a person.
[[nodiscard]] std::string bias_text(const BiasFit& fit);

}  // namespace kino
