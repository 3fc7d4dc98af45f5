#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/matrix.hpp>

#include "skeleton/actors/actor_pose.h"

namespace kino {
namespace {

using glm::dmat3;
using glm::dquat;
using glm::dvec3;

dvec3 across(const dvec3& v, const dvec3& along) {
    return v - along * glm::dot(v, along);
}

// The rotation of least angle that takes unit a to unit b.
dmat3 shortest(const dvec3& a, const dvec3& b) {
    const dvec3 axis = glm::cross(a, b);
    const double c = glm::dot(a, b);
    if (c < -0.9999) {
        const dvec3 any = std::abs(a.x) < 0.7 ? dvec3(1, 0, 0) : dvec3(0, 1, 0);
        return glm::mat3_cast(glm::angleAxis(M_PI, glm::normalize(across(any, a))));
    }
    const dmat3 k({0, axis.z, -axis.y}, {-axis.z, 0, axis.x}, {axis.y, -axis.x, 0});
    return dmat3(1) + k + k * k * (1 / (1 + c));
}

// Takes unit `from` to `to` and the part of `from_side` across it to that of `to_side`.
dmat3 aligned(const dvec3& from, const dvec3& from_side, const dvec3& to, const dvec3& to_side) {
    const auto frame = [](const dvec3& a, const dvec3& side) {
        const dvec3 n = glm::normalize(across(side, a));
        return dmat3(a, n, glm::cross(a, n));
    };
    return frame(to, to_side) * glm::transpose(frame(from, from_side));
}

dmat3 halfway(const dmat3& a, const dmat3& b, double w) {
    return glm::mat3_cast(glm::normalize(glm::slerp(glm::quat_cast(a), glm::quat_cast(b), w)));
}

dmat3 matrix_about(const dvec3& axis, double angle) {
    return glm::mat3_cast(glm::angleAxis(angle, glm::normalize(axis)));
}

// Of the base mesh: what the directions of a pose refer to.
struct Rest {
    dvec3 upper, fore, hand, hand_back, knuckles, arm_hinge;
    dvec3 thigh, shin, leg_hinge;
};

Rest find_rest(int side) {
    const BaseMesh& mesh = base_mesh();
    const auto joint = [&](Joint j) {
        return mesh.joint(static_cast<Joint>(static_cast<int>(j) + 4 * side));
    };
    const auto direction = [&](Joint a, Joint b) { return glm::normalize(joint(b) - joint(a)); };
    const double s = side == 0 ? 1 : -1;
    Rest r;
    r.upper = direction(Joint::shoulder_left, Joint::elbow_left);
    r.fore = direction(Joint::elbow_left, Joint::wrist_left);
    r.hand = direction(Joint::wrist_left, Joint::hand_left);
    r.arm_hinge = glm::normalize(glm::cross(r.upper, r.fore));
    const std::size_t thumb = bone_index(ActorBone::thumb, side);
    const dvec3 to_thumb =
        glm::normalize(across(mesh.head_m[thumb] - joint(Joint::wrist_left), r.hand));
    // Left hand: thumb x fingers looks out of the back of the hand.
    r.hand_back = glm::cross(to_thumb, r.hand) * s;
    r.knuckles = to_thumb;
    r.thigh = direction(Joint::hip_left, Joint::knee_left);
    r.shin = direction(Joint::knee_left, Joint::ankle_left);
    r.leg_hinge = dvec3(1, 0, 0);
    return r;
}

void pose_arm(const ActorPose& pose, int side, std::array<dmat3, kActorBoneCount>& turn) {
    static const std::array<Rest, 2> rests{find_rest(0), find_rest(1)};
    const Rest& rest = rests[static_cast<std::size_t>(side)];
    const auto i = static_cast<std::size_t>(side);
    const double s = side == 0 ? 1 : -1;
    const auto bone = [&](ActorBone b) -> dmat3& { return turn[bone_index(b, side)]; };
    const dvec3 upper = glm::normalize(pose.upper_arm[i]), fore = glm::normalize(pose.forearm[i]);
    bone(ActorBone::clavicle) = pose.chest * matrix_about({0, 0, 1}, s * pose.shrug_rad[i]);
    // The elbow's hinge where it is bent; where it is straight, the arm swung without twist.
    const dmat3 swung = pose.chest * shortest(rest.upper, glm::transpose(pose.chest) * upper);
    const dvec3 hinge = glm::cross(upper, fore) + 0.12 * across(swung * rest.arm_hinge, upper);
    const dmat3 full = aligned(rest.upper, rest.arm_hinge, upper, hinge);
    bone(ActorBone::upper_arm_high) = halfway(swung, full, 0.5);
    bone(ActorBone::upper_arm_low) = full;
    const dmat3 elbow = aligned(rest.fore, rest.arm_hinge, fore, full * rest.arm_hinge);
    bone(ActorBone::forearm_high) = elbow;
    const dvec3 fingers = glm::normalize(pose.hand[i]);
    const dmat3 neutral = shortest(elbow * rest.hand, fingers) * elbow;
    dvec3 back = across(pose.hand_back[i], fingers);
    if (glm::dot(back, back) < 1e-6) back = across(neutral * rest.hand_back, fingers);
    dmat3 hand = aligned(rest.hand, rest.hand_back, fingers, back);
    // Forearms turn the hand by at most some 100 degrees from the middle.
    const dvec3 neutral_back = across(neutral * rest.hand_back, fingers);
    const double twist =
        std::atan2(glm::dot(glm::cross(neutral_back, back), fingers), glm::dot(neutral_back, back));
    const double kept = std::clamp(twist, -1.75, 1.75);
    hand = matrix_about(fingers, kept - twist) * hand;
    bone(ActorBone::forearm_low) = matrix_about(fore, 0.6 * kept) * elbow;
    bone(ActorBone::hand) = hand;
    const double curl = pose.curl[i];
    // About the line of the knuckles, towards the palm.
    const auto bent = [&](double angle) {
        return hand * matrix_about(glm::cross(rest.hand, -rest.hand_back), angle);
    };
    bone(ActorBone::fingers) = bent(1.35 * curl);
    bone(ActorBone::finger_tips) = bent(1.35 * curl + 1.6 * curl);
    bone(ActorBone::thumb) = bent(0.5 * curl);
}

void pose_leg(const ActorPose& pose, int side, std::array<dmat3, kActorBoneCount>& turn) {
    static const std::array<Rest, 2> rests{find_rest(0), find_rest(1)};
    const Rest& rest = rests[static_cast<std::size_t>(side)];
    const auto i = static_cast<std::size_t>(side);
    const auto bone = [&](ActorBone b) -> dmat3& { return turn[bone_index(b, side)]; };
    const dvec3 thigh = glm::normalize(pose.thigh[i]), shin = glm::normalize(pose.shin[i]);
    const dmat3 swung = pose.pelvis * shortest(rest.thigh, glm::transpose(pose.pelvis) * thigh);
    const dvec3 hinge = glm::cross(thigh, shin) + 0.25 * across(swung * rest.leg_hinge, thigh) +
                        0.25 * across(pose.foot[i][0], thigh);
    const dvec3 safe = glm::dot(hinge, hinge) > 1e-6 ? hinge : swung * rest.leg_hinge;
    const dmat3 full = aligned(rest.thigh, rest.leg_hinge, thigh, safe);
    bone(ActorBone::thigh_high) = halfway(swung, full, 0.5);
    bone(ActorBone::thigh_low) = full;
    const dmat3 knee = aligned(rest.shin, rest.leg_hinge, shin, full * rest.leg_hinge);
    bone(ActorBone::shin_high) = knee;
    const dvec3 toe_side = across(pose.foot[i][0], shin);
    const dmat3 low = glm::dot(toe_side, toe_side) > 0.05
                          ? aligned(rest.shin, rest.leg_hinge, shin, toe_side)
                          : knee;
    bone(ActorBone::shin_low) = halfway(knee, low, 0.6);
    bone(ActorBone::foot) = pose.foot[i];
    bone(ActorBone::toes) = pose.foot[i];
}

}  // namespace

PosedBones pose_bones(const ActorBody& body, const ActorPose& pose) {
    PosedBones out;
    out.turn[bone_index(ActorBone::pelvis)] = pose.pelvis;
    out.turn[bone_index(ActorBone::waist)] = halfway(pose.pelvis, pose.chest, 0.5);
    out.turn[bone_index(ActorBone::chest)] = pose.chest;
    out.turn[bone_index(ActorBone::neck)] = halfway(pose.chest, pose.head, 0.5);
    out.turn[bone_index(ActorBone::head)] = pose.head;
    for (int side = 0; side < 2; ++side) {
        pose_arm(pose, side, out.turn);
        pose_leg(pose, side, out.turn);
    }
    const dvec3 hip_center(pose.place_m.x, 0, pose.place_m.y);
    out.place_m[0] = hip_center + pose.pelvis * (body.head_m[0] - body.joint(Joint::hip_center));
    for (std::size_t b = 1; b < kActorBoneCount; ++b) {
        const std::size_t up = kActorBoneParent[b];
        out.place_m[b] = out.place_m[up] + out.turn[up] * (body.head_m[b] - body.head_m[up]);
    }
    for (std::size_t j = 0; j < kJointCount; ++j) {
        const std::size_t b = bone_of_joint(static_cast<Joint>(j));
        out.joint_m[j] = out.place_m[b] + out.turn[b] * (body.joint_m[j] - body.head_m[b]);
    }
    return out;
}

void skin(const ActorBody& body, const PosedBones& bones, std::vector<glm::vec3>& out) {
    struct Move {
        glm::mat3 turn;
        glm::vec3 shift;
    };
    std::array<Move, kActorBoneCount> moves;
    for (std::size_t b = 0; b < kActorBoneCount; ++b) {
        moves[b] = {glm::mat3(bones.turn[b]),
                    glm::vec3(bones.place_m[b] - bones.turn[b] * body.head_m[b])};
    }
    out.resize(body.vertex_m.size());
    for (std::size_t i = 0; i < out.size(); ++i) {
        const BoneWeights& w = body.weights[i];
        const glm::vec3 p = body.vertex_m[i];
        glm::vec3 sum(0);
        for (std::size_t k = 0; k < 4 && w.weight[k] > 0; ++k) {
            const Move& m = moves[w.bone[k]];
            sum += w.weight[k] * (m.turn * p + m.shift);
        }
        out[i] = sum;
    }
}

PosedBones pose_actor(const ActorBody& body, const ActorPose& pose, std::vector<glm::vec3>& out) {
    PosedBones bones = pose_bones(body, pose);
    skin(body, bones, out);
    float lowest = 1e9f;
    for (const glm::vec3& p : out) lowest = std::min(lowest, p.y);
    const double up = pose.lift_m - static_cast<double>(lowest);
    for (glm::vec3& p : out) p.y += static_cast<float>(up);
    for (dvec3& p : bones.place_m) p.y += up;
    for (dvec3& p : bones.joint_m) p.y += up;
    return bones;
}

}  // namespace kino
