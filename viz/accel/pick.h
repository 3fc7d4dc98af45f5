#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>

#include "viz/accel/bvh.h"
#include "viz/accel/triangle_soup.h"
#include "viz/scene/view.h"

namespace kino {

/// A line of sight or of pointing, world space.
struct WorldRay {
    glm::dvec3 origin{0};
    glm::dvec3 direction{0, 0, -1};  ///< any length but 0
};

/// From the eye through a picture's place, px (pixel centres at integers).
[[nodiscard]] WorldRay ray_through_pixel(const View& view, const glm::dvec2& pixel);

/// What a ray meets first.
struct Pick {
    TriangleSoup::Source source;  ///< node and triangle
    glm::dvec3 place{0};          ///< world
    glm::dvec3 normal{0};         ///< of the triangle, unit length, towards the ray's origin
    double distance_m = 0;
};

/// `tree` must have been built of `soup`. None where nothing is met within `reach_m`.
[[nodiscard]] std::optional<Pick> pick(const TriangleSoup& soup, const Bvh& tree,
                                       const WorldRay& ray, double reach_m = 1e6);

}  // namespace kino
