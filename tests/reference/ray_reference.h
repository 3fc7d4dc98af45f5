#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <limits>
#include <span>
#include <vector>

namespace kino::reference {

/// One triangle, in double.
struct RayTriangle {
    glm::dvec3 a, b, c;
};

struct RayTriangleHit {
    double t = std::numeric_limits<double>::infinity();
    std::int64_t triangle = -1;
};

/// First triangle on the ray for t in [t_min, t_max]: all of them, one by one (Moeller and Trumbore
/// 1997), both sides, edges included. Of equal t the first.
[[nodiscard]] RayTriangleHit first_triangle_on_ray(
    std::span<const RayTriangle> triangles, const glm::dvec3& origin, const glm::dvec3& direction,
    double t_min = 0, double t_max = std::numeric_limits<double>::infinity());

/// How close the ray comes to an edge of any triangle, as an angle at its origin (tangent): beyond
/// rounding, nobody can say which side of such an edge it passes.
[[nodiscard]] double closest_edge(std::span<const RayTriangle> triangles, const glm::dvec3& origin,
                                  const glm::dvec3& direction);

/// Morton code of 30 bits of a place in the box, bit by bit from the top: each bit says on which
/// side of the cell's middle the place lies along one axis, then the cell is halved. The axis is
/// the longest edge of the cell (the first of equal ones, none more than 20 times), or x, y, z in
/// turn. Cells are counted in single precision, as the codes under test are.
[[nodiscard]] std::uint32_t morton_code_bit_by_bit(const std::array<float, 3>& place,
                                                   const std::array<float, 3>& lo,
                                                   const std::array<float, 3>& hi,
                                                   bool longest_cell);

/// What the listing in the source computes, faults and all: the scale is negative, and the highest
/// place wraps round.
[[nodiscard]] std::uint32_t morton_code_as_printed(const std::array<float, 3>& place,
                                                   const std::array<float, 3>& lo,
                                                   const std::array<float, 3>& hi);

/// Share of the cosine-weighted hemisphere round `normal` that sees no triangle within `reach`,
/// by a regular grid of directions (rings x sectors), all triangles for each.
[[nodiscard]] double open_hemisphere(std::span<const RayTriangle> triangles,
                                     const glm::dvec3& place, const glm::dvec3& normal,
                                     double reach, int rings, int sectors);

}  // namespace kino::reference
