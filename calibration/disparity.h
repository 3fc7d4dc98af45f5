#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "base/camera_model.h"

namespace kino {

/// Published ways to read a Kinect v1's 11-bit number; raw grows with distance in all of them.
enum class DisparityFormula : std::uint8_t {
    zero_plane,        ///< the device's own reference plane (libfreenect registration.c): default
    inverse_linear,    ///< 1/(3.3309495161 - 0.0030711016 raw) m (Burrus, early ROS)
    tangent,           ///< 0.1236 tan(raw/2842.5 + 1.1863) m (Magnenat; some subtract 0.037 m)
    baseline_over_raw  ///< 8 b f/(doff - raw), b 75 mm, f 580 px, doff 1090 (ROS
                       ///< kinect_calibration)
};
[[nodiscard]] std::string_view name(DisparityFormula formula);

/// Raw disparity to metres and back: one object for both directions, so what a recording encodes
/// decodes to itself. Depth outside [min_depth_m, max_depth_m] is invalid, which keeps every
/// formula away from its pole (raw 1084.6 to 1090, beyond which depth turns negative).
class Disparity {
  public:
    static constexpr int kLevels = 2048;
    static constexpr std::uint16_t kNoReading = 2047;

    /// The range is limited to 0.3..10 m whatever is asked for; the parameters must be valid.
    explicit Disparity(const DisparityParameters& parameters = {}, double min_depth_m = 0.3,
                       double max_depth_m = 10.0,
                       DisparityFormula formula = DisparityFormula::zero_plane);

    /// Metres at a (possibly fractional) raw value. None outside the range or [0, 2046].
    [[nodiscard]] std::optional<double> metres(double raw) const;
    /// The unrounded inverse of metres(). None for depth outside the range, NaN, or a raw value
    /// that eleven bits cannot hold.
    [[nodiscard]] std::optional<double> raw_exact(double depth_m) const;
    /// What the sensor would send for that depth: nearest whole raw value, kNoReading if none.
    [[nodiscard]] std::uint16_t raw(double depth_m) const;
    /// Change of depth from one raw value to the next at that depth, m: the formula's derivative.
    [[nodiscard]] double step_m(double depth_m) const;

    /// metres() of every raw value in float, 0 where invalid.
    [[nodiscard]] const std::array<float, kLevels>& table() const { return table_; }
    [[nodiscard]] DisparityFormula formula() const { return formula_; }

  private:
    [[nodiscard]] double evaluate(double raw) const;
    [[nodiscard]] double invert(double depth_m) const;

    DisparityParameters parameters_;
    double min_depth_m_;
    double max_depth_m_;
    DisparityFormula formula_;
    std::array<float, kLevels> table_{};
};

}  // namespace kino
