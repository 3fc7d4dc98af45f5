#include "apps/demo/turntable.h"

#include <glm/gtc/quaternion.hpp>
#include <numbers>

#include "apps/demo/easing.h"

namespace kino::demo {
namespace {

constexpr double kHandsEaseS = 0.1, kBackEaseS = 0.28, kPivotEaseS = 0.5, kAloneS = 1.6;
constexpr double kAloneYawRad = 0.42, kAloneRoundS = 46;
constexpr double kFromWallM = 0.25, kFromFloorM = 0.25;
constexpr double kNearestM = 0.6;
/// Hands turn by at most half a circle; that much of it is the stage's.
constexpr double kTurnPart = 1;

}  // namespace

void Turntable::hear(const GestureEvent& event, bool mirror) {
    if (!std::isfinite(event.value)) return;
    ease_s_ = kHandsEaseS;
    if (event.kind == GestureKind::rotate) {
        if (event.phase == GesturePhase::begin) yaw_from_ = yaw_to_;
        // In a mirror the stage turns as the hands do, seen from above.
        const double turn = (mirror ? 1 : -1) * kTurnPart * event.value;
        yaw_to_ = std::clamp(yaw_from_ + turn, -kMostYawRad, kMostYawRad);
    } else if (event.kind == GestureKind::zoom) {
        if (event.phase == GesturePhase::begin) zoom_from_ = zoom_to_;
        const double ratio = std::clamp(event.value, 0.1, 10.0);
        zoom_to_ = std::clamp(zoom_from_ / ratio, kLeastZoom, kMostZoom);
    }
}

void Turntable::let_go() {
    yaw_from_ = yaw_to_;
    zoom_from_ = zoom_to_;
}

void Turntable::straighten() {
    yaw_to_ = yaw_from_ = 0;
    zoom_to_ = zoom_from_ = 1;
    ease_s_ = kBackEaseS;
}

void Turntable::step(double dt_s, const std::optional<glm::dvec3>& pivot_m, bool nobody) {
    time_s_ = nobody ? time_s_ + dt_s : time_s_;
    const double part = eased(dt_s, ease_s_);
    yaw_ += part * (yaw_to_ - yaw_);
    zoom_ += part * (zoom_to_ - zoom_);
    approach(alone_, nobody ? 1 : 0, dt_s, kAloneS);
    if (!nobody && alone_ <= 0) time_s_ = 0;
    glm::dvec3 to = pivot_m.value_or(glm::dvec3(0));
    if (!is_finite(to)) to = glm::dvec3(0);
    const double far = glm::length(to);
    if (far > 2) to *= 2 / far;
    pivot_ += eased(dt_s, kPivotEaseS) * (glm::dvec3(to.x, 0, to.z) - pivot_);
}

Turntable::Look Turntable::look(const SceneCamera& camera, const RoomBox& room) const {
    const double round = 2 * std::numbers::pi * time_s_ / kAloneRoundS;
    const double yaw = yaw_ + smooth(alone_) * kAloneYawRad * std::sin(round);
    const glm::dquat turn = glm::angleAxis(yaw, glm::dvec3(0, 1, 0));
    Look look;
    look.target_m = pivot_ + turn * (camera.target_m - pivot_);
    glm::dvec3 back = turn * (camera.eye_m - camera.target_m);
    const double far = glm::length(back);
    back = far > 1e-6 ? back / far : glm::dvec3(0, 0, 1);
    double distance = std::max(far, 0.1) * zoom_;
    // Along the line of sight, until it is in the room.
    for (int k = 0; k < 3; ++k) {
        const double low = room.least_m[k] + (k == 1 ? kFromFloorM : kFromWallM);
        const double high = room.most_m[k] - kFromWallM;
        const double at = look.target_m[k] + distance * back[k];
        if (at > high && back[k] > 1e-6) distance = (high - look.target_m[k]) / back[k];
        if (at < low && back[k] < -1e-6) distance = (low - look.target_m[k]) / back[k];
    }
    look.eye_m = look.target_m + std::max(distance, kNearestM) * back;
    return look;
}

}  // namespace kino::demo
