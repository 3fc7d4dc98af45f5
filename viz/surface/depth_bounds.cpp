#include "viz/surface/depth_bounds.h"

#include <algorithm>
#include <cmath>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <vector>

namespace kino {

DepthBounds measure_depth_bounds(const Image<float>& depth_m) {
    const int width = depth_m.width();
    constexpr float kNone = std::numeric_limits<float>::infinity();
    std::vector<float> of_column(static_cast<std::size_t>(width), 0.0f);
    DepthBounds bounds{.nearest_m = kNone};
    for (int y = 0; y < depth_m.height(); ++y) {
        const float* row = depth_m.row(y);
        float most = 0;
        float least = kNone;
        for (int x = 0; x < width; ++x) {
            // Comparisons are false for what is not a number.
            const float z = row[x] > 0 && row[x] < kNone ? row[x] : 0.0f;
            float& column = of_column[static_cast<std::size_t>(x)];
            column = std::max(column, z);
            most = std::max(most, z);
            least = std::min(least, z > 0 ? z : kNone);
        }
        if (!(most > 0)) continue;
        if (bounds.y1 == 0) bounds.y0 = static_cast<std::uint32_t>(y);
        bounds.y1 = static_cast<std::uint32_t>(y) + 1;
        bounds.nearest_m = std::min(bounds.nearest_m, least);
        bounds.farthest_m = std::max(bounds.farthest_m, most);
    }
    if (bounds.y1 == 0) return {};
    const auto seen = [](float z) { return z > 0; };
    const auto first = std::find_if(of_column.begin(), of_column.end(), seen);
    const auto last = std::find_if(of_column.rbegin(), of_column.rend(), seen);
    bounds.x0 = static_cast<std::uint32_t>(first - of_column.begin());
    bounds.x1 = static_cast<std::uint32_t>(of_column.rend() - last);
    return bounds;
}

VkRect2D picture_bounds(const shared::SurfaceParams& p, const DepthBounds& bounds,
                        double margin_px) {
    const VkRect2D all{{0, 0}, {p.target.x, p.target.y}};
    glm::dvec2 low(std::numeric_limits<double>::infinity());
    glm::dvec2 high(-std::numeric_limits<double>::infinity());
    for (int corner = 0; corner < 8; ++corner) {
        const double x = (corner & 1) != 0 ? bounds.x1 - 1.0 : bounds.x0;
        const double y = (corner & 2) != 0 ? bounds.y1 - 1.0 : bounds.y0;
        const double z = (corner & 4) != 0 ? bounds.farthest_m : bounds.nearest_m;
        const glm::dvec4 point((x - p.depth_k.z) * p.depth_k.x * z,
                               (y - p.depth_k.w) * p.depth_k.y * z, z, 1);
        const double depth = glm::dot(glm::dvec4(p.view_from_depth_z), point);
        if (!(depth >= p.near_m)) return all;
        const glm::dvec2 at(
            p.k.x * glm::dot(glm::dvec4(p.view_from_depth_x), point) / depth + p.k.z,
            p.k.y * glm::dot(glm::dvec4(p.view_from_depth_y), point) / depth + p.k.w);
        low = glm::min(low, at);
        high = glm::max(high, at);
    }
    const auto clamp = [](double v, std::uint32_t most) {
        return static_cast<std::int32_t>(std::clamp(v, 0.0, static_cast<double>(most)));
    };
    const std::int32_t x0 = clamp(std::floor(low.x - margin_px), p.target.x);
    const std::int32_t y0 = clamp(std::floor(low.y - margin_px), p.target.y);
    const std::int32_t x1 = clamp(std::ceil(high.x + margin_px) + 1, p.target.x);
    const std::int32_t y1 = clamp(std::ceil(high.y + margin_px) + 1, p.target.y);
    // Nothing of it is in the picture: one pixel, so that nobody has to treat it apart.
    if (x1 <= x0 || y1 <= y0) return {{0, 0}, {1, 1}};
    return {{x0, y0}, {static_cast<std::uint32_t>(x1 - x0), static_cast<std::uint32_t>(y1 - y0)}};
}

}  // namespace kino
