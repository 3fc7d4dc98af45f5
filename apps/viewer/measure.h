#pragma once

#include <glm/vec3.hpp>
#include <optional>
#include <vector>

#include "viz/scene/view.h"

namespace kino {

/// World point seen at a pixel (integer centres) at `view_z_m` along the view's axis.
[[nodiscard]] glm::dvec3 point_at(const View& view, const glm::dvec2& pixel, double view_z_m);

/// Two points in the world, set by clicks; a third click starts anew.
class Measure {
  public:
    void add(const glm::dvec3& point) {
        if (points_.size() == 2) points_.clear();
        points_.push_back(point);
    }
    void clear() { points_.clear(); }
    [[nodiscard]] const std::vector<glm::dvec3>& points() const { return points_; }
    /// Between both points.
    [[nodiscard]] std::optional<double> distance_m() const;

  private:
    std::vector<glm::dvec3> points_;
};

}  // namespace kino
