#include "apps/avatar/turns.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>

namespace kino {

glm::dvec3 unit_or(const glm::dvec3& v, const glm::dvec3& otherwise) {
    const double length = glm::length(v);
    return length > 1e-9 && std::isfinite(length) ? v / length : otherwise;
}

glm::dvec3 across(const glm::dvec3& axis, const glm::dvec3& wish) {
    const glm::dvec3 part = wish - axis * glm::dot(axis, wish);
    if (glm::dot(part, part) > 1e-12) return glm::normalize(part);
    glm::dvec3 other(0);
    // The coordinate axis that `axis` has least of.
    const glm::dvec3 size = glm::abs(axis);
    other[size.x <= size.y && size.x <= size.z ? 0 : (size.y <= size.z ? 1 : 2)] = 1;
    return glm::normalize(other - axis * glm::dot(axis, other));
}

glm::dquat shortest_arc(const glm::dvec3& from, const glm::dvec3& to, const glm::dvec3& axis) {
    const double cosine = glm::dot(from, to);
    if (cosine < -1 + 1e-14) {
        const glm::dvec3 n = across(from, axis);
        return {0, n.x, n.y, n.z};
    }
    // Half-angle form: (1 + cos, sin * axis) is twice cos(half) times the unit quaternion.
    const glm::dvec3 n = glm::cross(from, to);
    const glm::dquat q(1 + cosine, n.x, n.y, n.z);
    return q * (1 / glm::length(q));
}

double angle_of(const glm::dquat& q) {
    return 2 * std::atan2(glm::length(glm::dvec3(q.x, q.y, q.z)), std::abs(q.w));
}

glm::dquat mix_turns(const glm::dquat& a, const glm::dquat& b, double w) {
    glm::dquat delta = b * glm::conjugate(a);
    if (delta.w < 0) delta = -delta;
    const glm::dvec3 v(delta.x, delta.y, delta.z);
    const double sine = glm::length(v);
    if (sine < 1e-12) return w < 0.5 ? a : b;
    const double half = std::atan2(sine, delta.w) * w;
    const glm::dvec3 n = v * (std::sin(half) / sine);
    const glm::dquat q = glm::dquat(std::cos(half), n.x, n.y, n.z) * a;
    return q * (1 / glm::length(q));
}

glm::dquat turn_towards(const glm::dquat& from, const glm::dquat& to, double angle_rad) {
    const double angle = angle_of(to * glm::conjugate(from));
    if (angle <= angle_rad) return to;
    return mix_turns(from, to, std::max(angle_rad, 0.0) / angle);
}

glm::dvec3 within_cone(const glm::dvec3& v, const glm::dvec3& axis, double angle_rad) {
    if (glm::dot(v, axis) >= std::cos(angle_rad)) return v;
    return axis * std::cos(angle_rad) + across(axis, v) * std::sin(angle_rad);
}

glm::dquat frame_of(const glm::dvec3& y, const glm::dvec3& x_wish) {
    const glm::dvec3 x = across(y, x_wish);
    const glm::dquat q = glm::quat_cast(glm::dmat3(x, y, glm::cross(x, y)));
    return q * (1 / glm::length(q));
}

double angle_about(const glm::dvec3& axis, const glm::dvec3& a, const glm::dvec3& b) {
    const glm::dvec3 u = a - axis * glm::dot(axis, a);
    const glm::dvec3 v = b - axis * glm::dot(axis, b);
    if (!(glm::dot(u, u) > 1e-12) || !(glm::dot(v, v) > 1e-12)) return 0;
    return std::atan2(glm::dot(axis, glm::cross(u, v)), glm::dot(u, v));
}

double ease_between(double low, double high, double v) {
    const double t = std::clamp((v - low) / (high - low), 0.0, 1.0);
    return t * t * (3 - 2 * t);
}

}  // namespace kino
