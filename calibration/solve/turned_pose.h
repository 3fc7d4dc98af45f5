#pragma once

#include <array>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include "base/pose.h"

namespace kino {

/// A Pose as the solver turns it: rotation vector (axis times angle, radians), then translation, m.
using TurnedPose = std::array<double, 6>;

[[nodiscard]] TurnedPose turned(const Pose& pose);
[[nodiscard]] Pose pose_of(const TurnedPose& pose);

/// Rotation matrix of a rotation vector (Rodrigues).
[[nodiscard]] glm::dmat3 rotation_of(const glm::dvec3& vector);
/// The right Jacobian of SO(3): R(w + d) = R(w) R(J d) to first order (Sola et al., "A micro Lie
/// theory", eq. 143).
[[nodiscard]] glm::dmat3 right_jacobian(const glm::dvec3& vector);

}  // namespace kino
