#include "apps/viewer/measure.h"

#include <glm/geometric.hpp>

namespace kino {

glm::dvec3 point_at(const View& view, const glm::dvec2& pixel, double view_z_m) {
    const Projection& p = view.projection;
    return view.world_from_view *
           (view_z_m * glm::dvec3((pixel.x - p.cx) / p.fx, (pixel.y - p.cy) / p.fy, 1));
}

std::optional<double> Measure::distance_m() const {
    if (points_.size() < 2) return std::nullopt;
    return glm::distance(points_[0], points_[1]);
}

}  // namespace kino
