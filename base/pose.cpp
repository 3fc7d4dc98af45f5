#include "base/pose.h"

#include <cmath>

namespace kino {

glm::dmat4 Pose::matrix() const {
    glm::dmat4 m = glm::mat4_cast(rotation);
    m[3] = glm::dvec4(translation, 1.0);
    return m;
}

Pose operator*(const Pose& a_from_b, const Pose& b_from_c) {
    // Renormalised at each step, so a chain of a million poses stays a rotation.
    return {glm::normalize(a_from_b.rotation * b_from_c.rotation),
            a_from_b.rotation * b_from_c.translation + a_from_b.translation};
}

Pose inverse(const Pose& a_from_b) {
    const glm::dquat back = glm::conjugate(a_from_b.rotation);
    return {back, back * -a_from_b.translation};
}

Pose interpolate(const Pose& from, const Pose& to, double t) {
    return {glm::normalize(glm::slerp(from.rotation, to.rotation, t)),
            glm::mix(from.translation, to.translation, t)};
}

bool is_valid(const Pose& pose) {
    const double length = glm::dot(pose.rotation, pose.rotation);
    const glm::dvec3& t = pose.translation;
    return std::isfinite(length) && std::abs(length - 1.0) < 1e-6 && std::isfinite(t.x) &&
           std::isfinite(t.y) && std::isfinite(t.z);
}

Pose world_from_camera_axes() {
    return {glm::dquat(0, 1, 0, 0), glm::dvec3(0)};
}

}  // namespace kino
