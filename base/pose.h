#pragma once

#include <glm/gtc/quaternion.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

namespace kino {

/// A rigid transform, p_a = rotation * p_b + translation, named `a_from_b`. World poses compose
/// in double; the GPU gets camera-relative float. Invariant: |rotation| = 1 within 1e-9.
struct Pose {
    glm::dquat rotation{1, 0, 0, 0};  ///< w, x, y, z
    glm::dvec3 translation{0, 0, 0};  ///< metres

    [[nodiscard]] glm::dvec3 operator*(const glm::dvec3& p) const {
        return rotation * p + translation;
    }
    [[nodiscard]] glm::dmat4 matrix() const;
    friend bool operator==(const Pose&, const Pose&) = default;
};

/// (a_from_b) * (b_from_c) = a_from_c.
[[nodiscard]] Pose operator*(const Pose& a_from_b, const Pose& b_from_c);
[[nodiscard]] Pose inverse(const Pose& a_from_b);

/// Spherical linear rotation and linear translation; t in [0, 1]. Takes the short way round.
[[nodiscard]] Pose interpolate(const Pose& from, const Pose& to, double t);

/// False where a component is not finite or the rotation is not of unit length (1e-6).
[[nodiscard]] bool is_valid(const Pose& pose);

/// Rotation by 180 degrees about x, the literal diag(1,-1,-1): camera axes (y down, z forward) to
/// world axes (y up, z towards the viewer) where nothing better is known. Handedness is kept.
[[nodiscard]] Pose world_from_camera_axes();

}  // namespace kino
