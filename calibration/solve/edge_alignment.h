#pragma once

#include <cstdint>
#include <optional>

#include "base/image.h"
#include "calibration/rig.h"

namespace kino {

/// How well depth and colour contours lie on each other, without any board.
struct EdgeAlignment {
    double dx_px = 0, dy_px = 0;  ///< where the colour contours lie from where the calibration puts
                                  ///< the depth contours, colour pixels
    /// How much the best place stands out: (best - mean) / deviation of the scores of all places.
    double sharpness = 0;
    int contour_points = 0;
};

/// Depth contours are pixels in front of a jump of more than 5 % or four quantisation steps. Their
/// places in the colour picture, moved by every whole number of pixels up to `reach` either way,
/// are scored by the mean colour gradient there (clipped, so that single strong edges do not rule);
/// the best place is refined by a parabola. None with fewer than 200 contour points. `grey`: the
/// colour picture; `uv` and `depth_m` of the depth image, computed without an occlusion test.
[[nodiscard]] std::optional<EdgeAlignment> edge_alignment(const Image<float>& depth_m,
                                                          const Image<ColorUv>& uv,
                                                          const Image<std::uint8_t>& grey,
                                                          int reach = 12);

}  // namespace kino
