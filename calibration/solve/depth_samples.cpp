#include "calibration/solve/depth_samples.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "base/check.h"

namespace kino {
namespace {

constexpr double kLeastSlope = 0.26;  // sine of 15 degrees
constexpr double kMarginPx = 2;
constexpr std::size_t kLeastSamples = 100;
constexpr double kScaleOff = 0.03;

}  // namespace

std::vector<DepthSample> samples_on_board(const Image<float>& depth, const Image<RayXy>& rays,
                                          const Pose& depth_from_board,
                                          const glm::dvec2& far_corner_m) {
    KINO_CHECK_EQ(depth.width(), rays.width());
    KINO_CHECK_EQ(depth.height(), rays.height());
    std::vector<DepthSample> out;
    const Pose board_from_depth = inverse(depth_from_board);
    const glm::dvec3 eye = board_from_depth.translation;
    for (int y = 0; y < depth.height(); ++y) {
        for (int x = 0; x < depth.width(); ++x) {
            const float measured = depth.at(x, y);
            const RayXy ray = rays.at(x, y);
            if (!(measured > 0) || std::isnan(ray.x)) continue;
            const glm::dvec3 way = board_from_depth.rotation * glm::dvec3(ray.x, ray.y, 1);
            if (std::abs(way.z) < kLeastSlope * glm::length(way)) continue;
            const double z = -eye.z / way.z;
            if (!(z > 0)) continue;
            const glm::dvec3 hit = eye + z * way;
            // A pixel's width on the board, roughly: neighbouring rays are this far apart.
            const RayXy next = rays.at(std::min(x + 1, depth.width() - 1), y);
            const double step = std::isnan(next.x) ? 0 : std::abs(next.x - ray.x);
            const double margin = kMarginPx * z * step;
            if (hit.x < margin || hit.y < margin || hit.x > far_corner_m.x - margin ||
                hit.y > far_corner_m.y - margin) {
                continue;
            }
            out.push_back({static_cast<float>(x), static_cast<float>(y), measured, z});
        }
    }
    return out;
}

std::optional<double> depth_scale(const std::vector<DepthSample>& samples) {
    if (samples.size() < kLeastSamples) return std::nullopt;
    std::vector<double> ratios;
    for (const DepthSample& sample : samples) ratios.push_back(sample.measured / sample.true_m);
    const auto middle = ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2);
    std::nth_element(ratios.begin(), middle, ratios.end());
    return *middle;
}

std::optional<std::string> scale_complaint(const std::vector<DepthSample>& samples,
                                           double square_m) {
    const auto scale = depth_scale(samples);
    if (!scale || std::abs(*scale - 1) <= kScaleOff) return std::nullopt;
    return fmt::format("the depth says that the squares are {:.1f} mm, not {:.1f} mm",
                       1000 * square_m * *scale, 1000 * square_m);
}

}  // namespace kino
