#include "calibration/solve/turned_pose.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

namespace kino {
namespace {

// Column-major, as GLM has it.
glm::dmat3 cross_matrix(const glm::dvec3& v) {
    return {0, v.z, -v.y, -v.z, 0, v.x, v.y, -v.x, 0};
}

constexpr double kSmall = 1e-4;  // where the series are exact to the last bit and the forms are not

}  // namespace

TurnedPose turned(const Pose& pose) {
    glm::dquat q = pose.rotation;
    if (q.w < 0) q = -q;
    const glm::dvec3 axis(q.x, q.y, q.z);
    const double sine = glm::length(axis);
    const double factor = sine < 1e-12 ? 2.0 : 2 * std::atan2(sine, q.w) / sine;
    const glm::dvec3 w = axis * factor;
    const glm::dvec3& t = pose.translation;
    return {w.x, w.y, w.z, t.x, t.y, t.z};
}

Pose pose_of(const TurnedPose& pose) {
    const glm::dvec3 w(pose[0], pose[1], pose[2]);
    const double angle = glm::length(w);
    const double half = angle < kSmall ? 0.5 - angle * angle / 48 : std::sin(angle / 2) / angle;
    const glm::dquat q(std::cos(angle / 2), half * w.x, half * w.y, half * w.z);
    return {glm::normalize(q), {pose[3], pose[4], pose[5]}};
}

glm::dmat3 rotation_of(const glm::dvec3& w) {
    const double s = glm::dot(w, w);
    const double angle = std::sqrt(s);
    const double a = angle < kSmall ? 1 - s / 6 : std::sin(angle) / angle;
    const double b = angle < kSmall ? 0.5 - s / 24 : (1 - std::cos(angle)) / s;
    const glm::dmat3 k = cross_matrix(w);
    return glm::dmat3(1) + a * k + b * (k * k);
}

glm::dmat3 right_jacobian(const glm::dvec3& w) {
    const double s = glm::dot(w, w);
    const double angle = std::sqrt(s);
    const double b = angle < kSmall ? 0.5 - s / 24 : (1 - std::cos(angle)) / s;
    const double c = angle < kSmall ? 1.0 / 6 - s / 120 : (angle - std::sin(angle)) / (s * angle);
    const glm::dmat3 k = cross_matrix(w);
    return glm::dmat3(1) - b * k + c * (k * k);
}

}  // namespace kino
