#pragma once

#include <memory>
#include <string>

#include "base/camera_model.h"
#include "base/error.h"
#include "base/frame.h"
#include "calibration/solve/depth_fit.h"
#include "calibration/solve/drift.h"

namespace kino {

/// Bias from a recording or device that looks at a flat wall: up to `frames` frames, averaged in
/// 1/z, against the plane that fits best.
[[nodiscard]] Result<BiasFit> bias_of_wall(const std::string& uri, int frames);

/// Drift of the depth over a recording of a still scene: some 600 frames, evenly spread over its
/// length; of a device, as long as Ctrl-C is not pressed. Nothing that Kinoscope records holds
/// temperatures.
[[nodiscard]] Result<DriftSeries> drift_of(const std::string& uri);

/// A frame with depth and colour, for showing one over the other. Null colour: there was none.
struct FramePair {
    std::shared_ptr<const DepthFrame> depth;
    std::shared_ptr<const ColorFrame> color;
};
/// The first such frame of a recording or device, and its calibration.
[[nodiscard]] Result<FramePair> first_pair(const std::string& uri, RigParameters& rig);

}  // namespace kino
