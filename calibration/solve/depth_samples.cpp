#include "calibration/solve/depth_samples.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "base/check.h"

namespace kino {
namespace {

constexpr double kLeastSlope = 0.26;  // sine of 15 degrees
constexpr double kMarginPx = 2;
constexpr std::size_t kLeastSamples = 100;
constexpr double kScaleOff = 0.03;
constexpr double kWallShare = 0.05;

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

Result<std::vector<DepthSample>> samples_on_wall(const Image<float>& depth_m,
                                                 const Image<RayXy>& rays) {
    KINO_CHECK_EQ(depth_m.width(), rays.width());
    KINO_CHECK_EQ(depth_m.height(), rays.height());
    struct Point {
        glm::dvec3 ray;
        double inverse;
        int x, y;
    };
    std::vector<Point> points;
    for (int y = 0; y < depth_m.height(); ++y) {
        for (int x = 0; x < depth_m.width(); ++x) {
            const float z = depth_m.at(x, y);
            const RayXy ray = rays.at(x, y);
            if (!(z > 0) || std::isnan(ray.x)) continue;
            points.push_back({{ray.x, ray.y, 1}, 1 / static_cast<double>(z), x, y});
        }
    }
    const auto fail_flat = [&] {
        return fail("no flat wall fills half of the picture", "depth bias",
                    "point the camera at a bare wall from one to two metres");
    };
    const std::size_t least = depth_m.size() / 2;
    if (points.size() < std::max(kLeastSamples, least)) return fail_flat();
    // The first limit is wide: something in front of the wall has tilted the first plane.
    glm::dvec3 plane(0);
    double limit = 1e9;
    std::size_t kept = 0;
    for (int round = 0; round < 8; ++round) {
        glm::dmat3 normal(0);
        glm::dvec3 right(0);
        const auto off = [&](const Point& p) {
            return std::abs(glm::dot(plane, p.ray) - p.inverse);
        };
        for (const Point& p : points) {
            if (round > 0 && off(p) > limit) continue;
            normal += glm::outerProduct(p.ray, p.ray);
            right += p.inverse * p.ray;
        }
        if (!(std::abs(glm::determinant(normal)) > 1e-12)) return fail_flat();
        plane = glm::inverse(normal) * right;
        std::vector<double> errors;
        for (const Point& p : points) errors.push_back(off(p));
        const auto middle = errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2);
        std::nth_element(errors.begin(), middle, errors.end());
        // The median of |error| is 0.67 deviations.
        limit = std::min(4 * *middle / 0.6745 + 1e-9, kWallShare * std::abs(plane.z));
        kept = static_cast<std::size_t>(
            std::count_if(points.begin(), points.end(), [&](auto& p) { return off(p) <= limit; }));
    }
    if (kept < least) return fail_flat();
    std::vector<DepthSample> out;
    for (const Point& p : points) {
        const double on_plane = glm::dot(plane, p.ray);
        if (std::abs(on_plane - p.inverse) > limit || !(on_plane > 0)) continue;
        out.push_back(
            {static_cast<float>(p.x), static_cast<float>(p.y), 1 / p.inverse, 1 / on_plane});
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
