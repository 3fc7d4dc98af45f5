#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "base/frame.h"
#include "calibration/boards/board.h"
#include "calibration/solve/shots.h"

namespace kino {

/// The depth that came with a view, and the colour beside it (null where none is near in time).
struct ViewDepth {
    std::string view;
    std::shared_ptr<const DepthFrame> frame;
    std::shared_ptr<const ColorFrame> color;
};

struct SessionShotsOptions {
    int views = 30;                 ///< enough
    double still_px = 1.5;          ///< the board's corners moved no more since the last frame set
    double different_share = 0.06;  ///< of the width that corners moved since every view taken
};

/// Plays a session or device and takes a view whenever the board holds still and stands otherwise
/// than in all views so far. Cameras: infrared and colour where the source has both, else the one
/// it has. Ends with the source, with Ctrl-C, or with enough views.
[[nodiscard]] Result<Shots> shots_of_session(const std::string& uri, const Board& board,
                                             const SessionShotsOptions& options,
                                             std::vector<ViewDepth>& depth,
                                             std::vector<std::string>& notes,
                                             const std::function<void(std::string_view)>& progress);

}  // namespace kino
