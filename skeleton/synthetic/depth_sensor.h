#pragma once

#include <cstdint>
#include <vector>

#include "base/camera_model.h"
#include "base/image.h"
#include "calibration/disparity.h"
#include "skeleton/synthetic/raycast_kernel.h"
#include "skeleton/synthetic/visibility.h"

namespace kino {

struct DepthSensorOptions {
    bool noise = true;           ///< disparity noise and lost edge pixels
    double sigma_steps = 0.46;   ///< of the disparity, raw steps: about 0.0014 z^2 m
    double edge_jump_steps = 6;  ///< between neighbours, raw steps: an edge
    double drop_next = 0.45, drop_second = 0.15;  ///< chance of loss 1 and 2 px from an edge
};

/// Turns true depth into what a Kinect v1 would send: raw disparity, shadowed and out-of-range
/// pixels without a reading, noise. A reading depends on pixel, frame number and scene only.
class DepthSensor {
  public:
    DepthSensor(const DepthSensor&) = delete;  // the quantiser points into it
    DepthSensor& operator=(const DepthSensor&) = delete;
    explicit DepthSensor(const RigParameters& rig, const DepthSensorOptions& options = {});

    /// The object that decodes what measure() writes.
    [[nodiscard]] const Disparity& disparity() const { return disparity_; }

    /// Fills `raw` (same size as the visibility's pictures) for frame `index`.
    void measure(const Visibility& seen, std::int64_t index, Image<std::uint16_t>& raw);

  private:
    Disparity disparity_;
    raycast::Quantiser quantiser_;
    std::vector<float> normal_quantiles_;
    std::vector<float> exact_;  // unrounded raw values with a margin on all sides
};

}  // namespace kino
