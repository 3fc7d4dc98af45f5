#include "apps/viewer/window_camera.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/trigonometric.hpp>

namespace kino {
namespace {

/// Part of the width that is drawn beyond each side, for deflection to move into the picture.
constexpr double kGuardPart = 0.03;
/// A slower eye moves a picture by less than a pixel between drawing and copying it.
constexpr double kAtRestMS = 0.02;

WindowEyeOptions eye_options(const SceneWindow& window) {
    // The sensor looks at the viewer: its right is the viewer's left, its down is down.
    const glm::dquat facing(0, 0, 0, 1);
    const glm::dquat tilt =
        glm::angleAxis(-glm::radians(window.sensor_tilt_deg), glm::dvec3(1, 0, 0));
    return {.screen_from_sensor = {glm::normalize(tilt * facing), window.sensor_m},
            .default_eye_m = window.eye_m};
}

DeflectForm form_of(SceneDeflect deflect) {
    switch (deflect) {
        case SceneDeflect::homography:
            return DeflectForm::homography;
        case SceneDeflect::depth_warp:
            return DeflectForm::depth_warp;
        case SceneDeflect::none:
        case SceneDeflect::pan:
            break;
    }
    return DeflectForm::pan;
}

}  // namespace

WindowCamera::WindowCamera(const SceneWindow& window)
    : window_(window), eye_(eye_options(window)) {}

void WindowCamera::see(TimeNs time, const BodyFrame* bodies) {
    if (bodies != nullptr) eye_.see(time, bodies->bodies);
}

View WindowCamera::view(const Pose& world_from_stage, TimeNs time, int width, int height) const {
    const Pose stage_from_window{
        glm::angleAxis(glm::radians(window_.turn_deg), glm::dvec3(0, 1, 0)), window_.at_m};
    return window_view(
        {.size_m = window_.size_m, .world_from_window = world_from_stage * stage_from_window},
        eye_.at(time), width, height);
}

std::optional<DeflectOptions> WindowCamera::deflection(const Pose& world_from_stage, TimeNs now,
                                                       int width, int height,
                                                       TimeNs (*clock)()) const {
    if (window_.deflect == SceneDeflect::none) return std::nullopt;
    if (glm::length(eye_.velocity_m_s(now)) < kAtRestMS) return std::nullopt;
    return DeflectOptions{
        .form = form_of(window_.deflect),
        .guard_px = static_cast<int>(std::ceil(kGuardPart * width)),
        // What stands out of the screen by half the eye's distance moves as far as the eye, the
        // other way; nothing moves more.
        .nearest_z_m = std::max(eye_.at(now).z, kNearestEyeM) / 2,
        .newest = [=, this] { return view(world_from_stage, clock(), width, height); }};
}

}  // namespace kino
