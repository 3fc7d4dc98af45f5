#include "skeleton/actors/pose_library.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "skeleton/synthetic/body_model.h"

namespace kino {
namespace {

using glm::dvec3;

constexpr dvec3 kX{1, 0, 0}, kY{0, 1, 0}, kZ{0, 0, 1};
constexpr double kUpperArm = 0.285, kForearm = 0.250;

glm::dquat about(const dvec3& axis, double rad) {
    return glm::angleAxis(rad, axis);
}

// Chest frame with its origin in the joint `spine`, metres; left arm, x is turned for the right.
dvec3 shoulder_of(int side) {
    return {sign_of(side) * 0.178, 0.305, -0.015};
}

dvec3 random_direction(ActorRandom& random) {
    const double z = random.in(-1, 1), a = random.in(0, 2 * M_PI), r = std::sqrt(1 - z * z);
    return {r * std::cos(a), r * std::sin(a), z};
}

// Inside the trunk or the head, where no arm can be.
bool inside_body(const dvec3& p) {
    const dvec3 trunk = (p - dvec3(0, 0.10, 0)) / dvec3(0.185, 0.30, 0.125);
    const dvec3 head = (p - dvec3(0, 0.53, 0.03)) / dvec3(0.095, 0.13, 0.115);
    return glm::dot(trunk, trunk) < 1 || glm::dot(head, head) < 1;
}

bool clear_of_body(int side, const ArmPose& arm) {
    const dvec3 shoulder = shoulder_of(side), elbow = shoulder + arm.upper * kUpperArm,
                wrist = elbow + arm.lower * kForearm;
    for (int i = 1; i <= 4; ++i) {
        if (i > 1 && inside_body(glm::mix(shoulder, elbow, i / 4.0))) return false;
        if (inside_body(glm::mix(elbow, wrist, i / 4.0))) return false;
    }
    return !inside_body(wrist + arm.hand * 0.10);
}

void random_hand(ActorRandom& random, int side, ArmPose& arm) {
    arm.hand = glm::normalize(arm.lower + 0.45 * random.unit() * random_direction(random));
    // Palms look inwards or down more than anywhere else.
    arm.palm = glm::normalize(dvec3(-sign_of(side), -0.3, -0.2) + 1.3 * random_direction(random));
}

// The elbow swivels round the line from shoulder to wrist to where it is wished.
ArmPose bent_to(int side, const dvec3& wrist, const dvec3& wish) {
    const dvec3 line = wrist - shoulder_of(side);
    const double d = std::clamp(glm::length(line), 0.09, kUpperArm + kForearm - 0.003);
    const dvec3 along = glm::normalize(line);
    dvec3 across = wish - along * glm::dot(wish, along);
    across = glm::dot(across, across) > 1e-6 ? glm::normalize(across) : kZ;
    const double a = (d * d + kUpperArm * kUpperArm - kForearm * kForearm) / (2 * d);
    const double h = std::sqrt(std::max(0.0, kUpperArm * kUpperArm - a * a));
    ArmPose arm;
    arm.upper = glm::normalize(along * a + across * h);
    arm.lower = glm::normalize(along * d - arm.upper * kUpperArm);
    arm.shrug_rad = 0.35 * std::clamp(arm.upper.y + 0.3, 0.0, 1.0);
    return arm;
}

// Elbows like to hang, outwards.
dvec3 elbow_wish(int side) {
    return {0.55 * sign_of(side), -0.8, -0.25};
}

ArmPose reach(ActorRandom& random, int side, const dvec3& wrist) {
    const dvec3 wish = elbow_wish(side) + 0.6 * random_direction(random);
    ArmPose arm = bent_to(side, wrist, wish);
    random_hand(random, side, arm);
    return arm;
}

ArmPose hanging(ActorRandom& random, int side) {
    const double s = sign_of(side);
    ArmPose arm;
    arm.upper = glm::normalize(dvec3(s * random.in(0.10, 0.38), -1, random.normal(-0.03, 0.14)));
    arm.lower = glm::normalize(dvec3(s * random.normal(0.05, 0.08), -1, random.in(-0.02, 0.5)));
    random_hand(random, side, arm);
    arm.palm = glm::normalize(dvec3(-s, 0, random.normal(-0.3, 0.4)));
    return arm;
}

// A wrist anywhere an arm gets to: an elbow direction within the shoulder's range and a bend.
ArmPose anywhere(ActorRandom& random, int side) {
    const double s = sign_of(side);
    for (;;) {
        const dvec3 upper = random_direction(random);
        // Not far behind the back, not far across the chest.
        if (s * upper.x < -0.45 || upper.z < -0.55 || (upper.z < -0.2 && upper.y > 0.3)) continue;
        ArmPose arm;
        arm.upper = upper;
        const dvec3 hinge = random_direction(random);
        const dvec3 bend = hinge - upper * glm::dot(hinge, upper);
        if (glm::dot(bend, bend) < 0.05) continue;
        const double flex = 2.4 * std::pow(random.unit(), 1.3);
        arm.lower = glm::normalize(upper * std::cos(flex) + glm::normalize(bend) * std::sin(flex));
        // Elbows do not open backwards: the forearm bends forwards, inwards or up.
        if (arm.lower.z < upper.z - 0.35 && arm.lower.y < upper.y + 0.2) continue;
        random_hand(random, side, arm);
        arm.shrug_rad = 0.38 * std::clamp(upper.y + 0.3, 0.0, 1.0);
        return arm;
    }
}

ArmPose at_place(ActorRandom& random, int side, const dvec3& place, double spread) {
    const dvec3 jitter(random.normal(0, spread), random.normal(0, spread),
                       random.normal(0, spread));
    return reach(random, side, place * dvec3(sign_of(side), 1, 1) + jitter);
}

ArmPose one_arm(ActorRandom& random, int side) {
    const double kind = random.unit();
    if (kind < 0.24) return hanging(random, side);
    if (kind < 0.52) return anywhere(random, side);
    if (kind < 0.62) {  // forwards, to the camera
        return at_place(random, side, {random.in(-0.10, 0.45), random.in(0.0, 0.55), 0.48}, 0.06);
    }
    if (kind < 0.70) {  // up
        return at_place(random, side,
                        {random.in(0.0, 0.40), random.in(0.62, 0.85), random.in(-0.05, 0.3)}, 0.04);
    }
    if (kind < 0.76) return at_place(random, side, {0.245, -0.05, 0.03}, 0.03);  // at the hip
    if (kind < 0.82) {                                                           // at the head
        return at_place(random, side,
                        {random.in(0.03, 0.16), random.in(0.42, 0.62), random.in(0.06, 0.18)},
                        0.02);
    }
    if (kind < 0.88) {  // before the chest
        return at_place(random, side,
                        {random.in(-0.18, 0.2), random.in(-0.05, 0.35), random.in(0.18, 0.35)},
                        0.03);
    }
    if (kind < 0.94) {  // sideways
        return at_place(random, side, {0.68, random.in(0.05, 0.55), random.in(-0.1, 0.25)}, 0.05);
    }
    return at_place(random, side, {random.in(0.0, 0.22), random.in(-0.12, 0.05), -0.16},
                    0.03);  // behind
}

void both_arms(ActorRandom& random, BodyPose& pose) {
    const double kind = random.unit();
    const auto symmetric = [&](const dvec3& place, double spread) {
        for (int side = 0; side < 2; ++side) pose.arm[side] = at_place(random, side, place, spread);
    };
    if (kind < 0.25) {  // crossed before the chest
        const int over = random.chance(0.5) ? 1 : 0;
        for (int side = 0; side < 2; ++side) {
            const double front = side == over ? 0.205 : 0.155;
            pose.arm[side] =
                at_place(random, side, {-0.10, 0.14 + (side == over ? 0.03 : -0.02), front}, 0.015);
        }
    } else if (kind < 0.40) {
        symmetric({0.05, random.in(-0.1, 0.25), random.in(0.2, 0.42)}, 0.02);  // hands together
    } else if (kind < 0.52) {
        symmetric({0.245, -0.05, 0.02}, 0.02);  // hips
    } else if (kind < 0.62) {
        symmetric({0.12, 0.56, -0.04}, 0.02);  // behind the head
    } else if (kind < 0.74) {
        symmetric({random.in(0.12, 0.35), random.in(0.65, 0.85), 0.05}, 0.03);  // up
    } else if (kind < 0.86) {
        symmetric({random.in(0.1, 0.3), random.in(0.15, 0.4), 0.47}, 0.03);  // pushing, holding
    } else {
        for (int side = 0; side < 2; ++side) {  // like a T, more or less
            const double s = sign_of(side);
            pose.arm[side].upper =
                glm::normalize(dvec3(s, random.normal(0, 0.15), random.normal(0.05, 0.12)));
            pose.arm[side].lower =
                glm::normalize(dvec3(s, random.normal(0.05, 0.2), random.normal(0.1, 0.15)));
            random_hand(random, side, pose.arm[side]);
            pose.arm[side].shrug_rad = 0.08;
        }
    }
}

void legs_for(ActorRandom& random, Stance stance, BodyPose& pose) {
    const double drop = random.unit() * random.unit() * 0.05;
    pose.pelvis_m.y = 0.955 - drop;
    for (int side = 0; side < 2; ++side) {
        const double s = sign_of(side);
        LegPose& leg = pose.leg[side];
        leg.ankle_m = {s * (0.06 + 0.22 * random.unit() * random.unit()), 0.088,
                       random.normal(-0.02, 0.05)};
        leg.toe_yaw_rad = random.normal(0.22, 0.18);
        leg.knee_out = random.in(0.05, 0.35);
    }
    pose.pelvis_m.x = random.normal(0, 0.02);
    if (stance == Stance::stepping) {
        const double stride = random.in(0.1, 0.38);
        const int front = random.chance(0.5) ? 1 : 0;
        pose.leg[front].ankle_m.z += stride;
        pose.leg[1 - front].ankle_m.z -= stride;
        pose.leg[1 - front].toe_pitch_rad = random.in(0, 0.7);
        pose.pelvis_m.y -= 0.35 * stride * stride + 0.02;
        const double kind = random.unit();
        if (kind < 0.35) {  // a foot in the air
            LegPose& leg = pose.leg[front];
            leg.ankle_m = {sign_of(front) * random.in(0.05, 0.35), random.in(0.15, 0.55),
                           random.in(-0.3, 0.5)};
            leg.toe_pitch_rad = random.in(-0.2, 0.6);
            pose.leg[1 - front].ankle_m.z = 0;
        } else if (kind < 0.6) {  // wide
            for (int side = 0; side < 2; ++side) {
                pose.leg[side].ankle_m = {sign_of(side) * random.in(0.2, 0.45), 0.088,
                                          random.normal(0, 0.06)};
            }
            pose.pelvis_m.y -= random.in(0.04, 0.12);
        }
    }
    if (stance == Stance::sitting) {
        pose.pelvis_m = {0, random.in(0.44, 0.60), 0};
        const double apart = random.in(0.06, 0.25);
        for (int side = 0; side < 2; ++side) {
            LegPose& leg = pose.leg[side];
            leg.ankle_m = {sign_of(side) * apart + random.normal(0, 0.04), 0.088,
                           random.in(0.25, 0.70)};
            leg.knee_out = random.in(0.0, 0.5);
        }
        if (random.chance(0.12)) {  // one leg over the other
            const int over = random.chance(0.5) ? 1 : 0;
            pose.leg[over].ankle_m = {-sign_of(over) * random.in(0.1, 0.25), random.in(0.30, 0.50),
                                      0.62};
            pose.leg[over].toe_pitch_rad = 0.3;
        }
    }
    if (stance == Stance::crouching) {
        const double low = random.in(0.30, 0.75);
        pose.pelvis_m = {random.normal(0, 0.03), low, -0.35 * (0.95 - low)};
        for (int side = 0; side < 2; ++side) {
            pose.leg[side].knee_out = random.in(0.1, 0.9);
            pose.leg[side].ankle_m.x = sign_of(side) * random.in(0.08, 0.25);
        }
        if (random.chance(0.4)) {  // on one knee, nearly
            const int back = random.chance(0.5) ? 1 : 0;
            pose.leg[back].ankle_m.z -= 0.4;
            pose.leg[back].toe_pitch_rad = 1.0;
            pose.leg[1 - back].ankle_m.z += 0.2;
        }
    }
}

void trunk_for(ActorRandom& random, Stance stance, BodyPose& pose) {
    pose.pelvis = about(kZ, random.normal(0, 0.05)) * about(kX, random.normal(0, 0.05)) *
                  about(kY, random.normal(0, 0.10));
    double lean = random.normal(0.05, 0.10);
    if (stance == Stance::sitting) {
        lean = random.normal(0.02, 0.20);
        pose.pelvis = pose.pelvis * about(kX, random.normal(-0.12, 0.12));
    }
    if (stance == Stance::crouching) {
        lean = random.in(0.1, 0.7);
        pose.pelvis = pose.pelvis * about(kX, random.in(0.1, 0.5));
    }
    if (stance == Stance::bending) {
        const double bend = random.in(0.3, 1.5);
        lean = 0.45 * bend;
        pose.pelvis = pose.pelvis * about(kX, 0.55 * bend);
        pose.pelvis_m.z -= 0.12 * bend;
        pose.pelvis_m.y -= 0.05 * bend;
    }
    pose.spine = about(kX, std::clamp(lean, -0.4, 1.1)) * about(kZ, random.normal(0, 0.12)) *
                 about(kY, random.normal(0, 0.22));
}

}  // namespace

ArmPose arm_to(int side, const dvec3& wrist_m) {
    ArmPose arm = bent_to(side, wrist_m, elbow_wish(side));
    arm.hand = arm.lower;
    arm.palm = {-0.3 * sign_of(side), -0.2, 1};
    return arm;
}

void change_upper_body(ActorRandom& random, BodyPose& pose) {
    pose.neck = about(kY, std::clamp(random.normal(0, 0.40), -1.2, 1.2)) *
                about(kX, std::clamp(random.normal(0.02, 0.22), -0.6, 0.7)) *
                about(kZ, std::clamp(random.normal(0, 0.12), -0.5, 0.5));
    if (random.chance(0.27)) {
        both_arms(random, pose);
        return;
    }
    for (int side = 0; side < 2; ++side) {
        for (int attempt = 0; attempt < 30; ++attempt) {
            pose.arm[side] = one_arm(random, side);
            if (clear_of_body(side, pose.arm[side])) break;
            if (attempt == 29) pose.arm[side] = hanging(random, side);
        }
    }
}

BodyPose random_pose(ActorRandom& random, Stance stance) {
    BodyPose pose = standing_pose();
    legs_for(random, stance, pose);
    trunk_for(random, stance, pose);
    change_upper_body(random, pose);
    return pose;
}

Stance random_stance(ActorRandom& random) {
    const double kind = random.unit();
    return kind < 0.55   ? Stance::standing
           : kind < 0.70 ? Stance::stepping
           : kind < 0.88 ? Stance::sitting
           : kind < 0.94 ? Stance::crouching
                         : Stance::bending;
}

}  // namespace kino
