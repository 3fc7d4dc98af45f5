#pragma once

#include <string_view>

#include "base/image.h"

namespace kino {

/// What counts as a reading: 1 mm to 1 km. Everything else (0, negative, NaN, infinite) is "no
/// reading", and every filter writes 0 for it, as calibration/rig.h does.
constexpr float kNearestReadingM = 1e-3f;
constexpr float kFarthestReadingM = 1e3f;
[[nodiscard]] constexpr bool is_reading(float z_m) {
    return z_m >= kNearestReadingM && z_m <= kFarthestReadingM;
}

/// Triangulating sensors measure disparity, so their noise grows as sigma(z) = k z^2 (Khoshelham &
/// Elberink 2012). In inverse depth it is k everywhere, and a plane is an affine function of the
/// pixel: filters compare and average there, thresholds are counts of k, and planes stay planes.
/// Kinect v1: 0.46 steps of noise and 0.29 of rounding, 0.00307 1/m each.
constexpr double kKinectNoisePerM = 0.0017;
/// One step of a Kinect v1 in inverse depth, 1/m: Rig::quantisation_step_m(1).
constexpr double kKinectStepPerM = 0.00307;
/// Focal length of a Kinect v1's depth camera as a share of the picture's width.
constexpr double kKinectFocalShare = 0.893;

/// One stage of depth filtering: metres along the axis in, metres out, 0 = no reading. Used by one
/// thread at a time; after the first frame of a size nothing is allocated. Frames of another size
/// may follow at any time.
class DepthFilter {
  public:
    virtual ~DepthFilter() = default;
    DepthFilter() = default;
    DepthFilter(const DepthFilter&) = delete;
    DepthFilter& operator=(const DepthFilter&) = delete;

    [[nodiscard]] virtual std::string_view name() const = 0;
    /// Writes `out`, which must not be `in`; its size is in's, divided by reduction() and rounded
    /// up.
    virtual void apply(const Image<float>& in, Image<float>& out) = 0;
    /// Forgets earlier frames: after a seek or a cut.
    virtual void reset() {}
    /// How many pixels a side become one.
    [[nodiscard]] virtual int reduction() const { return 1; }
};

/// Where a filter's arithmetic runs.
struct FilterOptions {
    /// False: the portable code even where the processor has AVX2. Same bits, more time.
    bool simd = true;
};

}  // namespace kino
