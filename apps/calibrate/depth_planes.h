#pragma once

#include <string>
#include <vector>

#include "base/error.h"
#include "calibration/solve/plane_check.h"

namespace kino {

/// Plays up to `frames` depth frames of a session or device and measures its flat parts with the
/// calibration that comes with it.
[[nodiscard]] Result<std::vector<PlaneBand>> depth_planes(const std::string& uri, int frames);

}  // namespace kino
