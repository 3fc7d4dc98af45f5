#pragma once

#include <functional>
#include <glm/vec2.hpp>

#include "base/camera_model.h"

namespace kino::kinect1 {

/// Depth pixel and metres to colour pixel, as a device's tables say it.
using PixelMap = std::function<glm::dvec2(int x, int y, double z_m)>;

struct ColorFit {
    CameraModel color;
    Pose color_from_depth;
    double rms_px = 0;  ///< over the grid that was fitted
    double max_px = 0;
};

/// The pinhole camera with k1, k2, p1, p2 and the pose that come nearest to `map` on a grid of
/// pixels at 0.5 to 8 m: least squares by Levenberg and Marquardt. Rotations beyond a degree and
/// translations beyond some millimetres off the baseline, which the map hardly determines, are
/// discouraged. Only what falls into `width` x `height`, or a little outside, counts.
[[nodiscard]] ColorFit fit_color_camera(const PixelMap& map, const CameraModel& depth, int width,
                                        int height, double baseline_m);

}  // namespace kino::kinect1
