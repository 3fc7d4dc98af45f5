#include "skeleton/synthetic/primitive.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "base/check.h"

namespace kino {
namespace {

glm::dvec3 any_orthogonal(const glm::dvec3& unit) {
    const glm::dvec3 other = std::abs(unit.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 0, 1);
    return glm::normalize(other - unit * glm::dot(unit, other));
}

}  // namespace

Primitive round_cone(const glm::dvec3& a, const glm::dvec3& b, double radius_a, double radius_b,
                     PartId part, Covering material) {
    return flat_cone(a, b, radius_a, radius_b, glm::dvec3(1, 0, 0), 1, 1, part, material);
}

Primitive flat_cone(const glm::dvec3& a, const glm::dvec3& b, double radius_a, double radius_b,
                    const glm::dvec3& side, double wide, double deep, PartId part,
                    Covering material) {
    KINO_CHECK(radius_a > 0 && radius_b > 0 && wide > 0 && deep > 0);
    Primitive p;
    p.part = part;
    p.material = material;
    const double length = glm::length(b - a);
    const bool nested = !(length > std::abs(radius_a - radius_b) + 1e-9);
    const glm::dvec3 y = length > 1e-9 ? (b - a) / length : glm::dvec3(0, 1, 0);
    glm::dvec3 x = side - y * glm::dot(side, y);
    x = glm::dot(x, x) > 1e-12 ? glm::normalize(x) : any_orthogonal(y);
    p.axes = glm::dmat3(x * wide, y, glm::cross(x, y) * deep);
    p.origin_m = nested && radius_b > radius_a ? b : a;
    p.height = nested ? 0 : length;
    p.radius_a = nested ? std::max(radius_a, radius_b) : radius_a;
    p.radius_b = nested ? p.radius_a : radius_b;
    return p;
}

Primitive ellipsoid(const glm::dvec3& center, const glm::dmat3& rotation, const glm::dvec3& radii,
                    PartId part, Covering material) {
    KINO_CHECK(radii.x > 0 && radii.y > 0 && radii.z > 0);
    Primitive p;
    p.part = part;
    p.material = material;
    p.origin_m = center;
    p.axes = glm::dmat3(rotation[0] * radii.x, rotation[1] * radii.y, rotation[2] * radii.z);
    p.radius_a = p.radius_b = 1;
    return p;
}

Primitive box(const glm::dvec3& center, const glm::dvec3& half, PartId part, Covering material,
              const glm::dmat3& rotation) {
    KINO_CHECK(half.x > 0 && half.y > 0 && half.z > 0);
    Primitive p;
    p.kind = Primitive::Kind::box;
    p.part = part;
    p.material = material;
    p.origin_m = center;
    p.axes = rotation;
    p.half = half;
    return p;
}

}  // namespace kino
