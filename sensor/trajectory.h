#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "base/pose.h"
#include "base/time.h"

namespace kino {

/// Camera poses over time.
struct Trajectory {
    std::vector<TimeNs> times;  ///< strictly rising
    std::vector<Pose> poses;    ///< world_from_camera, our world: y up

    /// Interpolated; none outside the samples or in a gap longer than `max_gap`.
    [[nodiscard]] std::optional<Pose> at(TimeNs time, TimeNs max_gap = kNsPerSecond / 2) const;
};

struct ParsedTrajectory {
    Trajectory trajectory;
    std::size_t skipped = 0;  ///< lines that said nothing usable
};

/// Lines "time tx ty tz qx qy qz qw" of the TUM RGB-D benchmark, # starts a comment. There the
/// world has z up and the camera has optical axes (x right, y down, z forward); the result is
/// turned by -90 degrees about x, (x, y, z) -> (x, z, -y), so that y is up. Lines with missing or
/// non-finite numbers, a quaternion more than 1 % from unit length, or a time that does not rise
/// are skipped and counted.
[[nodiscard]] ParsedTrajectory parse_tum_trajectory(std::string_view text);

}  // namespace kino
