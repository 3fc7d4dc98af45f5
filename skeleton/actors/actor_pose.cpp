#include "skeleton/actors/actor_pose.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "skeleton/actors/actor_shape.h"

namespace kino {
namespace {

using glm::dmat3;
using glm::dvec3;

dvec3 unit(const dvec3& v, const dvec3& otherwise) {
    const double length = glm::length(v);
    return length > 1e-9 ? v / length : otherwise;
}

// Columns left, up, forward with `up` kept and `left` as near as it can be.
dmat3 frame_of(const dvec3& left, const dvec3& up) {
    const dvec3 y = unit(up, {0, 1, 0});
    const dvec3 across = left - y * glm::dot(left, y);
    const dvec3 any = std::abs(y.x) < 0.7 ? dvec3(1, 0, 0) : dvec3(0, 0, 1);
    const dvec3 x = unit(across, glm::normalize(any - y * glm::dot(any, y)));
    return {x, y, glm::cross(x, y)};
}

}  // namespace

ActorPose actor_pose(const PosedBody& body) {
    ActorPose pose;
    pose.pelvis = body.pelvis;
    pose.chest = body.chest;
    pose.head = body.head;
    const auto at = [&](Joint left, int side) {
        return body[static_cast<Joint>(static_cast<int>(left) + 4 * side)];
    };
    for (int side = 0; side < 2; ++side) {
        const auto i = static_cast<std::size_t>(side);
        const dvec3 shoulder = at(Joint::shoulder_left, side), elbow = at(Joint::elbow_left, side),
                    wrist = at(Joint::wrist_left, side), hip = at(Joint::hip_left, side),
                    knee = at(Joint::knee_left, side), ankle = at(Joint::ankle_left, side);
        pose.upper_arm[i] = glm::normalize(elbow - shoulder);
        pose.forearm[i] = glm::normalize(wrist - elbow);
        pose.hand[i] = body.hand[i][1];
        pose.hand_back[i] = body.hand[i][2];
        pose.thigh[i] = glm::normalize(knee - hip);
        pose.shin[i] = glm::normalize(ankle - knee);
        pose.foot[i] = body.foot[i];
        const dvec3 out = glm::transpose(body.chest) * (shoulder - body[Joint::shoulder_center]);
        pose.shrug_rad[i] = std::atan2(out.y, std::abs(out.x)) + 0.195;
    }
    pose.place_m = {body[Joint::hip_center].x, body[Joint::hip_center].z};
    return pose;
}

ActorPose actor_pose(const std::array<dvec3, kJointCount>& joint_m, double floor_m) {
    const auto at = [&](Joint j) { return joint_m[static_cast<std::size_t>(j)]; };
    ActorPose pose;
    const dvec3 hips = at(Joint::hip_left) - at(Joint::hip_right);
    const dvec3 shoulders = at(Joint::shoulder_left) - at(Joint::shoulder_right);
    const dvec3 lower = at(Joint::spine) - at(Joint::hip_center);
    const dvec3 upper = at(Joint::shoulder_center) - at(Joint::spine);
    // Each end of the trunk leans towards the whole: single joints of the spine are noisy.
    pose.pelvis = frame_of(hips, unit(lower, {0, 1, 0}) + 0.5 * unit(lower + upper, {0, 1, 0}));
    pose.chest = frame_of(shoulders, unit(upper, {0, 1, 0}) + 0.5 * unit(lower + upper, {0, 1, 0}));
    const dvec3 neck = at(Joint::head) - at(Joint::shoulder_center);
    pose.head = frame_of(pose.chest[0], unit(neck, pose.chest[1]) + 0.5 * pose.chest[1]);
    for (int side = 0; side < 2; ++side) {
        const auto i = static_cast<std::size_t>(side);
        const auto joint = [&](Joint left) {
            return at(static_cast<Joint>(static_cast<int>(left) + 4 * side));
        };
        const dvec3 down(0, -1, 0);
        pose.upper_arm[i] = unit(joint(Joint::elbow_left) - joint(Joint::shoulder_left), down);
        pose.forearm[i] =
            unit(joint(Joint::wrist_left) - joint(Joint::elbow_left), pose.upper_arm[i]);
        // Trackers' hands jump; half of the forearm steadies them.
        pose.hand[i] = unit(
            unit(joint(Joint::hand_left) - joint(Joint::wrist_left), dvec3(0)) + pose.forearm[i],
            pose.forearm[i]);
        const double raised = glm::dot(pose.upper_arm[i], pose.chest[1]);
        pose.shrug_rad[i] = 0.38 * smooth_step(-0.2, 1.0, raised);
        pose.hand_back[i] = dvec3(0);
        pose.thigh[i] = unit(joint(Joint::knee_left) - joint(Joint::hip_left), down);
        pose.shin[i] = unit(joint(Joint::ankle_left) - joint(Joint::knee_left), pose.thigh[i]);
        dvec3 toes = unit(joint(Joint::foot_left) - joint(Joint::ankle_left), pose.pelvis[2]);
        // The sole is flat on the floor, square to the shin high above it.
        const double height = joint(Joint::ankle_left).y - floor_m;
        const dvec3 flat = unit(dvec3(toes.x, 0, toes.z), pose.pelvis[2]);
        const dvec3 square = unit(toes - pose.shin[i] * glm::dot(toes, pose.shin[i]), flat);
        toes = unit(glm::mix(flat, square, smooth_step(0.12, 0.30, height)), flat);
        const dvec3 leg_up =
            glm::mix(dvec3(0, 1, 0), -pose.shin[i], smooth_step(0.12, 0.30, height));
        const dvec3 left = unit(glm::cross(leg_up, toes), pose.pelvis[0]);
        pose.foot[i] = {left, glm::cross(toes, left), toes};
    }
    pose.place_m = {at(Joint::hip_center).x, at(Joint::hip_center).z};
    return pose;
}

namespace {

template <class Change>
void change_all(ActorPose& pose, const Change& change) {
    for (dmat3* frame : {&pose.pelvis, &pose.chest, &pose.head, &pose.foot[0], &pose.foot[1]}) {
        for (int column = 0; column < 3; ++column) (*frame)[column] = change((*frame)[column]);
    }
    for (auto* pair :
         {&pose.upper_arm, &pose.forearm, &pose.hand, &pose.hand_back, &pose.thigh, &pose.shin}) {
        for (dvec3& v : *pair) v = change(v);
    }
    const dvec3 place = change({pose.place_m.x, 0, pose.place_m.y});
    pose.place_m = {place.x, place.z};
}

}  // namespace

ActorPose turned(const ActorPose& pose, double yaw_rad) {
    ActorPose out = pose;
    const double c = std::cos(yaw_rad), s = std::sin(yaw_rad);
    change_all(out,
               [c, s](const dvec3& v) { return dvec3(c * v.x + s * v.z, v.y, c * v.z - s * v.x); });
    return out;
}

ActorPose turned(const ActorPose& pose, const glm::dquat& rotation) {
    ActorPose out = pose;
    change_all(out, [&](const dvec3& v) { return rotation * v; });
    return out;
}

ActorPose mirrored(const ActorPose& pose) {
    ActorPose out = pose;
    change_all(out, [](const dvec3& v) { return dvec3(-v.x, v.y, v.z); });
    for (dmat3* frame : {&out.pelvis, &out.chest, &out.head, &out.foot[0], &out.foot[1]}) {
        (*frame)[0] = -(*frame)[0];
    }
    for (auto* pair :
         {&out.upper_arm, &out.forearm, &out.hand, &out.hand_back, &out.thigh, &out.shin}) {
        std::swap((*pair)[0], (*pair)[1]);
    }
    std::swap(out.foot[0], out.foot[1]);
    std::swap(out.shrug_rad[0], out.shrug_rad[1]);
    std::swap(out.curl[0], out.curl[1]);
    return out;
}

}  // namespace kino
