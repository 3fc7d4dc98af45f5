#include "tests/reference/ray_reference.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

namespace kino::reference {

RayTriangleHit first_triangle_on_ray(std::span<const RayTriangle> triangles,
                                     const glm::dvec3& origin, const glm::dvec3& direction,
                                     double t_min, double t_max) {
    RayTriangleHit best;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        const RayTriangle& triangle = triangles[i];
        const glm::dvec3 ab = triangle.b - triangle.a;
        const glm::dvec3 ac = triangle.c - triangle.a;
        const glm::dvec3 p = glm::cross(direction, ac);
        const double det = glm::dot(ab, p);
        if (det == 0) continue;
        const glm::dvec3 from_a = origin - triangle.a;
        const double v = glm::dot(from_a, p) / det;
        const glm::dvec3 q = glm::cross(from_a, ab);
        const double w = glm::dot(direction, q) / det;
        if (v < 0 || w < 0 || v + w > 1) continue;
        const double t = glm::dot(ac, q) / det;
        if (t < t_min || t > t_max || t >= best.t) continue;
        best = {t, static_cast<std::int64_t>(i)};
    }
    return best;
}

double closest_edge(std::span<const RayTriangle> triangles, const glm::dvec3& origin,
                    const glm::dvec3& direction) {
    const glm::dvec3 d = glm::normalize(direction);
    double closest = std::numeric_limits<double>::infinity();
    const auto edge = [&](const glm::dvec3& from, const glm::dvec3& to) {
        // The segment's place that is closest to the ray's line, by both as seen along the ray.
        const glm::dvec3 start = from - origin;
        const glm::dvec3 flat_start = start - glm::dot(start, d) * d;
        const glm::dvec3 way = to - from;
        const glm::dvec3 flat_way = way - glm::dot(way, d) * d;
        const double length = glm::dot(flat_way, flat_way);
        const double s =
            length > 0 ? std::clamp(-glm::dot(flat_start, flat_way) / length, 0.0, 1.0) : 0.0;
        const double along = glm::dot(start + s * way, d);
        if (along <= 0) return;
        closest = std::min(closest, glm::length(flat_start + s * flat_way) / along);
    };
    for (const RayTriangle& triangle : triangles) {
        edge(triangle.a, triangle.b);
        edge(triangle.b, triangle.c);
        edge(triangle.c, triangle.a);
    }
    return closest;
}

std::uint32_t morton_code_bit_by_bit(const std::array<float, 3>& place,
                                     const std::array<float, 3>& lo, const std::array<float, 3>& hi,
                                     bool longest_cell) {
    std::array<int, 30> axes{};
    std::array<int, 3> bits{};
    for (std::size_t i = 0; i < 30; ++i) {
        std::size_t axis = i % 3;
        if (longest_cell) {
            double longest = -1;
            for (std::size_t k = 0; k < 3; ++k) {
                const double edge = std::ldexp(double{hi[k] - lo[k]}, -bits[k]);
                if (edge > longest && bits[k] < 20) {
                    longest = edge;
                    axis = k;
                }
            }
        }
        axes[i] = static_cast<int>(axis);
        ++bits[axis];
    }
    std::array<std::uint32_t, 3> cell{};
    for (std::size_t k = 0; k < 3; ++k) {
        const float extent = hi[k] - lo[k];
        if (!(extent > 0)) continue;
        const float cells = std::ldexp(1.0f, bits[k]);
        const float number = (place[k] - lo[k]) * (cells * (1.0f / extent));
        cell[k] = static_cast<std::uint32_t>(std::clamp(number, 0.0f, cells - 1.0f));
    }
    std::uint32_t code = 0;
    for (const int axis : axes) {
        const auto k = static_cast<std::size_t>(axis);
        const std::uint32_t half = 1u << --bits[k];
        const bool upper = cell[k] >= half;
        if (upper) cell[k] -= half;
        code = 2 * code + (upper ? 1 : 0);
    }
    return code;
}

std::uint32_t morton_code_as_printed(const std::array<float, 3>& place,
                                     const std::array<float, 3>& lo,
                                     const std::array<float, 3>& hi) {
    std::uint32_t code = 0;
    std::array<std::uint32_t, 3> q{};
    for (std::size_t k = 0; k < 3; ++k) {
        const float scale = 1024.0f / (lo[k] - hi[k]);
        q[k] = static_cast<std::uint32_t>(static_cast<std::int32_t>((place[k] - lo[k]) * scale)) &
               1023u;
    }
    for (int bit = 9; bit >= 0; --bit) {
        for (const std::uint32_t number : q) code = 2 * code + ((number >> bit) & 1u);
    }
    return code;
}

double open_hemisphere(std::span<const RayTriangle> triangles, const glm::dvec3& place,
                       const glm::dvec3& normal, double reach, int rings, int sectors) {
    const glm::dvec3 other = std::abs(normal.x) < 0.9 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    const glm::dvec3 u = glm::normalize(glm::cross(normal, other));
    const glm::dvec3 v = glm::cross(normal, u);
    int open = 0;
    for (int ring = 0; ring < rings; ++ring) {
        // Equal shares of the disc below the hemisphere are equal shares of the cosine's weight.
        const double radius = std::sqrt((ring + 0.5) / rings);
        for (int sector = 0; sector < sectors; ++sector) {
            const double angle = 2 * std::numbers::pi * (sector + 0.5) / sectors;
            const glm::dvec3 d = radius * std::cos(angle) * u + radius * std::sin(angle) * v +
                                 std::sqrt(1 - radius * radius) * normal;
            open += first_triangle_on_ray(triangles, place, d, 1e-9, reach).triangle < 0;
        }
    }
    return open / double(rings * sectors);
}

}  // namespace kino::reference
