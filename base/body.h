#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "base/time.h"

namespace kino {

/// The 20 joints of the Kinect v1, in its order. Left and right are the person's own.
enum class Joint : std::uint8_t {
    hip_center,
    spine,
    shoulder_center,
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
};
constexpr std::size_t kJointCount = 20;

/// Parent of each joint in the kinematic tree; the root (hip_center) is its own parent.
constexpr std::array<Joint, kJointCount> kJointParent = {
    Joint::hip_center,      Joint::hip_center,     Joint::spine,       Joint::shoulder_center,
    Joint::shoulder_center, Joint::shoulder_left,  Joint::elbow_left,  Joint::wrist_left,
    Joint::shoulder_center, Joint::shoulder_right, Joint::elbow_right, Joint::wrist_right,
    Joint::hip_center,      Joint::hip_left,       Joint::knee_left,   Joint::ankle_left,
    Joint::hip_center,      Joint::hip_right,      Joint::knee_right,  Joint::ankle_right,
};

[[nodiscard]] const char* joint_name(Joint joint);

enum class JointState : std::uint8_t { lost, inferred, tracked };

struct JointPosition {
    glm::vec3 position_m{0};  ///< depth-camera space
    JointState state = JointState::lost;
    float confidence = 0;  ///< 0..1
};

struct Body {
    std::uint32_t id = 0;  ///< stable while the person is in view; 0 is nobody
    std::array<JointPosition, kJointCount> joints;

    [[nodiscard]] const JointPosition& operator[](Joint j) const {
        return joints[static_cast<std::size_t>(j)];
    }
    [[nodiscard]] JointPosition& operator[](Joint j) { return joints[static_cast<std::size_t>(j)]; }
};

struct BodyFrame {
    TimeNs time = 0;  ///< host time of the depth frame the bodies were read from
    std::vector<Body> bodies;
};

}  // namespace kino
