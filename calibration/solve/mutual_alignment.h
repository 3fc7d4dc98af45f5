#pragma once

#include <cstdint>
#include <optional>

#include "base/image.h"
#include "calibration/rig.h"

namespace kino {

/// How well depth and colour agree, without any board and without contours: things at different
/// depths mostly differ in brightness, too, and best so where the two pictures lie on each other.
struct MutualAlignment {
    double dx_px = 0, dy_px = 0;  ///< as EdgeAlignment's
    double bits = 0;              ///< mutual information where the calibration puts the depth
    double best_bits = 0;         ///< at (dx, dy)
    double sharpness = 0;         ///< as EdgeAlignment's
    int points = 0;
};

/// Mutual information of 1/z and the grey level (16 classes each, equally frequent, from a joint
/// histogram; Viola & Wells 1997) with the depth's places in the colour picture moved by every
/// whole number of pixels up to `reach` either way; the best place refined by a parabola. None with
/// fewer than 2000 depth pixels in the picture, or where all depth or all grey is of one class.
/// `grey`, `uv` and `depth_m` as for edge_alignment(). At most 20000 pixels, evenly spread, count.
[[nodiscard]] std::optional<MutualAlignment> mutual_alignment(const Image<float>& depth_m,
                                                              const Image<ColorUv>& uv,
                                                              const Image<std::uint8_t>& grey,
                                                              int reach = 12);

}  // namespace kino
