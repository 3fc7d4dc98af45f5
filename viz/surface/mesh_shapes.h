#pragma once

#include <glm/vec3.hpp>
#include <memory>
#include <string>
#include <vector>

#include "viz/scene/mesh_asset.h"

namespace kino {

// Simple bodies round the origin, metres, y up, counter-clockwise from outside, with the normals
// of the true body (not of its facets) and uvs in 0 .. 1. Counts are clamped to what makes a body.

/// Edges of the given lengths, along the axes; every side has the whole texture.
[[nodiscard]] std::shared_ptr<const MeshAsset> make_box(const glm::vec3& size_m);
/// `rings` from pole to pole (at least 2), `segments` round the axis (at least 3).
[[nodiscard]] std::shared_ptr<const MeshAsset> make_sphere(float radius_m, int segments = 32,
                                                           int rings = 16);
/// Along y, closed by lids.
[[nodiscard]] std::shared_ptr<const MeshAsset> make_cylinder(float radius_m, float height_m,
                                                             int segments = 32);
/// Tip up at y = height / 2, closed below.
[[nodiscard]] std::shared_ptr<const MeshAsset> make_cone(float radius_m, float height_m,
                                                         int segments = 32);
/// In the plane y = 0, seen from above; `columns` x `rows` cells of two triangles.
[[nodiscard]] std::shared_ptr<const MeshAsset> make_grid(float width_m, float depth_m,
                                                         int columns = 1, int rows = 1);
/// Round y: a tube of `tube_radius_m` whose middle runs at `ring_radius_m`, the larger one.
[[nodiscard]] std::shared_ptr<const MeshAsset> make_torus(float ring_radius_m, float tube_radius_m,
                                                          int segments = 32, int sides = 16);

/// Sets a bounding sphere of the positions: round the middle of their box, no vertex outside.
void set_bounding_sphere(MeshAsset& mesh);

/// What of MeshAsset's invariants `mesh` breaks, in words; empty: nothing.
[[nodiscard]] std::string broken_invariant(const MeshAsset& mesh);

}  // namespace kino
