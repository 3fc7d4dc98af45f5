#pragma once

#include <vector>

#include "base/camera_model.h"
#include "base/error.h"
#include "calibration/depth_bias.h"
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

/// A bias map and what it is worth.
struct BiasFit {
    DepthBias bias;
    double seen_share = 0;     ///< of the cells that had samples of their own
    double rms_before_mm = 0;  ///< of the samples' depth, as it would be at 1 m
    double rms_after_mm = 0;   ///< the same, corrected
    int samples = 0;
};

/// Medians by cell; cells with fewer than 50 samples are filled from their neighbours, a ring at a
/// time. `samples` measured in metres. Fails where no cell has enough.
[[nodiscard]] Result<BiasFit> fit_bias(const std::vector<DepthSample>& samples, int width,
                                       int height, int columns = 20, int rows = 15);

}  // namespace kino
