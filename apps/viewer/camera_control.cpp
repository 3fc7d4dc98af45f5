#include "apps/viewer/camera_control.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace kino {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kSteepest = 1.45;  ///< rad; short of looking straight along up

/// Unit vector of a heading: yaw 0 looks along +z, positive yaw turns to +x.
glm::dvec3 direction(double yaw, double pitch) {
    return {std::cos(pitch) * std::sin(yaw), std::sin(pitch), std::cos(pitch) * std::cos(yaw)};
}
double yaw_of(const glm::dvec3& d) {
    return std::atan2(d.x, d.z);
}
double pitch_of(const glm::dvec3& d) {
    return std::clamp(std::asin(std::clamp(d.y / glm::length(d), -1.0, 1.0)), -kSteepest,
                      kSteepest);
}

}  // namespace

const char* view_name(ViewKind kind) {
    switch (kind) {
        case ViewKind::sensor:
            return "sensor";
        case ViewKind::orbit:
            return "orbit";
        case ViewKind::fly:
            return "fly";
    }
    return "unknown";
}

void OrbitCamera::reset(const ScenePlace& place) {
    const glm::dvec3 back = place.world_from_depth.translation - place.center;
    target_ = place.center;
    distance_m_ = std::max(0.2, 1.12 * place.distance_m);
    yaw_ = yaw_of(back);
    // A little from above shows the floor and reads better than the sensor's own view.
    pitch_ = std::min(pitch_of(back) + 0.04, kSteepest);
    touched_ = false;
}

void OrbitCamera::turn(double yaw, double pitch) {
    hold_still();
    yaw_ += yaw;
    pitch_ = std::clamp(pitch_ + pitch, -kSteepest, kSteepest);
}

void OrbitCamera::pan(glm::dvec2 right_up) {
    hold_still();
    const Pose camera = pose();
    target_ += distance_m_ * (camera.rotation * glm::dvec3(right_up.x, -right_up.y, 0));
}

void OrbitCamera::zoom(double factor) {
    distance_m_ = std::clamp(distance_m_ * factor, 0.05, 100.0);
}

void OrbitCamera::follow(const glm::dvec3& center, double dt_s) {
    if (touched_) return;
    constexpr double kSecondsToFollow = 1.5;
    target_ += (center - target_) * (1 - std::exp(-std::max(0.0, dt_s) / kSecondsToFollow));
}

OrbitCamera::Angles OrbitCamera::swayed() const {
    if (touched_) return {yaw_, pitch_};
    const double yaw = yaw_ + 0.30 * std::sin(2 * kPi * time_s_ / 11.0);
    const double pitch = pitch_ + 0.05 * std::sin(2 * kPi * time_s_ / 7.3);
    return {yaw, std::clamp(pitch, -kSteepest, kSteepest)};
}

void OrbitCamera::hold_still() {
    const Angles now = swayed();
    yaw_ = now.yaw;
    pitch_ = now.pitch;
    touched_ = true;
}

Pose OrbitCamera::pose() const {
    const Angles now = swayed();
    return look_at(target_ + distance_m_ * direction(now.yaw, now.pitch), target_);
}

void FlyCamera::reset(const Pose& world_from_view) {
    const glm::dvec3 ahead = world_from_view.rotation * glm::dvec3(0, 0, 1);
    position_ = world_from_view.translation;
    yaw_ = yaw_of(ahead);
    pitch_ = pitch_of(ahead);
}

glm::dvec3 FlyCamera::forward() const {
    return direction(yaw_, pitch_);
}

void FlyCamera::look(double yaw, double pitch) {
    yaw_ += yaw;
    pitch_ = std::clamp(pitch_ + pitch, -kSteepest, kSteepest);
}

void FlyCamera::move(const glm::dvec3& right_up_forward) {
    const glm::dvec3 right = glm::normalize(glm::cross(forward(), glm::dvec3(0, 1, 0)));
    position_ += right_up_forward.x * right + right_up_forward.y * glm::dvec3(0, 1, 0) +
                 right_up_forward.z * forward();
}

Pose FlyCamera::pose() const {
    return look_at(position_, position_ + forward());
}

void CameraControl::reset(const ScenePlace& place) {
    orbit.reset(place);
    fly.reset(orbit.pose());
}

void CameraControl::choose(ViewKind wanted, const Pose& world_from_view) {
    if (wanted == ViewKind::fly && kind != ViewKind::fly) fly.reset(world_from_view);
    kind = wanted;
}

View CameraControl::view(const CameraModel& depth, const Pose& world_from_depth, int width,
                         int height) const {
    if (kind == ViewKind::sensor) return sensor_view(depth, world_from_depth, width, height);
    const double sensor_fov = 2 * std::atan(0.5 * depth.height / depth.fy);
    const double fov = std::clamp(sensor_fov, 40 * kPi / 180, 62 * kPi / 180);
    return {.width = width,
            .height = height,
            .projection = perspective(fov, width, height),
            .world_from_view = kind == ViewKind::fly ? fly.pose() : orbit.pose()};
}

}  // namespace kino
