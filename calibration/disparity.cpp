#include "calibration/disparity.h"

#include <algorithm>
#include <cmath>

namespace kino {
namespace {

constexpr double kLinearOffset = 3.3309495161;
constexpr double kLinearSlope = 0.0030711016;
constexpr double kTangentScale = 0.1236;
constexpr double kTangentDivisor = 2842.5;
constexpr double kTangentOffset = 1.1863;
constexpr double kRosNumerator = 8 * 0.075 * 580;
constexpr double kRosOffset = 1090;
// A range limit that is itself a whole raw value must not lose it to the last bit.
constexpr double kRangeSlack = 1e-9;

}  // namespace

std::string_view name(DisparityFormula formula) {
    switch (formula) {
        case DisparityFormula::zero_plane:
            return "zero-plane";
        case DisparityFormula::inverse_linear:
            return "inverse-linear";
        case DisparityFormula::tangent:
            return "tangent";
        case DisparityFormula::baseline_over_raw:
            return "baseline-over-raw";
    }
    return "unknown";
}

Disparity::Disparity(const DisparityParameters& parameters, double min_depth_m, double max_depth_m,
                     DisparityFormula formula)
    : parameters_(parameters),
      min_depth_m_(std::max(min_depth_m, 0.3) - kRangeSlack),
      max_depth_m_(std::min(max_depth_m, 10.0) + kRangeSlack),
      formula_(formula) {
    for (int i = 0; i < kLevels; ++i) {
        table_[static_cast<std::size_t>(i)] = static_cast<float>(metres(i).value_or(0));
    }
}

double Disparity::evaluate(double raw) const {
    switch (formula_) {
        case DisparityFormula::zero_plane: {
            const DisparityParameters& p = parameters_;
            // The quarter stays: rounding it away, as integer code does, costs up to three steps.
            const double shift = (raw - 4 * p.const_shift) / 4 - 0.375;
            const double m = p.reference_pixel_size_mm * shift;
            const double z_mm = 10 * (m * p.reference_distance_cm / (p.emitter_distance_cm - m) +
                                      p.reference_distance_cm);
            return z_mm / 1000;
        }
        case DisparityFormula::inverse_linear:
            return 1 / (kLinearOffset - kLinearSlope * raw);
        case DisparityFormula::tangent:
            return kTangentScale * std::tan(raw / kTangentDivisor + kTangentOffset);
        case DisparityFormula::baseline_over_raw:
            return kRosNumerator / (kRosOffset - raw);
    }
    return 0;
}

double Disparity::invert(double depth_m) const {
    switch (formula_) {
        case DisparityFormula::zero_plane: {
            const DisparityParameters& p = parameters_;
            const double m = p.emitter_distance_cm - 10 * p.reference_distance_cm *
                                                         p.emitter_distance_cm / (1000 * depth_m);
            return 4 * (m / p.reference_pixel_size_mm + 0.375) + 4 * p.const_shift;
        }
        case DisparityFormula::inverse_linear:
            return (kLinearOffset - 1 / depth_m) / kLinearSlope;
        case DisparityFormula::tangent:
            return (std::atan(depth_m / kTangentScale) - kTangentOffset) * kTangentDivisor;
        case DisparityFormula::baseline_over_raw:
            return kRosOffset - kRosNumerator / depth_m;
    }
    return 0;
}

std::optional<double> Disparity::metres(double raw) const {
    if (!(raw >= 0 && raw <= kNoReading - 1)) return std::nullopt;
    const double z = evaluate(raw);
    // Past the pole z is negative; at it, infinite: both fail here.
    if (!(z >= min_depth_m_ && z <= max_depth_m_)) return std::nullopt;
    return z;
}

std::optional<double> Disparity::raw_exact(double depth_m) const {
    if (!(depth_m >= min_depth_m_ && depth_m <= max_depth_m_)) return std::nullopt;
    const double raw = invert(depth_m);
    if (!(raw >= -0.5 && raw < kNoReading - 0.5)) return std::nullopt;
    return raw;
}

std::uint16_t Disparity::raw(double depth_m) const {
    const auto exact = raw_exact(depth_m);
    if (!exact) return kNoReading;
    const double nearest = std::max(0.0, std::round(*exact));
    // Next to a range limit the nearest raw value may itself decode to nothing.
    if (!metres(nearest)) return kNoReading;
    return static_cast<std::uint16_t>(nearest);
}

double Disparity::step_m(double depth_m) const {
    const double z = depth_m;
    switch (formula_) {
        case DisparityFormula::zero_plane: {
            const DisparityParameters& p = parameters_;
            return 1000 * z * z * p.reference_pixel_size_mm /
                   (40 * p.reference_distance_cm * p.emitter_distance_cm);
        }
        case DisparityFormula::inverse_linear:
            return kLinearSlope * z * z;
        case DisparityFormula::tangent: {
            const double t = z / kTangentScale;
            return kTangentScale * (1 + t * t) / kTangentDivisor;
        }
        case DisparityFormula::baseline_over_raw:
            return z * z / (kRosNumerator);
    }
    return 0;
}

}  // namespace kino
