#pragma once

#include <string>
#include <vector>

#include "apps/calibrate/session_shots.h"
#include "base/camera_model.h"
#include "calibration/boards/board.h"
#include "calibration/solve/calibrate.h"

namespace kino {

/// Looks at the depth of the boards in the views that were used. Says in `notes` if the stated
/// square size disagrees with it; raw disparity gives `rig` its disparity parameters. Nothing is
/// said where no depth lies on boards.
void use_board_depth(const Calibration& calibration, const Board& board,
                     const std::vector<ViewDepth>& depth, RigParameters& rig,
                     std::vector<std::string>& notes);

}  // namespace kino
