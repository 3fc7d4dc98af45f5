#pragma once

#include <cstdint>

#include "base/error.h"
#include "base/frame.h"
#include "sensor/convert/frame_sink.h"
#include "sensor/convert/losses.h"

namespace kino {

/// The frame's depth in whole counts of `metres_per_unit`, 0 = no reading. Linear depth of the same
/// unit is copied bit by bit; what else is done is added to `losses`: values that had to be
/// rounded, were too far for 16 bits, or are no longer disparity.
[[nodiscard]] Result<Image<std::uint16_t>> depth_in_units(const DepthFrame& frame,
                                                          double metres_per_unit,
                                                          ConvertGeometry& geometry,
                                                          Losses& losses);

/// The number whose inverse, as readers compute it, is exactly `metres_per_unit` (if there is one).
[[nodiscard]] double counts_per_metre(double metres_per_unit);

}  // namespace kino
