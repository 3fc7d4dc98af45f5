#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "skeleton/actors/actor_body.h"

namespace kino::test {

struct MeshHit {
    double z_m = 0;  ///< 0: nothing
    int part = -1;
};

/// Nearest front face (or open cloth) on the ray from the origin through (x, y, 1), by trying every
/// triangle in doubles (Moeller & Trumbore 1997). As slow as it is plain.
[[nodiscard]] MeshHit hit_mesh(const ActorBody& body, const std::vector<glm::vec3>& view_m,
                               double x, double y);

/// How often the closed surface winds round a point: 1 inside, 0 outside; the sum of the solid
/// angles of all triangles (van Oosterom & Strackee 1983) over 4 pi.
[[nodiscard]] double winding_number(const ActorBody& body, const std::vector<glm::vec3>& points_m,
                                    const glm::dvec3& at_m);

/// Distance to the nearest vertex.
[[nodiscard]] double distance_to_mesh(const std::vector<glm::vec3>& points_m,
                                      const glm::dvec3& at_m);

}  // namespace kino::test
