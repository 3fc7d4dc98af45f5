#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/image.h"
#include "calibration/rig.h"

namespace kino {

/// A depth pixel on a board whose place is known.
struct DepthSample {
    float x = 0, y = 0;   ///< px
    double measured = 0;  ///< as the image has it: metres, or raw disparity
    double true_m = 0;    ///< along the optical axis
};

/// The pixels that look at the board's rectangle from (0, 0) to `far_corner_m` in its plane, two
/// pixels of its border left out. `depth` holds 0 where there is no reading; `rays` of the same
/// size. Boards seen at less than 15 degrees are left out: there the border decides.
[[nodiscard]] std::vector<DepthSample> samples_on_board(const Image<float>& depth,
                                                        const Image<RayXy>& rays,
                                                        const Pose& depth_from_board,
                                                        const glm::dvec2& far_corner_m);

/// The same from a flat wall that fills most of the picture, whose place nobody knows: the plane
/// that fits best takes the part. In 1/z a plane is a + b x + c y over the rays, so that a bias
/// which varies like this over the picture stays with the plane: a wall shows the rest. Pixels more
/// than four deviations or 5 % of 1/z off are left out. Fails where less than half of the picture
/// lies on one plane.
[[nodiscard]] Result<std::vector<DepthSample>> samples_on_wall(const Image<float>& depth_m,
                                                               const Image<RayXy>& rays);

/// Median of measured over true depth, both metres: what the board's stated size must be multiplied
/// with to agree with the depth. None for fewer than 100 samples.
[[nodiscard]] std::optional<double> depth_scale(const std::vector<DepthSample>& samples);

/// A sentence where the scale is off by more than 3 %, which no depth sensor in its range is:
/// "the depth says that the squares are 30.0 mm, not 25.0 mm".
[[nodiscard]] std::optional<std::string> scale_complaint(const std::vector<DepthSample>& samples,
                                                         double square_m);

}  // namespace kino
