#pragma once

#include <vector>

#include "base/camera_model.h"
#include "base/error.h"
#include "base/image.h"
#include "calibration/solve/depth_samples.h"

namespace kino {

/// Disparity to metres from boards at several distances.
struct DisparityFit {
    DisparityParameters parameters;
    double rms_steps = 0;  ///< of the samples kept, in units of raw disparity
    double nearest_m = 0;  ///< of the samples
    double farthest_m = 0;
    int samples = 0;
};

/// The zero-plane formula is a line: 1/z = a + b raw. Its two numbers give const_shift and
/// reference_distance_cm; pixel size and emitter distance stay as in `known`, for no depth tells
/// them apart. Samples more than four deviations off are dropped once. Fails where the farthest
/// sample is not half as far again as the nearest, or where depth does not grow with raw.
[[nodiscard]] Result<DisparityFit> fit_disparity(const std::vector<DepthSample>& samples,
                                                 const DisparityParameters& known);

/// What the depth of each part of the picture is off by, as a difference of 1/z, which
/// triangulation makes constant with distance: 1/z_true = 1/z - bias. Cells over the picture,
/// bilinear between their middles, so that every pixel has its own.
struct DepthBias {
    int width = 0, height = 0;  ///< of the depth image, px
    int columns = 0, rows = 0;
    std::vector<float> per_m;  ///< 1/m, row by row; 0 where nothing was seen

    [[nodiscard]] double at(double x, double y) const;
    /// Metres in place; 0 stays 0, and what would turn negative or beyond 100 m becomes 0.
    void correct(Image<float>& depth_m) const;
};

/// Medians by cell; cells with fewer than 50 samples are filled from their neighbours, a ring at a
/// time. `samples` measured in metres. Fails where no cell has enough.
[[nodiscard]] Result<DepthBias> fit_bias(const std::vector<DepthSample>& samples, int width,
                                         int height, int columns = 20, int rows = 15);

}  // namespace kino
