#pragma once

#include "base/frame.h"
#include "base/image.h"

namespace kino {

/// Unit of linear_depth(), m: reaches 13.1 m, and its rounding (0.058 mm RMS) is far below any
/// sensor's noise.
constexpr double kLinearDepthUnitM = 0.0002;

/// Filtered metres as a frame again, so that everything that takes a DepthFrame (the Rig above all)
/// takes filtered depth: raw counts of kLinearDepthUnitM, 0 where there is no reading or it does
/// not fit. Header and damaged rows are left to the caller. Reuses out's memory.
void linear_depth(const Image<float>& depth_m, DepthFrame& out);

}  // namespace kino
