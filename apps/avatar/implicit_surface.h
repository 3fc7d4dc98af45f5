#pragma once

#include <functional>
#include <glm/vec3.hpp>

#include "viz/scene/mesh_asset.h"

namespace kino {

/// Triangles round where `distance_m` is negative, within a box, as a mesh with smooth normals and
/// without joints. Surface nets (Gibson 1998): a vertex in every cell of `cell_m` that the surface
/// crosses, at the mean of the crossings of its edges, then moved onto the surface along the
/// gradient. `distance_m` should grow about as fast as the distance does.
[[nodiscard]] MeshAsset polygonize(const std::function<double(const glm::dvec3&)>& distance_m,
                                   const glm::dvec3& low_m, const glm::dvec3& high_m,
                                   double cell_m);

}  // namespace kino
