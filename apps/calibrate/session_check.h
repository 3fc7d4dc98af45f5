#pragma once

#include <string>
#include <vector>

#include "base/error.h"
#include "calibration/solve/plane_check.h"

namespace kino {

/// What a recording says about the calibration that comes with it, without any board.
struct SessionCheck {
    std::vector<PlaneBand> planes;  ///< empty where nothing is flat
    /// Median place of the colour contours relative to where the calibration puts the depth
    /// contours, colour px, over the frames whose best place stands out.
    double dx_px = 0, dy_px = 0;
    double spread_px = 0;  ///< median distance of the frames' places from that
    /// The same by mutual information, and how many bits depth and colour share where the
    /// calibration puts the depth, and at the best place.
    double mutual_dx_px = 0, mutual_dy_px = 0;
    double bits = 0, best_bits = 0;
    int mutual_frames = 0;
    int frames = 0;  ///< depth frames seen
    int aligned_frames = 0;
    bool has_color = false;
};

/// Plays up to `frames` depth frames of a session or device.
[[nodiscard]] Result<SessionCheck> check_session(const std::string& uri, int frames);

/// For a person: a line a band, and whether the calibration still holds (contours within 3 px of
/// each other, in three frames at least).
[[nodiscard]] std::string check_text(const SessionCheck& check);

}  // namespace kino
