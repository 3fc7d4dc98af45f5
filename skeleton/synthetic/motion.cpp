#include "skeleton/synthetic/motion.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

namespace kino {
namespace {

using glm::dvec3;

constexpr double kTwoPi = 2 * std::numbers::pi;
constexpr dvec3 kX{1, 0, 0}, kY{0, 1, 0}, kZ{0, 0, 1};
const dvec3 kSpot{0, 0, -2.75};

// `cycles` whole turns a loop, so that everything built from it closes.
double wave(double t, int cycles, double phase = 0) {
    return std::sin(kTwoPi * cycles * t / kMotionPeriodS + phase);
}

double ease(double x) {
    x = std::clamp(x, 0.0, 1.0);
    return x * x * x * (x * (6 * x - 15) + 10);
}

// 0 before `from`, 1 from `from`+rise to `to`-rise, 0 after `to`.
double window(double t, double from, double to, double rise) {
    return ease((t - from) / rise) * ease((to - t) / rise);
}

glm::dquat turned(double rad, const dvec3& axis) {
    return glm::angleAxis(rad, axis);
}

BodyPose idle(double t) {
    BodyPose pose = standing_pose();
    pose.place_m = kSpot;
    const double sway = wave(t, 1), breath = wave(t, 3);
    pose.pelvis_m += dvec3(0.016 * sway, -0.006 - 0.004 * sway * sway, 0.006 * wave(t, 2));
    pose.pelvis = turned(0.025 * sway, kZ) * turned(0.03 * wave(t, 1, 0.7), kY);
    pose.spine = turned(0.03 + 0.010 * breath, kX) * turned(-0.03 * sway, kZ);
    pose.neck = turned(0.16 * wave(t, 1, 1.9) + 0.05 * wave(t, 2), kY) *
                turned(0.02 + 0.03 * wave(t, 2, 0.4), kX);
    for (int side = 0; side < 2; ++side) {
        ArmPose& arm = pose.arm[side];
        arm.shrug_rad = 0.012 * breath;
        arm.lower += dvec3(0.02 * breath, 0, 0.03 * wave(t, 2, side));
        arm.upper += dvec3(0, 0, 0.02 * wave(t, 1, 2.0 * side));
    }
    return pose;
}

// By way of a third pose, without a stop there: arms pass outwards, not through the chest.
BodyPose blend_past(const BodyPose& from, const BodyPose& past, const BodyPose& to, double w) {
    return blend(blend(from, past, w), blend(past, to, w), w);
}

BodyPose waving(double t) {
    BodyPose pose = idle(t);
    const double up = window(t, 0.7, 9.3, 1.3);
    const double swing = wave(t, 12) * window(t, 1.5, 8.5, 0.8);
    ArmPose raised;
    raised.upper = glm::normalize(dvec3(-0.86, 0.10, 0.30));
    raised.lower = glm::normalize(dvec3(-0.12 + 0.42 * swing, 1.0, 0.22));
    raised.hand = glm::normalize(dvec3(-0.10 + 0.62 * swing, 1.0, 0.10));
    raised.palm = dvec3(0, -0.05, 1);
    raised.shrug_rad = 0.22;
    BodyPose high = pose;
    high.arm[1] = raised;
    high.spine = pose.spine * turned(0.05, kZ);
    high.neck = turned(0.06 * swing - 0.04, kZ) * turned(-0.05, kX);
    BodyPose half_way = pose;
    half_way.arm[1] = {glm::normalize(dvec3(-0.85, -0.35, 0.40)),
                       glm::normalize(dvec3(-0.80, 0.10, 0.65)),
                       glm::normalize(dvec3(-0.80, 0.20, 0.55)), dvec3(0.2, -0.3, 1), 0.05};
    return blend_past(pose, half_way, high, up);
}

BodyPose swiping(double t) {
    BodyPose pose = idle(t);
    BodyPose ready = pose;
    // Twice a loop: out to the right, across to the left, and down.
    const double local = std::fmod(t, 5.0);
    const double up = window(local, 0.4, 4.4, 0.8);
    const double across = ease((local - 1.5) / 0.7);
    ArmPose& arm = ready.arm[1];
    arm.upper =
        glm::normalize(glm::mix(dvec3(-0.75, -0.45, 0.45), dvec3(0.05, -0.45, 0.85), across));
    arm.lower = glm::normalize(glm::mix(dvec3(-0.75, 0.25, 0.65), dvec3(0.85, 0.22, 0.55), across));
    arm.hand = glm::normalize(arm.lower + dvec3(-0.15 + 0.4 * across, 0.05, 0.05));
    arm.palm = glm::normalize(dvec3(0.6, -0.2, 0.3 - 0.6 * across));
    ready.spine = pose.spine * turned(-0.16 + 0.38 * across, kY);
    ready.neck = turned(0.10 - 0.28 * across, kY);
    return blend(pose, ready, up);
}

BodyPose raising(double t) {
    const BodyPose pose = idle(t);
    BodyPose high = pose;
    for (int side = 0; side < 2; ++side) {
        const double s = sign_of(side);
        ArmPose& arm = high.arm[side];
        arm.upper = glm::normalize(dvec3(s * 0.62, 0.80, 0.08));
        arm.lower = glm::normalize(dvec3(s * (0.02 + 0.05 * wave(t, 5)), 1, 0.10));
        arm.hand = glm::normalize(dvec3(s * 0.10, 1, 0.04));
        arm.palm = dvec3(-0.2 * s, 0, 1);
        arm.shrug_rad = 0.40;
    }
    BodyPose side_up = pose;
    for (int side = 0; side < 2; ++side) {
        const double s = sign_of(side);
        side_up.arm[side] = {glm::normalize(dvec3(s, -0.1, 0.15)),
                             glm::normalize(dvec3(s, 0.1, 0.3)), glm::normalize(dvec3(s, 0.1, 0.3)),
                             dvec3(0, -0.4, 1), 0.15};
    }
    const double up = window(t, 0.8, 9.2, 2.4);
    return blend_past(pose, side_up, high, up);
}

BodyPose pushing(double t) {
    const BodyPose pose = idle(t);
    BodyPose ready = pose, out = pose;
    for (int side = 0; side < 2; ++side) {
        const double s = sign_of(side);
        ready.arm[side] = {glm::normalize(dvec3(s * 0.42, -0.9, 0.05)),
                           glm::normalize(dvec3(s * -0.12, 0.62, 0.80)),
                           glm::normalize(dvec3(s * -0.05, 0.95, 0.45)), dvec3(0, -0.25, 1), 0};
        out.arm[side] = {glm::normalize(dvec3(s * 0.16, -0.20, 1)),
                         glm::normalize(dvec3(s * -0.02, 0.08, 1)),
                         glm::normalize(dvec3(0, 0.95, 0.45)), dvec3(0, -0.25, 1), 0};
    }
    out.spine = pose.spine * turned(0.10, kX);
    const double up = window(t, 0.4, 9.6, 1.2);
    double thrust = 0;
    for (const double start : {2.0, 4.2, 6.4}) thrust += window(t, start, start + 1.5, 0.5);
    return blend(pose, blend(ready, out, thrust), up);
}

}  // namespace

// Each foot is set at the path's place in the middle of its stance, and swings from there to the
// next.
BodyPose stepping_pose(double t, int strides, double lift_m,
                       const std::function<Placement(double)>& path) {
    BodyPose pose = idle(t);
    const double stride_s = kMotionPeriodS / strides;
    constexpr double kStance = 0.62;
    const Placement now = path(t);
    pose.place_m = now.place_m;
    pose.yaw_rad = now.yaw_rad;
    const glm::dquat to_person = turned(-now.yaw_rad, kY);
    for (int side = 0; side < 2; ++side) {
        const double s = sign_of(side);
        const double phase = t / stride_s + 0.5 * side;
        const double whole = std::floor(phase), part = phase - whole;
        const auto planted = [&](double stride) {
            return path((stride - 0.5 * side + kStance / 2) * stride_s);
        };
        const double swing = ease((part - kStance) / (1 - kStance));
        const Placement a = planted(whole), b = planted(whole + 1);
        const auto foot = [&](const Placement& p) {
            return p.place_m + turned(p.yaw_rad, kY) * dvec3(s * 0.095, 0.088, -0.03);
        };
        dvec3 ankle = to_person * (glm::mix(foot(a), foot(b), swing) - now.place_m);
        const double airborne = std::sin(std::numbers::pi * swing);
        ankle.y += lift_m * airborne;
        LegPose& leg = pose.leg[side];
        leg.ankle_m = ankle;
        const double yaw = glm::mix(a.yaw_rad, b.yaw_rad, swing) - now.yaw_rad;
        leg.toe_yaw_rad = s * yaw + 0.12;
        leg.toe_pitch_rad = lift_m * (4.5 * airborne * (1 - swing) - 1.5 * airborne * swing);
        // Arms swing against the legs.
        const double reach = std::clamp(-ankle.z * 0.9, -0.45, 0.45);
        ArmPose& arm = pose.arm[side];
        arm.upper = glm::normalize(dvec3(s * 0.15, -1, reach - 0.05));
        arm.lower = glm::normalize(dvec3(s * 0.03, -1, 1.1 * reach + 0.32));
        arm.hand = glm::normalize(dvec3(0, -1, 1.1 * reach + 0.35));
    }
    const double spread = std::abs(pose.leg[0].ankle_m.z - pose.leg[1].ankle_m.z);
    pose.pelvis_m.y = 0.950 - 0.10 * spread * spread;
    pose.pelvis_m.x = 0.014 * wave(t, strides);
    pose.pelvis = turned(0.18 * (pose.leg[0].ankle_m.z - pose.leg[1].ankle_m.z), -kY);
    pose.spine =
        turned(0.05, kX) * turned(0.26 * (pose.leg[0].ankle_m.z - pose.leg[1].ankle_m.z), kY);
    pose.neck = turned(0.1 * (pose.leg[1].ankle_m.z - pose.leg[0].ankle_m.z), kY);
    return pose;
}

namespace {

BodyPose walking(double t) {
    // A long ellipse behind the table, walked once a loop.
    return stepping_pose(t, 6, 0.10, [](double at) {
        const double a = kTwoPi * at / kMotionPeriodS;
        const dvec3 place(1.12 * std::sin(a), 0, -2.95 + 0.42 * std::cos(a));
        const dvec3 speed(1.12 * std::cos(a), 0, -0.42 * std::sin(a));
        // Unwound: the heading turns once per loop, and atan2 alone would jump.
        const double base = std::numbers::pi / 2 + a;
        const double yaw = std::atan2(speed.x, speed.z);
        return Placement{place, yaw + kTwoPi * std::round((base - yaw) / kTwoPi)};
    });
}

BodyPose turning(double t) {
    return stepping_pose(t, 8, 0.06, [](double at) {
        return Placement{kSpot, kTwoPi * at / kMotionPeriodS};
    });
}

BodyPose t_pose(double t) {
    BodyPose pose = idle(t);
    for (int side = 0; side < 2; ++side) {
        const double s = sign_of(side);
        pose.arm[side] = {dvec3(s, 0, 0), dvec3(s, 0, 0), dvec3(s, 0, 0), dvec3(0, -1, 0), 0.06};
    }
    return pose;
}

BodyPose squatting(double t) {
    const BodyPose pose = idle(t);
    BodyPose low = pose;
    low.pelvis_m = {0, 0.56, -0.20};
    low.pelvis = turned(0.42, kX);
    low.spine = turned(0.22, kX);
    low.neck = turned(-0.45, kX);
    for (int side = 0; side < 2; ++side) {
        const double s = sign_of(side);
        low.leg[side].ankle_m.x = s * 0.115;
        low.leg[side].knee_out = 0.45;
        low.arm[side] = {glm::normalize(dvec3(s * 0.12, 0.42, 1)),
                         glm::normalize(dvec3(s * -0.05, 0.50, 1)),
                         glm::normalize(dvec3(s * -0.05, 0.42, 1)), dvec3(0, -1, 0), 0};
    }
    const double down = 0.5 - 0.5 * std::cos(kTwoPi * 3 * t / kMotionPeriodS);
    return blend(pose, low, ease(down));
}

// 96 beats a minute, 16 beats a loop, four figures of four beats.
BodyPose dancing(double t) {
    constexpr int kBeats = 16;
    const double half = wave(t, kBeats / 2), bounce = 0.5 - 0.5 * wave(t, kBeats, kTwoPi / 4);
    BodyPose base = idle(t);
    base.pelvis_m = {0.075 * half, 0.925 - 0.035 * bounce, 0.01};
    base.pelvis = turned(-0.10 * half, kZ) * turned(0.16 * half, kY);
    base.spine =
        turned(0.05 + 0.03 * bounce, kX) * turned(0.15 * half, kZ) * turned(-0.20 * half, kY);
    base.neck = turned(-0.10 * half, kZ) * turned(0.05 * bounce, kX) * turned(0.14 * half, kY);
    base.yaw_rad = 0.30 * wave(t, 2);
    for (int side = 0; side < 2; ++side) {
        const double s = sign_of(side);
        const double lift = std::max(0.0, -s * half);
        LegPose& leg = base.leg[side];
        leg.ankle_m = {s * (0.15 - 0.02 * lift), 0.088 + 0.055 * lift * lift, -0.02 + 0.03 * lift};
        leg.toe_pitch_rad = 0.45 * lift * lift;
        leg.knee_out = 0.30;
    }

    BodyPose swing = base, sway = base, roll = base, point = base;
    for (int side = 0; side < 2; ++side) {
        const double s = sign_of(side), beat = s * half;
        swing.arm[side] = {glm::normalize(dvec3(s * 0.40, -1, 0.30 * beat)),
                           glm::normalize(dvec3(-0.15 * s + 0.30 * half, 0.25 + 0.2 * beat, 0.85)),
                           glm::normalize(dvec3(0.25 * half, 0.35, 0.85)), dvec3(-s, 0, 0), 0};
        sway.arm[side] = {glm::normalize(dvec3(s * 0.66 + 0.16 * half, 0.62, 0.22)),
                          glm::normalize(dvec3(s * 0.05 + 0.50 * half, 1, 0.15)),
                          glm::normalize(dvec3(0.70 * half, 1, 0.05)), dvec3(-0.2 * s, 0, 1), 0.33};
        const double angle = kTwoPi * kBeats / 2 * t / kMotionPeriodS + side * std::numbers::pi;
        roll.arm[side] = {glm::normalize(dvec3(s * 0.62, -0.62, 0.52)),
                          glm::normalize(dvec3(-0.80 * s, 0.25 + 0.42 * std::sin(angle),
                                               0.75 + 0.35 * std::cos(angle))),
                          glm::normalize(dvec3(-0.90 * s, 0.20 + 0.3 * std::sin(angle), 0.45)),
                          dvec3(0, -0.8, -0.4), 0.05};
    }
    // The right arm goes up to the left and comes down to the hip; the left rests on the hip.
    const double high = 0.5 + 0.5 * wave(t, 4, -kTwoPi / 4);
    point.arm[1] = {
        glm::normalize(glm::mix(dvec3(0.05, -0.75, 0.62), dvec3(-0.72, 0.72, 0.20), high)),
        glm::normalize(glm::mix(dvec3(0.75, -0.55, 0.42), dvec3(-0.62, 0.85, 0.12), high)),
        glm::normalize(glm::mix(dvec3(0.75, -0.60, 0.30), dvec3(-0.62, 0.85, 0.10), high)),
        dvec3(0.1, 0.2, 1), 0.30 * high};
    point.arm[0] = {glm::normalize(dvec3(0.80, -0.75, -0.28)),
                    glm::normalize(dvec3(-0.72, -0.62, 0.34)),
                    glm::normalize(dvec3(-0.75, -0.55, 0.25)), dvec3(-0.4, 0.2, -0.8), 0};
    point.neck = base.neck * turned(-0.15 * high, kX) * turned(-0.35 * high + 0.1, kY);

    BodyPose pose = blend(swing, sway, window(t, 2.0, 5.4, 0.8));
    pose = blend(pose, roll, window(t, 4.8, 7.6, 0.8));
    return blend(pose, point, window(t, 6.8, 9.9, 0.8));
}

}  // namespace

std::string_view motion_name(Motion motion) {
    switch (motion) {
        case Motion::dance:
            return "dance";
        case Motion::wave:
            return "wave";
        case Motion::swipe:
            return "swipe";
        case Motion::raise:
            return "raise";
        case Motion::push:
            return "push";
        case Motion::walk:
            return "walk";
        case Motion::turn:
            return "turn";
        case Motion::tpose:
            return "tpose";
        case Motion::squat:
            return "squat";
        case Motion::idle:
            return "idle";
    }
    return "unknown";
}

const std::vector<Motion>& all_motions() {
    static const std::vector<Motion> motions = {
        Motion::dance, Motion::wave, Motion::swipe, Motion::raise, Motion::push,
        Motion::walk,  Motion::turn, Motion::tpose, Motion::squat, Motion::idle};
    return motions;
}

std::optional<Motion> motion_from_name(std::string_view name) {
    for (const Motion motion : all_motions()) {
        if (motion_name(motion) == name) return motion;
    }
    return std::nullopt;
}

BodyPose pose_at(Motion motion, double t_s) {
    double t = std::fmod(t_s, kMotionPeriodS);
    if (t < 0) t += kMotionPeriodS;
    switch (motion) {
        case Motion::dance:
            return dancing(t);
        case Motion::wave:
            return waving(t);
        case Motion::swipe:
            return swiping(t);
        case Motion::raise:
            return raising(t);
        case Motion::push:
            return pushing(t);
        case Motion::walk:
            return walking(t);
        case Motion::turn:
            return turning(t);
        case Motion::tpose:
            return t_pose(t);
        case Motion::squat:
            return squatting(t);
        case Motion::idle:
            return idle(t);
    }
    return idle(t);
}

}  // namespace kino
