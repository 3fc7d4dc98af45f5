#include "skeleton/motion/joint_layouts.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <initializer_list>

namespace kino {
namespace {

using J = Joint;

/// Where each of the 20 lies in the 25.
constexpr std::array<Joint25, kJointCount> kIn25 = {
    Joint25::spine_base,     Joint25::spine_mid,   Joint25::spine_shoulder, Joint25::head,
    Joint25::shoulder_left,  Joint25::elbow_left,  Joint25::wrist_left,     Joint25::hand_left,
    Joint25::shoulder_right, Joint25::elbow_right, Joint25::wrist_right,    Joint25::hand_right,
    Joint25::hip_left,       Joint25::knee_left,   Joint25::ankle_left,     Joint25::foot_left,
    Joint25::hip_right,      Joint25::knee_right,  Joint25::ankle_right,    Joint25::foot_right};

/// And in the 32.
constexpr std::array<Joint32, kJointCount> kIn32 = {
    Joint32::pelvis,         Joint32::spine_navel, Joint32::neck,        Joint32::head,
    Joint32::shoulder_left,  Joint32::elbow_left,  Joint32::wrist_left,  Joint32::hand_left,
    Joint32::shoulder_right, Joint32::elbow_right, Joint32::wrist_right, Joint32::hand_right,
    Joint32::hip_left,       Joint32::knee_left,   Joint32::ankle_left,  Joint32::foot_left,
    Joint32::hip_right,      Joint32::knee_right,  Joint32::ankle_right, Joint32::foot_right};

constexpr float kNeckShare = 0.4F;      // of the way from the shoulder centre to the head
constexpr float kClavicleShare = 0.2F;  // from the shoulder centre to the shoulder
constexpr float kHandTip = 1;           // hands beyond the hand
constexpr float kNoseM = 0.10F, kEyeAheadM = 0.08F, kEyeUpM = 0.03F, kEyeAsideM = 0.032F,
                kEarAsideM = 0.075F;

template <std::size_t N, class To>
Body gather(const std::array<JointPosition, N>& joints, const std::array<To, kJointCount>& where,
            std::uint32_t id) {
    Body body;
    body.id = id;
    for (std::size_t j = 0; j < kJointCount; ++j) {
        body.joints[j] = joints[static_cast<std::size_t>(where[j])];
    }
    return body;
}

/// At `place`, as sure as what it is made from allows.
JointPosition made(const Body& body, const glm::vec3& place, std::initializer_list<Joint> from) {
    JointPosition out{place, JointState::inferred, 1};
    for (const Joint j : from) {
        if (body[j].state == JointState::lost) out.state = JointState::lost;
        out.confidence = std::min(out.confidence, body[j].confidence);
    }
    out.confidence = out.state == JointState::lost ? 0 : out.confidence / 2;
    return out;
}

JointPosition between(const Body& body, Joint a, Joint b, float share) {
    const glm::vec3 &from = body[a].position_m, &to = body[b].position_m;
    return made(body, from + share * (to - from), {a, b});
}

JointPosition thumb(const Body& body, Joint hand) {
    return {body[hand].position_m, JointState::lost, 0};
}

void put_face(const Body& body, Joints32& out) {
    const glm::vec3& head = body[J::head].position_m;
    const glm::vec3 across = body[J::shoulder_left].position_m - body[J::shoulder_right].position_m;
    const glm::vec3 above = head - body[J::shoulder_center].position_m;
    const glm::vec3 ahead = glm::cross(across, above);
    const bool flat = !(glm::length(across) > 1e-4F) || !(glm::length(ahead) > 1e-6F);
    const glm::vec3 left = flat ? glm::vec3(0) : glm::normalize(across);
    const glm::vec3 front = flat ? glm::vec3(0) : glm::normalize(ahead);
    const glm::vec3 up = glm::cross(front, left);
    const auto put = [&](Joint32 j, const glm::vec3& offset) {
        JointPosition p = made(body, head + offset,
                               {J::head, J::shoulder_center, J::shoulder_left, J::shoulder_right});
        if (flat) p.state = JointState::lost, p.confidence = 0;
        out[static_cast<std::size_t>(j)] = p;
    };
    put(Joint32::nose, front * kNoseM);
    const glm::vec3 eyes = front * kEyeAheadM + up * kEyeUpM;
    put(Joint32::eye_left, eyes + left * kEyeAsideM);
    put(Joint32::eye_right, eyes - left * kEyeAsideM);
    put(Joint32::ear_left, left * kEarAsideM);
    put(Joint32::ear_right, -left * kEarAsideM);
}

}  // namespace

const char* joint_name(Joint25 joint) {
    constexpr std::array<const char*, kJoint25Count> kNames = {
        "SpineBase",     "SpineMid",    "Neck",      "Head",          "ShoulderLeft",
        "ElbowLeft",     "WristLeft",   "HandLeft",  "ShoulderRight", "ElbowRight",
        "WristRight",    "HandRight",   "HipLeft",   "KneeLeft",      "AnkleLeft",
        "FootLeft",      "HipRight",    "KneeRight", "AnkleRight",    "FootRight",
        "SpineShoulder", "HandTipLeft", "ThumbLeft", "HandTipRight",  "ThumbRight"};
    return kNames[static_cast<std::size_t>(joint)];
}

const char* joint_name(Joint32 joint) {
    constexpr std::array<const char*, kJoint32Count> kNames = {
        "PELVIS",        "SPINE_NAVEL",    "SPINE_CHEST",    "NECK",        "CLAVICLE_LEFT",
        "SHOULDER_LEFT", "ELBOW_LEFT",     "WRIST_LEFT",     "HAND_LEFT",   "HANDTIP_LEFT",
        "THUMB_LEFT",    "CLAVICLE_RIGHT", "SHOULDER_RIGHT", "ELBOW_RIGHT", "WRIST_RIGHT",
        "HAND_RIGHT",    "HANDTIP_RIGHT",  "THUMB_RIGHT",    "HIP_LEFT",    "KNEE_LEFT",
        "ANKLE_LEFT",    "FOOT_LEFT",      "HIP_RIGHT",      "KNEE_RIGHT",  "ANKLE_RIGHT",
        "FOOT_RIGHT",    "HEAD",           "NOSE",           "EYE_LEFT",    "EAR_LEFT",
        "EYE_RIGHT",     "EAR_RIGHT"};
    return kNames[static_cast<std::size_t>(joint)];
}

Joints25 to_joints25(const Body& body) {
    Joints25 out;
    for (std::size_t j = 0; j < kJointCount; ++j) {
        out[static_cast<std::size_t>(kIn25[j])] = body.joints[j];
    }
    const auto put = [&](Joint25 j, const JointPosition& p) {
        out[static_cast<std::size_t>(j)] = p;
    };
    put(Joint25::neck, between(body, J::shoulder_center, J::head, kNeckShare));
    put(Joint25::hand_tip_left, between(body, J::wrist_left, J::hand_left, 1 + kHandTip));
    put(Joint25::hand_tip_right, between(body, J::wrist_right, J::hand_right, 1 + kHandTip));
    put(Joint25::thumb_left, thumb(body, J::hand_left));
    put(Joint25::thumb_right, thumb(body, J::hand_right));
    return out;
}

Joints32 to_joints32(const Body& body) {
    Joints32 out;
    for (std::size_t j = 0; j < kJointCount; ++j) {
        out[static_cast<std::size_t>(kIn32[j])] = body.joints[j];
    }
    const auto put = [&](Joint32 j, const JointPosition& p) {
        out[static_cast<std::size_t>(j)] = p;
    };
    put(Joint32::spine_chest, between(body, J::spine, J::shoulder_center, 0.5F));
    put(Joint32::clavicle_left,
        between(body, J::shoulder_center, J::shoulder_left, kClavicleShare));
    put(Joint32::clavicle_right,
        between(body, J::shoulder_center, J::shoulder_right, kClavicleShare));
    put(Joint32::hand_tip_left, between(body, J::wrist_left, J::hand_left, 1 + kHandTip));
    put(Joint32::hand_tip_right, between(body, J::wrist_right, J::hand_right, 1 + kHandTip));
    put(Joint32::thumb_left, thumb(body, J::hand_left));
    put(Joint32::thumb_right, thumb(body, J::hand_right));
    put_face(body, out);
    return out;
}

Body from_joints25(const Joints25& joints, std::uint32_t id) {
    return gather(joints, kIn25, id);
}

Body from_joints32(const Joints32& joints, std::uint32_t id) {
    return gather(joints, kIn32, id);
}

int k4abt_confidence(JointState state) {
    return static_cast<int>(state);
}

}  // namespace kino
