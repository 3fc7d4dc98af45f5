#include "sensor/convert/depth_units.h"

#include <fmt/format.h>

#include <cmath>

namespace kino {
namespace {

constexpr double kLargest = 65534;  // 65535 is "no reading" to many readers
// Ratios of units like 0.001 / 0.0002 are whole up to the noise of doubles.
constexpr double kWhole = 1e-7;

}  // namespace

Result<Image<std::uint16_t>> depth_in_units(const DepthFrame& frame, double metres_per_unit,
                                            ConvertGeometry& geometry, Losses& losses) {
    const bool linear = frame.unit == DepthUnit::linear;
    if (linear && frame.metres_per_unit == metres_per_unit) return frame.raw;
    Image<float> metres;
    if (!linear) KINO_TRY(geometry.metres(frame, metres));
    Image<std::uint16_t> out(frame.raw.width(), frame.raw.height());
    const double ratio = frame.metres_per_unit / metres_per_unit;
    std::int64_t rounded = 0;
    std::int64_t too_far = 0;
    for (std::size_t i = 0; i < out.size(); ++i) {
        const std::uint16_t raw = frame.raw.data()[i];
        const double exact = linear ? (raw == 0xFFFF ? 0 : raw * ratio)
                                    : static_cast<double>(metres.data()[i]) / metres_per_unit;
        const double whole = std::floor(exact + 0.5);
        if (!(exact > 0)) continue;
        if (whole > kLargest) {
            ++too_far;
            continue;
        }
        if (linear && std::abs(whole - exact) > kWhole * exact) ++rounded;
        out.data()[i] = static_cast<std::uint16_t>(whole);
    }
    const double per_metre = 1 / metres_per_unit;
    if (!linear) {
        losses.state(
            fmt::format("raw disparity became depth at {:.6g} counts a metre: only "
                        "sessions (.mkv) and --to png keep it",
                        per_metre));
    }
    losses.add(fmt::format("depths rounded to {:.6g} counts a metre", per_metre), rounded);
    losses.add("depths left out: too far for 16 bits", too_far);
    return out;
}

double counts_per_metre(double metres_per_unit) {
    const double near = 1 / metres_per_unit;
    for (const double candidate :
         {std::round(near), near, std::nextafter(near, 0.0), std::nextafter(near, 2 * near)}) {
        if (1 / candidate == metres_per_unit) return candidate;
    }
    return near;
}

}  // namespace kino
