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
/// A camera is as thick as this; the way to it is looked at in such steps.
constexpr double kEyeM = 0.24, kMarchM = 0.08;
constexpr double kTurnedRad = 0.02;
/// It comes nearer and goes farther with these time constants.
constexpr double kNearerS = 0.07, kFartherS = 0.5;
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

void Turntable::step(double dt_s, const std::optional<glm::dvec3>& pivot_m, bool nobody,
                     const Around& around) {
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
    // Where it is going counts now, so that it is out of the way when it comes there.
    const double yaw = yaw_ + wandering_yaw();
    const double here = free_part(yaw, around);
    const double there = std::min(free_part(yaw + 0.5 * (yaw_to_ - yaw_), around),
                                  free_part(yaw + yaw_to_ - yaw_, around));
    const double free = std::min(here, there);
    part_ += eased(dt_s, free < part_ ? kNearerS : kFartherS) * (free - part_);
    part_ = std::min(part_, here);
}

double Turntable::wandering_yaw() const {
    const double round = 2 * std::numbers::pi * time_s_ / kAloneRoundS;
    return smooth(alone_) * kAloneYawRad * std::sin(round);
}

double Turntable::free_part(double yaw_rad, const Around& around) const {
    if (std::abs(yaw_rad) < kTurnedRad) return 1;
    const Look look = look_at_yaw(yaw_rad, around.camera, around.room);
    const Look straight = look_at_yaw(0, around.camera, around.room);
    const double whole = glm::distance(look.eye_m, look.target_m);
    const glm::dvec3 back = (look.eye_m - look.target_m) / whole;
    const glm::dvec3 back_straight = glm::normalize(straight.eye_m - straight.target_m);
    for (double way = kNearestM; way < whole; way += kMarchM) {
        for (const Solid& solid : around.solids) {
            // Walls are the room's; and what a scene's own camera looks past may stay.
            if (solid.kind == SolidKind::half_space || solid.kind == SolidKind::sheet) continue;
            if (!touch(solid, look.target_m + way * back, kEyeM)) continue;
            if (touch(solid, straight.target_m + way * back_straight, kEyeM)) continue;
            return std::min(1.0, std::max(kNearestM, way - kMarchM) / whole);
        }
    }
    return 1;
}

Turntable::Look Turntable::look(const SceneCamera& camera, const RoomBox& room) const {
    Look look = look_at_yaw(yaw_ + wandering_yaw(), camera, room);
    look.eye_m = look.target_m + part_ * (look.eye_m - look.target_m);
    return look;
}

Turntable::Look Turntable::look_at_yaw(double yaw_rad, const SceneCamera& camera,
                                       const RoomBox& room) const {
    const glm::dquat turn = glm::angleAxis(yaw_rad, glm::dvec3(0, 1, 0));
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
