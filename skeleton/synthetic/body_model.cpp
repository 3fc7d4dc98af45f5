#include "skeleton/synthetic/body_model.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace kino {
namespace {

using glm::dmat3;
using glm::dquat;
using glm::dvec3;

constexpr double kSpineUp = 0.13, kChestUp = 0.34, kHeadUp = 0.19;
constexpr double kShoulderOut = 0.178, kShoulderDown = 0.035;
constexpr double kHipOut = 0.092, kHipDown = 0.05;
constexpr double kUpperArm = 0.285, kForearm = 0.250, kHand = 0.085;
constexpr double kThigh = 0.425, kShin = 0.410;
constexpr double kToes = 0.13, kToesDown = 0.050;

dvec3 nlerp(const dvec3& a, const dvec3& b, double w) {
    const dvec3 v = glm::mix(a, b, w);
    return glm::dot(v, v) > 1e-12 ? glm::normalize(v) : b;
}

struct Leg {
    dvec3 knee, ankle;
};

// Law of cosines: the knee lies on the circle round the line hip-ankle, on the side of `bend`.
Leg reach(const dvec3& hip, const dvec3& wanted, const dvec3& bend) {
    const dvec3 line = wanted - hip;
    const double distance =
        std::clamp(glm::length(line), std::abs(kThigh - kShin) + 0.02, kThigh + kShin - 1e-4);
    const dvec3 along = glm::dot(line, line) > 1e-12 ? glm::normalize(line) : dvec3(0, -1, 0);
    const dvec3 across = glm::normalize(bend - along * glm::dot(bend, along));
    const double a = (distance * distance + kThigh * kThigh - kShin * kShin) / (2 * distance);
    const double h = std::sqrt(std::max(0.0, kThigh * kThigh - a * a));
    return {hip + along * a + across * h, hip + along * distance};
}

}  // namespace

BodyPose standing_pose() {
    BodyPose pose;
    pose.spine = glm::angleAxis(0.03, dvec3(1, 0, 0));
    for (int side = 0; side < 2; ++side) {
        const double s = sign_of(side);
        pose.arm[side].upper = glm::normalize(dvec3(s * 0.17, -1, -0.05));
        pose.arm[side].lower = glm::normalize(dvec3(s * 0.06, -1, 0.20));
        pose.arm[side].hand = glm::normalize(dvec3(s * -0.02, -1, 0.22));
        pose.arm[side].palm = glm::normalize(dvec3(-s, 0, -0.35));
        pose.leg[side].ankle_m = dvec3(s * 0.115, 0.088, -0.02);
        pose.leg[side].toe_yaw_rad = 0.22;
    }
    return pose;
}

ArmPose arm_reaching(int side, const dvec3& wrist_m) {
    const double s = sign_of(side);
    const dvec3 line = wrist_m - dvec3(s * kShoulderOut, kChestUp - kShoulderDown, -0.015);
    const double d = std::clamp(glm::length(line), 0.09, kUpperArm + kForearm - 0.003);
    const dvec3 along = glm::normalize(line);
    const dvec3 hanging(0.55 * s, -0.8, -0.25);
    const dvec3 across = glm::normalize(hanging - along * glm::dot(hanging, along));
    // Law of cosines: the elbow lies on the circle round the line from shoulder to wrist.
    const double a = (d * d + kUpperArm * kUpperArm - kForearm * kForearm) / (2 * d);
    const double h = std::sqrt(std::max(0.0, kUpperArm * kUpperArm - a * a));
    ArmPose arm;
    arm.upper = glm::normalize(along * a + across * h);
    arm.lower = glm::normalize(along * d - arm.upper * kUpperArm);
    arm.hand = arm.lower;
    arm.palm = {-0.3 * s, -0.2, 1};
    arm.shrug_rad = 0.35 * std::clamp(arm.upper.y + 0.3, 0.0, 1.0);
    return arm;
}

BodyPose blend(const BodyPose& from, const BodyPose& to, double w) {
    BodyPose pose;
    pose.place_m = glm::mix(from.place_m, to.place_m, w);
    pose.yaw_rad = glm::mix(from.yaw_rad, to.yaw_rad, w);
    pose.pelvis_m = glm::mix(from.pelvis_m, to.pelvis_m, w);
    pose.pelvis = glm::slerp(from.pelvis, to.pelvis, w);
    pose.spine = glm::slerp(from.spine, to.spine, w);
    pose.neck = glm::slerp(from.neck, to.neck, w);
    for (std::size_t side = 0; side < 2; ++side) {
        const ArmPose &a = from.arm[side], &b = to.arm[side];
        pose.arm[side] = {nlerp(a.upper, b.upper, w), nlerp(a.lower, b.lower, w),
                          nlerp(a.hand, b.hand, w), nlerp(a.palm, b.palm, w),
                          glm::mix(a.shrug_rad, b.shrug_rad, w)};
        const LegPose &c = from.leg[side], &d = to.leg[side];
        pose.leg[side] = {
            glm::mix(c.ankle_m, d.ankle_m, w), glm::mix(c.toe_yaw_rad, d.toe_yaw_rad, w),
            glm::mix(c.toe_pitch_rad, d.toe_pitch_rad, w), glm::mix(c.knee_out, d.knee_out, w)};
    }
    return pose;
}

