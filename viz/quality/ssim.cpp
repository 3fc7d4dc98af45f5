#include "viz/quality/ssim.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace kino {
namespace {

constexpr int kSsimRadius = 5;
constexpr double kSsimDeviation = 1.5;
constexpr double kC1 = (0.01 * 255) * (0.01 * 255);
constexpr double kC2 = (0.03 * 255) * (0.03 * 255);

/// What one window sums: a, b, a^2, b^2, ab.
struct Moments {
    double a = 0, b = 0, aa = 0, bb = 0, ab = 0;
    void add(double weight, const Moments& m) {
        a += weight * m.a;
        b += weight * m.b;
        aa += weight * m.aa;
        bb += weight * m.bb;
        ab += weight * m.ab;
    }
};

double luma_of(const Rgba8& p) {
    return 0.299 * p.r + 0.587 * p.g + 0.114 * p.b;
}

std::vector<double> window_taps(int radius) {
    std::vector<double> taps;
    double sum = 0;
    for (int i = -radius; i <= radius; ++i) {
        taps.push_back(std::exp(-i * i / (2 * kSsimDeviation * kSsimDeviation)));
        sum += taps.back();
    }
    for (double& t : taps) t /= sum;
    return taps;
}

double similarity(const Moments& m) {
    const double variance_a = m.aa - m.a * m.a;
    const double variance_b = m.bb - m.b * m.b;
    const double covariance = m.ab - m.a * m.b;
    return (2 * m.a * m.b + kC1) * (2 * covariance + kC2) /
           ((m.a * m.a + m.b * m.b + kC1) * (variance_a + variance_b + kC2));
}

}  // namespace

Result<double> ssim(const Image<Rgba8>& a, const Image<Rgba8>& b) {
    if (a.width() != b.width() || a.height() != b.height()) {
        return fail(fmt::format("the pictures have different sizes: {}x{} and {}x{}", a.width(),
                                a.height(), b.width(), b.height()));
    }
    if (a.empty()) return fail("the pictures are empty");
    const int radius_x = std::min(kSsimRadius, (a.width() - 1) / 2);
    const int radius_y = std::min(kSsimRadius, (a.height() - 1) / 2);
    const std::vector<double> across = window_taps(radius_x);
    const std::vector<double> down = window_taps(radius_y);
    const int width = a.width() - 2 * radius_x;
    Image<Moments> rows(width, a.height());
    for (int y = 0; y < a.height(); ++y) {
        for (int x = 0; x < width; ++x) {
            Moments sum;
            for (std::size_t i = 0; i < across.size(); ++i) {
                const double la = luma_of(a.at(x + static_cast<int>(i), y));
                const double lb = luma_of(b.at(x + static_cast<int>(i), y));
                sum.add(across[i], {la, lb, la * la, lb * lb, la * lb});
            }
            rows.at(x, y) = sum;
        }
    }
    double total = 0;
    const int height = a.height() - 2 * radius_y;
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            Moments sum;
            for (std::size_t i = 0; i < down.size(); ++i) {
                sum.add(down[i], rows.at(x, y + static_cast<int>(i)));
            }
            total += similarity(sum);
        }
    }
    return total / (static_cast<double>(width) * height);
}

}  // namespace kino
