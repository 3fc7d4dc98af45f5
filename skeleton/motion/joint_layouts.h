#pragma once

#include <array>
#include <cstddef>

#include "base/body.h"

namespace kino {

/// The 25 joints of the Kinect v2, in its order.
enum class Joint25 : std::uint8_t {
    spine_base,
    spine_mid,
    neck,
    head,
    shoulder_left,
    elbow_left,
    wrist_left,
    hand_left,
    shoulder_right,
    elbow_right,
    wrist_right,
    hand_right,
    hip_left,
    knee_left,
    ankle_left,
    foot_left,
    hip_right,
    knee_right,
    ankle_right,
    foot_right,
    spine_shoulder,
    hand_tip_left,
    thumb_left,
    hand_tip_right,
    thumb_right,
};
constexpr std::size_t kJoint25Count = 25;

/// The 32 joints of the Azure Kinect body tracking SDK, in its order.
enum class Joint32 : std::uint8_t {
    pelvis,
    spine_navel,
    spine_chest,
    neck,
    clavicle_left,
    shoulder_left,
    elbow_left,
    wrist_left,
    hand_left,
    hand_tip_left,
    thumb_left,
    clavicle_right,
    shoulder_right,
    elbow_right,
    wrist_right,
    hand_right,
    hand_tip_right,
    thumb_right,
    hip_left,
    knee_left,
    ankle_left,
    foot_left,
    hip_right,
    knee_right,
    ankle_right,
    foot_right,
    head,
    nose,
    eye_left,
    ear_left,
    eye_right,
    ear_right,
};
constexpr std::size_t kJoint32Count = 32;

using Joints25 = std::array<JointPosition, kJoint25Count>;
using Joints32 = std::array<JointPosition, kJoint32Count>;

/// The names of those SDKs' enumerators, without their prefix.
[[nodiscard]] const char* joint_name(Joint25 joint);
[[nodiscard]] const char* joint_name(Joint32 joint);

/// The 20 joints are kept as they are (the shoulder centre is SpineShoulder, and the Neck of the
/// 32). What they lack is made from them, docs/motion-export.md says how: at best inferred, with
/// half the least confidence of what it is made from; lost where one of those is. Thumbs cannot be
/// known: lost, at the hand. Same space as the body; the face needs one whose axes are metric and
/// right-handed, such as depth-camera or world space. Always finite for finite input.
[[nodiscard]] Joints25 to_joints25(const Body& body);
[[nodiscard]] Joints32 to_joints32(const Body& body);

/// The other way: the joints that the 20 have, unchanged; the others are dropped.
[[nodiscard]] Body from_joints25(const Joints25& joints, std::uint32_t id);
[[nodiscard]] Body from_joints32(const Joints32& joints, std::uint32_t id);

/// k4abt_joint_confidence_level_t: 0 none, 1 low, 2 medium (3, high, is reserved there).
[[nodiscard]] int k4abt_confidence(JointState state);

}  // namespace kino
