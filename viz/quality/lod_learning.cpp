#include "viz/quality/lod_learning.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/check.h"

namespace kino {
namespace {

constexpr double kLeastExponent = 0.25;
constexpr double kMostExponent = 4;
/// Share of a new frame in the running error.
constexpr double kDriftShare = 0.1;

double middle_of(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

}  // namespace

LodComponent learn_lod_component(const LodSamples& samples) {
    KINO_CHECK_EQ(samples.ms_with.size(), samples.ms_without.size());
    KINO_CHECK_EQ(samples.r.size(), samples.mse.size());
    KINO_CHECK(!samples.ms_with.empty() && samples.pixels > 0);
    LodComponent component{.name = samples.name};
    std::vector<double> differences;
    for (std::size_t i = 0; i < samples.ms_with.size(); ++i) {
        differences.push_back(samples.ms_with[i] - samples.ms_without[i]);
    }
    component.cost_ns = std::max(0.0, middle_of(std::move(differences)) * 1e6 / samples.pixels);

    double n = 0, x = 0, y = 0, xx = 0, xy = 0;
    for (std::size_t i = 0; i < samples.r.size(); ++i) {
        KINO_CHECK(samples.r[i] > 1);
        if (!(samples.mse[i] > 0)) continue;
        const double u = std::log(samples.r[i]);
        const double v = std::log(samples.mse[i]);
        n += 1;
        x += u;
        y += v;
        xx += u * u;
        xy += u * v;
    }
    if (n == 0) return component;
    const double spread = n * xx - x * x;
    // All at one factor: the curve's shape is not known, its height is.
    if (spread > 1e-9) {
        component.exponent = std::clamp((n * xy - x * y) / spread, kLeastExponent, kMostExponent);
    }
    component.error = std::exp((y - component.exponent * x) / n);
    return component;
}

void LodDrift::add(double r, double mse) {
    KINO_CHECK(r > 1);
    if (!(mse > 0) || learned_.error <= 0) return;
    const double predicted = learned_.error * std::pow(r, learned_.exponent);
    const double seen = std::log(mse / predicted);
    log_ratio_ = any_ ? log_ratio_ + kDriftShare * (seen - log_ratio_) : seen;
    any_ = true;
}

LodComponent LodDrift::current() const {
    LodComponent now = learned_;
    now.error *= std::exp(log_ratio_);
    return now;
}

bool LodDrift::drifted(double factor) const {
    return std::abs(log_ratio_) > std::log(factor);
}

}  // namespace kino
