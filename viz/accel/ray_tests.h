#pragma once

#include <cmath>
#include <cstdint>
#include <glm/vec3.hpp>
#include <utility>

#include "viz/accel/traverse.h"

namespace kino {

/// A ray as the two tests want it. viz/accel/ray_tests.glsl does the same operations in the same
/// order.
struct PreparedRay {
    explicit PreparedRay(const Ray& from) : ray(from) {
        const glm::vec3 d = from.direction;
        const glm::vec3 size(std::abs(d.x), std::abs(d.y), std::abs(d.z));
        // Axes are renamed so that the ray runs mostly along z, then sheared onto z.
        kz = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
        kx = kz == 2 ? 0 : kz + 1;
        ky = kx == 2 ? 0 : kx + 1;
        if (d[kz] < 0) std::swap(kx, ky);
        const float inverse_z = 1.0f / d[kz];
        shear = glm::vec3(d[kx] * inverse_z, d[ky] * inverse_z, inverse_z);
        inverse = glm::vec3(1.0f / d.x, 1.0f / d.y, 1.0f / d.z);
        negative = (std::signbit(d.x) ? 1u : 0u) | (std::signbit(d.y) ? 2u : 0u) |
                   (std::signbit(d.z) ? 4u : 0u);
        const float sum = d.x + d.y + d.z + from.origin.x + from.origin.y + from.origin.z;
        valid = std::isfinite(sum) && size[kz] > 0 && std::isfinite(shear.z) &&
                from.t_min <= from.t_max;
    }
    Ray ray;
    int kx, ky, kz;
    glm::vec3 shear;
    glm::vec3 inverse;       ///< of the direction; infinite where a component is 0
    std::uint32_t negative;  ///< bit k: the direction's component k has the sign
    bool valid;
};

/// How much farther than the best hit a box is still looked into: the hit's distance is rounded,
/// too, and of hits at one distance the smallest triangle must be found.
constexpr float kBestSlack = 1.000002f;

/// True where the ray is in the box somewhere in [t_min, best]. 0 * infinity, which an origin on a
/// slab's plane makes of a ray parallel to it, is NaN and leaves the interval as it is: the
/// comparisons are written so that NaN fails them. The exit is widened by the rounding that the
/// three operations before it may have (Ize 2013, "Robust BVH Ray Traversal").
inline bool meets_box(const PreparedRay& r, const glm::vec3& lo, const glm::vec3& hi, float best,
                      float& enter) {
    constexpr float kWider = 1.00000036f;  // 1 + 2 gamma(3)
    enter = r.ray.t_min;
    float exit = best * kBestSlack;
    for (int k = 0; k < 3; ++k) {
        const bool negative = ((r.negative >> k) & 1u) != 0;
        const float near = ((negative ? hi[k] : lo[k]) - r.ray.origin[k]) * r.inverse[k];
        const float far = (((negative ? lo[k] : hi[k]) - r.ray.origin[k]) * r.inverse[k]) * kWider;
        enter = near > enter ? near : enter;
        exit = far < exit ? far : exit;
    }
    return enter <= exit;
}

/// Watertight test of Woop, Benthin and Wald (2013): edges that two triangles share are met by at
/// least one of them. The ray is sheared onto z; the signs of three edge functions decide, in
/// double where one of them is 0. Keeps the nearer of `best` and this triangle.
inline void meet_triangle(const PreparedRay& r, const shared::BvhTriangle& triangle, RayHit& best) {
    const glm::vec3 a = triangle.a - r.ray.origin;
    const glm::vec3 b = triangle.b - r.ray.origin;
    const glm::vec3 c = triangle.c - r.ray.origin;
    const float ax = a[r.kx] - r.shear.x * a[r.kz];
    const float ay = a[r.ky] - r.shear.y * a[r.kz];
    const float bx = b[r.kx] - r.shear.x * b[r.kz];
    const float by = b[r.ky] - r.shear.y * b[r.kz];
    const float cx = c[r.kx] - r.shear.x * c[r.kz];
    const float cy = c[r.ky] - r.shear.y * c[r.kz];
    float u = cx * by - cy * bx;
    float v = ax * cy - ay * cx;
    float w = bx * ay - by * ax;
    // Products of two floats are exact in double, so the signs are.
    const auto exact = [](float p, float q, float r2, float s) {
        return static_cast<float>(double{p} * double{q} - double{r2} * double{s});
    };
    if (u == 0) u = exact(cx, by, cy, bx);
    if (v == 0) v = exact(ax, cy, ay, cx);
    if (w == 0) w = exact(bx, ay, by, ax);
    if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) return;
    const float det = u + v + w;
    if (det == 0) return;
    const float az = r.shear.z * a[r.kz];
    const float bz = r.shear.z * b[r.kz];
    const float cz = r.shear.z * c[r.kz];
    const float scale = 1.0f / det;
    const float t = (u * az + v * bz + w * cz) * scale;
    if (!(t >= r.ray.t_min && t <= r.ray.t_max && t <= best.t)) return;
    if ((t == best.t && triangle.id >= best.triangle) || triangle.id == r.ray.skip) return;
    best.t = t;
    best.triangle = triangle.id;
    best.v = v * scale;
    best.w = w * scale;
}

}  // namespace kino
