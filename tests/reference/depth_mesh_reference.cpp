#include "tests/reference/depth_mesh_reference.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "base/check.h"

namespace kino::reference {

double EdgeTest::threshold_m(double nearest_m) const {
    if (kind == Kind::fixed) return fixed_m;
    constexpr double kSteepest = 80 * std::numbers::pi / 180;
    return 3 * 0.00307 * nearest_m * nearest_m + std::tan(kSteepest) * nearest_m / focal_px;
}

std::vector<RasterTriangle> depth_grid_triangles(const Image<float>& depth_m,
                                                 const EdgeTest& test) {
    std::vector<RasterTriangle> triangles;
    const auto depth = [&](std::uint32_t index) {
        return static_cast<double>(depth_m.pixels()[index]);
    };
    const auto add_if_whole = [&](const RasterTriangle& triangle) {
        const std::array<double, 3> z{depth(triangle[0]), depth(triangle[1]), depth(triangle[2])};
        for (const double reading : z) {
            if (!(reading > static_cast<double>(kNearestValidDepthM)) || !std::isfinite(reading))
                return;
        }
        const double largest_step =
            std::max({std::abs(z[0] - z[1]), std::abs(z[1] - z[2]), std::abs(z[2] - z[0])});
        const double nearest = std::min({z[0], z[1], z[2]});
        if (largest_step < test.threshold_m(nearest)) triangles.push_back(triangle);
    };
    for (int y = 0; y + 1 < depth_m.height(); ++y) {
        for (int x = 0; x + 1 < depth_m.width(); ++x) {
            const auto width = static_cast<std::uint32_t>(depth_m.width());
            const std::uint32_t i00 =
                static_cast<std::uint32_t>(y) * width + static_cast<std::uint32_t>(x);
            const std::uint32_t i10 = i00 + 1;
            const std::uint32_t i01 = i00 + width;
            const std::uint32_t i11 = i01 + 1;
            add_if_whole({i00, i10, i01});
            add_if_whole({i10, i11, i01});
        }
    }
    return triangles;
}

std::vector<RasterPoint> depth_grid_points(const Image<float>& depth_m, double fx, double fy,
                                           double cx, double cy, const Image<Rgba8>& color) {
    KINO_CHECK(color.empty() ||
               (color.width() == depth_m.width() && color.height() == depth_m.height()));
    std::vector<RasterPoint> points;
    points.reserve(depth_m.size());
    for (int y = 0; y < depth_m.height(); ++y) {
        for (int x = 0; x < depth_m.width(); ++x) {
            const double reading = static_cast<double>(depth_m.at(x, y));
            const double z = reading > 0 && std::isfinite(reading) ? reading : 0;
            points.push_back({.position = {(x - cx) / fx * z, (y - cy) / fy * z, z},
                              .color = color.empty() ? Rgba8{255, 255, 255, 255} : color.at(x, y)});
        }
    }
    return points;
}

}  // namespace kino::reference
