#pragma once

#include <glm/gtc/quaternion.hpp>
#include <glm/vec3.hpp>

namespace kino {

/// Rotations as retargeting needs them, in double. All are defined for every finite input.

/// Unit vector along `v`; `otherwise` where v is shorter than 1e-9 or not finite.
[[nodiscard]] glm::dvec3 unit_or(const glm::dvec3& v, const glm::dvec3& otherwise);

/// A unit vector across the unit vector `axis`: the part of `wish` that is, or else of a coordinate
/// axis, always the same one.
[[nodiscard]] glm::dvec3 across(const glm::dvec3& axis, const glm::dvec3& wish);

/// The smallest rotation that takes the unit vector `from` to `to`. Where they are opposite (to
/// 1e-7) the axis is across(from, `axis`).
[[nodiscard]] glm::dquat shortest_arc(const glm::dvec3& from, const glm::dvec3& to,
                                      const glm::dvec3& axis);

/// Angle of a rotation, 0 .. pi.
[[nodiscard]] double angle_of(const glm::dquat& q);

/// `from` turned towards `to`, the short way, by at most `angle_rad`.
[[nodiscard]] glm::dquat turn_towards(const glm::dquat& from, const glm::dquat& to,
                                      double angle_rad);

/// Spherical interpolation the short way; w in 0 .. 1. Opposite quaternions are one rotation.
[[nodiscard]] glm::dquat mix_turns(const glm::dquat& a, const glm::dquat& b, double w);

/// The unit vector `v`, brought within `angle_rad` of the unit vector `axis` along the great
/// circle.
[[nodiscard]] glm::dvec3 within_cone(const glm::dvec3& v, const glm::dvec3& axis, double angle_rad);

/// The rotation whose columns are x across y, the unit vector `y`, and their cross product, where x
/// is the part of `x_wish` across y.
[[nodiscard]] glm::dquat frame_of(const glm::dvec3& y, const glm::dvec3& x_wish);

/// Signed angle about the unit vector `axis` from `a` to `b`, both taken across it; 0 where one has
/// no such part.
[[nodiscard]] double angle_about(const glm::dvec3& axis, const glm::dvec3& a, const glm::dvec3& b);

/// 0 below `low`, 1 above `high`, smooth between.
[[nodiscard]] double ease_between(double low, double high, double v);

}  // namespace kino
