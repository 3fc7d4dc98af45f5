#include "skeleton/synthetic/performance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

namespace kino {
namespace {

using glm::dvec3;

constexpr int kLeft = 0, kRight = 1;
const dvec3 kMark{0, 0, -3.05};  ///< where the person performs
constexpr double kAsideM = 2.2;  ///< out of view from here on

// The course of things, s.
constexpr double kComes = 0.4, kThere = 3.4, kGoes = 42.8, kGone = 45.5;

double ease_between(double from, double to, double t) {
    const double x = std::clamp((t - from) / (to - from), 0.0, 1.0);
    return x * x * x * (x * (6 * x - 15) + 10);
}

/// 0 before `from` and after `to`, 1 between, changing during `rise` at either end.
double held_between(double from, double to, double rise, double t) {
    return ease_between(from, from + rise, t) - ease_between(to - rise, to, t);
}

/// A walk at an even pace with soft ends.
double walked(double from, double to, double t) {
    const double x = std::clamp((t - from) / (to - from), 0.0, 1.0);
    return x * x * (3 - 2 * x);
}

Placement path_at(double t) {
    constexpr double kSideways = -std::numbers::pi / 2;
    const double in = walked(kComes, kThere, t), out = walked(kGoes, kGone, t);
    Placement at;
    at.place_m = kMark + dvec3(kAsideM * (1 - in - out), 0, -0.1 * (1 - in) - 0.1 * out);
    at.yaw_rad = kSideways * (1 - ease_between(kThere - 0.9, kThere, t) +
                              ease_between(kGoes - 0.1, kGoes + 0.7, t));
    return at;
}

BodyPose on_their_feet(double t) {
    BodyPose standing = pose_at(Motion::idle, t);
    const Placement at = path_at(t);
    standing.place_m = at.place_m;
    standing.yaw_rad = at.yaw_rad;
    const double stands =
        ease_between(kThere - 0.1, kThere + 0.6, t) - ease_between(kGoes - 0.2, kGoes + 0.3, t);
    if (stands >= 1) return standing;
    return blend(stepping_pose(t, 9, 0.08, path_at), standing, stands);
}

BodyPose past(const BodyPose& from, const BodyPose& by, const BodyPose& to, double w) {
    return blend(blend(from, by, w), blend(by, to, w), w);
}

/// Arms pass outwards on their way up, not through the chest.
BodyPose arms_aside(BodyPose pose, bool left, bool right) {
    for (int side = 0; side < 2; ++side) {
        if (side == kLeft ? !left : !right) continue;
        const double s = sign_of(side);
        pose.arm[side] = {glm::normalize(dvec3(s, -0.3, 0.25)), glm::normalize(dvec3(s, 0.1, 0.4)),
                          glm::normalize(dvec3(s, 0.2, 0.4)), dvec3(-0.2 * s, -0.4, 1), 0.1};
    }
    return pose;
}

BodyPose wave(const BodyPose& rest, double from, double to, double t) {
    if (t <= from || t >= to) return rest;
    const double swing = std::sin(2 * std::numbers::pi * 1.3 * (t - from - 0.7)) *
                         held_between(from + 0.5, to - 0.4, 0.3, t);
    BodyPose up = rest;
    up.arm[kRight] = {glm::normalize(dvec3(-0.86, 0.10, 0.30)),
                      glm::normalize(dvec3(-0.12 + 0.42 * swing, 1.0, 0.22)),
                      glm::normalize(dvec3(-0.10 + 0.62 * swing, 1.0, 0.10)), dvec3(0, -0.05, 1),
                      0.22};
    return past(rest, arms_aside(rest, false, true), up, held_between(from, to, 0.7, t));
}

/// The hand goes to places in front of the person, so that its way is what is written here.
BodyPose reach(const BodyPose& rest, int side, const dvec3& wrist, double w) {
    BodyPose out = rest;
    out.arm[side] = arm_reaching(side, wrist);
    return blend(rest, out, w);
}

BodyPose paint(const BodyPose& rest, int side, double from, double to, double t) {
    if (t <= from || t >= to) return rest;
    const double turn = 2 * std::numbers::pi * (t - from) / 2.2, s = sign_of(side);
    const dvec3 wrist(s * (0.24 + 0.14 * std::sin(turn)), 0.28 + 0.13 * std::cos(turn), 0.40);
    return reach(rest, side, wrist, held_between(from, to, 0.6, t));
}

/// Up to one place, a short rest, a stroke to another, a rest, and down.
BodyPose stroke(const BodyPose& rest, int side, const dvec3& a, const dvec3& b, double from,
                double t) {
    constexpr double kUp = 0.75, kBegins = 1.05, kStroke = 0.35, kDown = 1.75, kEnd = 2.4;
    if (t <= from || t >= from + kEnd) return rest;
    const double done = ease_between(from + kBegins, from + kBegins + kStroke, t);
    const double up =
        ease_between(from, from + kUp, t) - ease_between(from + kDown, from + kEnd, t);
    return reach(rest, side, glm::mix(a, b, done), up);
}

/// Both hands in front: apart and together again, then turned and back.
BodyPose two_hands(const BodyPose& rest, double from, double t) {
    constexpr double kEnd = 5;
    if (t <= from || t >= from + kEnd) return rest;
    const double local = t - from;
    const double wide = ease_between(1.2, 1.9, local) - ease_between(2.0, 2.7, local);
    const double turn = 0.9 * (ease_between(2.8, 3.5, local) - ease_between(3.6, 4.2, local));
    const double half_m = 0.17 + 0.17 * wide;
    BodyPose out = rest;
    for (int side = 0; side < 2; ++side) {
        const double s = sign_of(side);
        out.arm[side] = arm_reaching(
            side, {s * half_m * std::cos(turn), 0.29 + s * half_m * std::sin(turn), 0.40});
    }
    return blend(rest, out, ease_between(0, 1.0, local) - ease_between(4.3, kEnd, local));
}

BodyPose raise(const BodyPose& rest, bool left, bool right, double from, double t) {
    constexpr double kEnd = 2.6;
    if (t <= from || t >= from + kEnd) return rest;
    BodyPose up = rest;
    for (int side = 0; side < 2; ++side) {
        if (side == kLeft ? !left : !right) continue;
        const double s = sign_of(side);
        up.arm[side] = {glm::normalize(dvec3(s * 0.45, 0.85, 0.12)),
                        glm::normalize(dvec3(s * 0.02, 1, 0.10)),
                        glm::normalize(dvec3(s * 0.04, 1, 0.06)), dvec3(-0.2 * s, 0, 1), 0.40};
    }
    return past(rest, arms_aside(rest, left, right), up, held_between(from, from + kEnd, 0.8, t));
}

BodyPose tee(const BodyPose& rest, double from, double t) {
    constexpr double kEnd = 2.7;
    if (t <= from || t >= from + kEnd) return rest;
    BodyPose out = rest;
    for (int side = 0; side < 2; ++side) {
        const double s = sign_of(side);
        out.arm[side] = {dvec3(s, 0, 0), dvec3(s, 0, 0), dvec3(s, 0, 0), dvec3(0, -1, 0), 0.06};
    }
    return blend(rest, out, held_between(from, from + kEnd, 0.7, t));
}

dvec3 mirrored(const dvec3& v) {
    return {-v.x, v.y, v.z};
}

BodyPose performed(double t) {
    // Wrists, chest frame; x to the person's left.
    const dvec3 across(0.10, 0.25, 0.40), out(-0.42, 0.25, 0.36);
    const dvec3 high(-0.18, 0.52, 0.38), low(-0.18, 0.06, 0.40);
    const dvec3 near(-0.20, 0.22, 0.20), far(-0.17, 0.28, 0.50);
    BodyPose pose = on_their_feet(t);
    pose = wave(pose, 3.9, 7.1, t);
    pose = paint(pose, kRight, 7.1, 9.7, t);
    pose = paint(pose, kLeft, 9.7, 12.3, t);
    pose = stroke(pose, kRight, out, across, 12.4, t);
    pose = stroke(pose, kLeft, mirrored(out), mirrored(across), 14.8, t);
    pose = stroke(pose, kRight, low, high, 17.2, t);
    pose = stroke(pose, kRight, high, low, 19.6, t);
    pose = stroke(pose, kRight, near, far, 22.0, t);
    pose = stroke(pose, kLeft, mirrored(near), mirrored(far), 24.4, t);
    pose = two_hands(pose, 26.8, t);
    pose = raise(pose, false, true, 31.9, t);
    pose = raise(pose, true, true, 34.5, t);
    pose = tee(pose, 37.2, t);
    return wave(pose, 39.9, 43.1, t);
}

// A stroke is told when the hand has come to rest, what is held after it was held for so long.
constexpr auto kScript = std::to_array<Cue>({
    {6.2, "wave", "once", "right"},
    {6.2, "engaged", "once", "right"},
    {13.9, "swipe-left", "once", "right"},
    {16.3, "swipe-right", "once", "left"},
    {18.7, "swipe-up", "once", "right"},
    {21.1, "swipe-down", "once", "right"},
    {23.5, "push", "once", "right"},
    {25.9, "push", "once", "left"},
    {28.4, "zoom", "begin", "both"},
    {30.0, "rotate", "begin", "both"},
    {31.4, "zoom", "end", "both"},
    {31.4, "rotate", "end", "both"},
    {33.2, "raise", "once", "right"},
    {35.8, "raise-both", "once", "both"},
    {38.8, "t-pose", "once", "both"},
    {42.2, "wave", "once", "right"},
    {47.3, "released", "once", "none"},
});

}  // namespace

std::span<const Cue> performance_script() {
    return kScript;
}

SyntheticScene make_performance(int width, int height) {
    SyntheticScene scene = make_scene(Motion::idle, width, height);
    // The hall is too large and its floor too deep for readings: what is seen is a carpet.
    scene.room = {.min_m = {-15, -20, -25}, .max_m = {15, 9, 12}};
    scene.furniture = {box(kMark + dvec3(0, -0.02, 0), {1.0, 0.02, 0.36}, kPartThing, Covering::red,
                           glm::dmat3(1))};
    scene.act = performed;
    scene.seconds = kPerformanceSeconds;
    scene.name = kPerformanceName;
    scene.world_from_depth =
        Pose{glm::dquat(1, 0, 0, 0), dvec3(0, 1.2, 0)} * world_from_camera_axes();
    scene.tells_joints = false;
    scene.rig.color.reset();
    scene.rig.max_depth_m = 3.5;
    return scene;
}

}  // namespace kino
