#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/error.h"
#include "tests/reference/ray_reference.h"
#include "tests/support/random.h"
#include "viz/accel/traverse.h"

namespace kino::test {

struct NamedMesh {
    std::string name;
    std::vector<Triangle> triangles;
};

/// Positions and faces of a Wavefront file; polygons become fans.
[[nodiscard]] Result<std::vector<Triangle>> load_obj(const std::string& path);

/// Closed.
[[nodiscard]] std::vector<Triangle> sphere_mesh(const glm::vec3& center, float radius, int rings,
                                                int sectors);
/// 3.4 x 2.5 m with depth noise of 30 mm, two triangles a cell: what a sensor makes of a wall.
[[nodiscard]] std::vector<Triangle> noisy_wall(int columns, int rows, std::uint64_t seed);
/// The inside of a box 6 x 3 x 5 m with spheres on its floor: closed.
[[nodiscard]] std::vector<Triangle> room_mesh(int balls, int rings, std::uint64_t seed);
/// Triangles of sizes from a micrometre to metres, slivers, duplicates, and many at one place.
[[nodiscard]] std::vector<Triangle> awkward_mesh(int count, std::uint64_t seed);

/// Small meshes that every law is held against; all without faults.
[[nodiscard]] const std::vector<NamedMesh>& test_meshes();

/// A ray from about the mesh to about it; some along axes, some with limits.
[[nodiscard]] Ray random_ray(Random& random, const std::vector<Triangle>& triangles);

[[nodiscard]] std::vector<reference::RayTriangle> in_double(const std::vector<Triangle>& triangles);

}  // namespace kino::test
