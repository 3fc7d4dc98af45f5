#include "tests/reference/lod_reference_depth.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace kino::reference {
namespace {

struct DepthSample {
    double z = 0, weight = 0;
    bool there = false;
};

double coded_luma(const Rgba8& c) {
    return (0.299 * c.r + 0.587 * c.g + 0.114 * c.b) / 255;
}

double along(int at, int fine, int coarse, double offset_px) {
    return (at + 0.5 - offset_px) * coarse / fine - 0.5;
}

int fine_pixel(int j, int fine, int coarse, double offset_px) {
    const double place = (j + 0.5) * fine / coarse - 0.5 + offset_px;
    return std::clamp(static_cast<int>(std::floor(place + 0.5)), 0, fine - 1);
}

}  // namespace

GuidedDepthPixel guided_depth(const Image<float>& depth, const Image<Rgba8>& color, int x, int y,
                              const GuidedDepthRules& rules) {
    const double u = along(x, color.width(), depth.width(), rules.offset_px);
    const double v = along(y, color.height(), depth.height(), rules.offset_px);
    const double own = coded_luma(color.at(x, y));
    std::array<DepthSample, 4> samples;
    double nearest = 1e300;
    for (int k = 0; k < 4; ++k) {
        const int left = static_cast<int>(std::floor(u)) + k % 2;
        const int top = static_cast<int>(std::floor(v)) + k / 2;
        const int i = std::clamp(left, 0, depth.width() - 1);
        const int j = std::clamp(top, 0, depth.height() - 1);
        const double tent = (1 - std::abs(u - left)) * (1 - std::abs(v - top));
        const Rgba8 other =
            color.at(fine_pixel(i, color.width(), depth.width(), rules.offset_px),
                     fine_pixel(j, color.height(), depth.height(), rules.offset_px));
        const bool known = other.a != 0 && color.at(x, y).a != 0;
        const double d = known ? coded_luma(other) - own : 0;
        const double z = depth.at(i, j);
        samples[k] = {z, tent, z > 0 && z < 1e9};
        const double exponent = d * d / (2 * rules.sigma_luma * rules.sigma_luma);
        // The exponent for now; the least of those that count is taken off below.
        if (samples[k].there && tent >= 1e-3) nearest = std::min(nearest, exponent);
        samples[k].weight = samples[k].there ? exponent : 0;
    }
    std::array<double, 4> tents{};
    for (int k = 0; k < 4; ++k) {
        const int left = static_cast<int>(std::floor(u)) + k % 2;
        const int top = static_cast<int>(std::floor(v)) + k / 2;
        tents[k] = (1 - std::abs(u - left)) * (1 - std::abs(v - top));
        if (samples[k].there) {
            samples[k].weight = tents[k] * std::exp(-std::max(samples[k].weight - nearest, 0.0));
        }
    }
    const int closest = (u - std::floor(u) < 0.5 ? 0 : 1) + (v - std::floor(v) < 0.5 ? 0 : 2);
    if (!samples[closest].there) return {};
    const auto same = [&](const DepthSample& a, const DepthSample& b) {
        return a.there && std::abs(a.z - b.z) <= rules.same_surface * b.z;
    };
    std::array<double, 4> support{};
    std::size_t best = 0;
    for (std::size_t k = 0; k < 4; ++k) {
        if (!samples[k].there) continue;
        for (const DepthSample& other : samples) {
            if (same(other, samples[k])) support[k] += other.weight;
        }
        if (support[k] > support[best]) best = k;
    }
    double sum = 0;
    double weights = 0;
    GuidedDepthPixel pixel{.z = 0, .margin = 1};
    for (std::size_t k = 0; k < 4; ++k) {
        if (!samples[k].there) continue;
        const bool in = same(samples[k], samples[best]);
        sum += in ? samples[k].weight * samples[k].z : 0;
        weights += in ? samples[k].weight : 0;
        // Whose own surface is another set of samples.
        for (const DepthSample& other : samples) {
            if (same(other, samples[k]) != same(other, samples[best])) {
                pixel.margin = std::min(pixel.margin, support[best] - support[k]);
            }
        }
    }
    pixel.z = sum / weights;
    return pixel;
}

}  // namespace kino::reference