PosedBody pose_body(const BodyPose& pose) {
    PosedBody body;
    const dquat facing = glm::angleAxis(pose.yaw_rad, dvec3(0, 1, 0));
    const auto joint = [&body](Joint j) -> dvec3& {
        return body.joint_m[static_cast<std::size_t>(j)];
    };
    const dquat pelvis = facing * pose.pelvis;
    const dquat half_spine = glm::slerp(dquat(1, 0, 0, 0), pose.spine, 0.5);
    const dquat waist = pelvis * half_spine;
    const dquat chest = pelvis * pose.spine;
    const dquat head = chest * pose.neck;
    body.pelvis = glm::mat3_cast(pelvis);
    body.waist = glm::mat3_cast(waist);
    body.chest = glm::mat3_cast(chest);
    body.head = glm::mat3_cast(head);

    joint(Joint::hip_center) = pose.place_m + facing * pose.pelvis_m;
    joint(Joint::spine) = body[Joint::hip_center] + body.pelvis * dvec3(0, kSpineUp, 0);
    joint(Joint::shoulder_center) = body[Joint::spine] + body.chest * dvec3(0, kChestUp, -0.01);
    const dquat neck = chest * glm::slerp(dquat(1, 0, 0, 0), pose.neck, 0.6);
    joint(Joint::head) = body[Joint::shoulder_center] + neck * dvec3(0, kHeadUp, 0.02);

    for (int side = 0; side < 2; ++side) {
        const double s = sign_of(side);
        const auto of_side = [side](Joint left) {
            return static_cast<Joint>(static_cast<int>(left) + 4 * side);
        };
        const ArmPose& arm = pose.arm[side];
        const dquat lift = glm::angleAxis(s * arm.shrug_rad, dvec3(0, 0, 1));
        joint(of_side(Joint::shoulder_left)) =
            body[Joint::shoulder_center] +
            body.chest * (lift * dvec3(s * kShoulderOut, -kShoulderDown, -0.005));
        joint(of_side(Joint::elbow_left)) = body[of_side(Joint::shoulder_left)] +
                                            body.chest * glm::normalize(arm.upper) * kUpperArm;
        joint(of_side(Joint::wrist_left)) =
            body[of_side(Joint::elbow_left)] + body.chest * glm::normalize(arm.lower) * kForearm;
        joint(of_side(Joint::hand_left)) =
            body[of_side(Joint::wrist_left)] + body.chest * glm::normalize(arm.hand) * kHand;
        const dvec3 fingers = glm::normalize(body.chest * arm.hand);
        dvec3 back = -(body.chest * arm.palm);
        back -= fingers * glm::dot(back, fingers);
        if (glm::dot(back, back) < 1e-8) {  // palm along the fingers says nothing: take any side
            back = glm::cross(fingers, dvec3(0.3, 0.5, 0.8));
        }
        back = glm::normalize(back);
        // The thumb: for the left hand hanging with its palm inwards it points forward.
        body.hand[side] = dmat3(glm::cross(fingers, back) * s, fingers, back);

        const LegPose& leg = pose.leg[side];
        const dvec3 hip = body[Joint::hip_center] + body.pelvis * dvec3(s * kHipOut, -kHipDown, 0);
        const dquat foot_yaw = facing * glm::angleAxis(s * leg.toe_yaw_rad, dvec3(0, 1, 0));
        const dvec3 bend = foot_yaw * glm::normalize(dvec3(s * leg.knee_out, 0.15, 1));
        const Leg reached = reach(hip, pose.place_m + facing * leg.ankle_m, bend);
        joint(of_side(Joint::hip_left)) = hip;
        joint(of_side(Joint::knee_left)) = reached.knee;
        joint(of_side(Joint::ankle_left)) = reached.ankle;
        body.foot[side] =
            glm::mat3_cast(foot_yaw * glm::angleAxis(leg.toe_pitch_rad, dvec3(1, 0, 0)));
        joint(of_side(Joint::foot_left)) =
            reached.ankle + body.foot[side] * dvec3(0, -kToesDown, kToes);
    }
    return body;
}

}  // namespace kino
