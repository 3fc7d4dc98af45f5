#include "apps/viewer/surprises.h"

#include <algorithm>
#include <cmath>

namespace kino {
namespace {

constexpr std::size_t kFewRatios = 12;
constexpr double kUnknownRatio = 1.1;

}  // namespace

void Surprises::add(double predicted_ms, double measured_ms) {
    const double ratio = measured_ms / predicted_ms;
    if (!(predicted_ms > 0) || !(measured_ms >= 0) || !std::isfinite(ratio)) return;
    ratios_[count_++ % kRecent] = ratio;
}

double Surprises::quantile(double share) const {
    const std::size_t known = std::min(count_, kRecent);
    if (known < kFewRatios) return kUnknownRatio;
    std::array<double, kRecent> sorted = ratios_;
    const auto end = sorted.begin() + static_cast<std::ptrdiff_t>(known);
    const double at = std::clamp(share, 0.0, 1.0) * static_cast<double>(known - 1);
    const auto nth = sorted.begin() + static_cast<std::ptrdiff_t>(at);
    std::nth_element(sorted.begin(), nth, end);
    return *nth;
}

}  // namespace kino
