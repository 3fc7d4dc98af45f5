#include "skeleton/people/depth_grid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

namespace kino {
namespace {

constexpr float kNothing = std::numeric_limits<float>::infinity();

/// Least squares of position = a tangent + b.
struct Line {
    double n = 0, t = 0, tt = 0, p = 0, pt = 0;
    void add(double tangent, double position) {
        n += 1;
        t += tangent;
        tt += tangent * tangent;
        p += position;
        pt += tangent * position;
    }
    [[nodiscard]] std::pair<float, float> fit() const {
        const double spread = n * tt - t * t;
        if (!(spread > 1e-9)) return {1.0f, -1e9f};
        const double a = (n * pt - t * p) / spread;
        return {static_cast<float>(a), static_cast<float>((p - a * t) / n)};
    }
};

bool usable(const RayXy& ray) {
    return std::isfinite(ray.x) && std::isfinite(ray.y);
}

}  // namespace

DepthGrid::DepthGrid(const Image<RayXy>& rays, int cell_px)
    : cell_px_(cell_px), full_width_(rays.width()), full_height_(rays.height()) {
    KINO_CHECK(cell_px >= 1 && rays.width() >= cell_px && rays.height() >= cell_px);
    const int columns = rays.width() / cell_px, lines = rays.height() / cell_px;
    z_ = Image<float>(columns, lines, 0.0f);
    pick_.assign(z_.size(), RayXy{});
    rays_.reserve(4 * z_.size());
    const int low = cell_px / 4, high = (3 * cell_px) / 4;
    for (int y = 0; y < lines; ++y) {
        for (int x = 0; x < columns; ++x) {
            for (const int dy : {low, high}) {
                for (const int dx : {low, high}) {
                    rays_.push_back(rays.at(x * cell_px + dx, y * cell_px + dy));
                }
            }
        }
    }
    // The median distance of neighbouring rays: a few rays without an inverse do not matter.
    std::vector<float> steps;
    const int middle = rays.height() / 2;
    for (int x = 1; x < rays.width(); ++x) {
        const float step = rays.at(x, middle).x - rays.at(x - 1, middle).x;
        if (std::isfinite(step)) steps.push_back(std::abs(step));
    }
    if (!steps.empty()) {
        const auto half = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
        std::nth_element(steps.begin(), half, steps.end());
        cell_tangent_ = *half * static_cast<float>(cell_px);
    }
    fit_pinhole(rays);
}

void DepthGrid::fit_pinhole(const Image<RayXy>& rays) {
    // The middle half, where distortion is small.
    Line across, down;
    const int width = rays.width(), height = rays.height();
    const double cell = cell_px_;
    for (int x = width / 4; x < width - width / 4; ++x) {
        const RayXy& ray = rays.at(x, height / 2);
        if (usable(ray)) across.add(static_cast<double>(ray.x), (x + 0.5) / cell);
    }
    for (int y = height / 4; y < height - height / 4; ++y) {
        const RayXy& ray = rays.at(width / 2, y);
        if (usable(ray)) down.add(static_cast<double>(ray.y), (y + 0.5) / cell);
    }
    std::tie(focal_x_, middle_x_) = across.fit();
    std::tie(focal_y_, middle_y_) = down.fit();
}

void DepthGrid::sample(const Image<float>& depth_m) {
    KINO_CHECK(depth_m.width() == full_width_ && depth_m.height() == full_height_);
    const int low = cell_px_ / 4, high = (3 * cell_px_) / 4;
    const auto reading = [](float z) { return z >= kMinDepthM && z <= kMaxDepthM ? z : kNothing; };
    std::size_t cell = 0;
    for (int y = 0; y < height(); ++y) {
        const float* upper = depth_m.row(y * cell_px_ + low);
        const float* lower = depth_m.row(y * cell_px_ + high);
        for (int x = 0; x < width(); ++x, ++cell) {
            const int a = x * cell_px_ + low, b = x * cell_px_ + high;
            const std::array<float, 4> z = {reading(upper[a]), reading(upper[b]), reading(lower[a]),
                                            reading(lower[b])};
            const float near_up = std::min(z[0], z[1]), far_up = std::max(z[0], z[1]);
            const float near_low = std::min(z[2], z[3]), far_low = std::max(z[2], z[3]);
            const float nearest = std::min(near_up, near_low);
            float second = std::min(std::max(near_up, near_low), std::min(far_up, far_low));
            if (second == kNothing) second = nearest;
            std::size_t which = 0;
            while (which < 3 && z[which] != second) ++which;
            const RayXy& ray = rays_[4 * cell + which];
            const bool good = second != kNothing && usable(ray);
            z_.data()[cell] = good ? second : 0.0f;
            pick_[cell] = good ? ray : RayXy{};
        }
    }
}

}  // namespace kino
