#include "base/body.h"

namespace kino {

const char* joint_name(Joint joint) {
    constexpr std::array<const char*, kJointCount> kNames = {
        "hip_center",  "spine",      "shoulder_center", "head",           "shoulder_left",
        "elbow_left",  "wrist_left", "hand_left",       "shoulder_right", "elbow_right",
        "wrist_right", "hand_right", "hip_left",        "knee_left",      "ankle_left",
        "foot_left",   "hip_right",  "knee_right",      "ankle_right",    "foot_right"};
    return kNames[static_cast<std::size_t>(joint)];
}

}  // namespace kino
