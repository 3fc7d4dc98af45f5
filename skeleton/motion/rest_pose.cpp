#include "skeleton/motion/rest_pose.h"

namespace kino::motion_export {

const std::array<RestNode, kNodeCount>& rest_nodes() {
    constexpr double kCos30 = 0.86602540378443865;  // hips leave the pelvis 30 degrees downwards
    const glm::dvec3 up(0, 1, 0), down(0, -1, 0), left(1, 0, 0), right(-1, 0, 0), ahead(0, 0, 1);
    static const std::array<RestNode, kNodeCount> kNodes = {{
        {"hip_center", -1, glm::dvec3(0)},
        {"spine", 0, up},
        {"shoulder_center", 1, up},
        {"head", kNeck, up},
        {"shoulder_left", kLeftClavicle, left},
        {"elbow_left", 4, left},
        {"wrist_left", 5, left},
        {"hand_left", 6, left},
        {"shoulder_right", kRightClavicle, right},
        {"elbow_right", 8, right},
        {"wrist_right", 9, right},
        {"hand_right", 10, right},
        {"hip_left", kLeftPelvis, glm::dvec3(kCos30, -0.5, 0)},
        {"knee_left", 12, down},
        {"ankle_left", 13, down},
        {"foot_left", 14, ahead},
        {"hip_right", kRightPelvis, glm::dvec3(-kCos30, -0.5, 0)},
        {"knee_right", 16, down},
        {"ankle_right", 17, down},
        {"foot_right", 18, ahead},
        {"pelvis_left", 0, glm::dvec3(0)},
        {"pelvis_right", 0, glm::dvec3(0)},
        {"neck", 2, glm::dvec3(0)},
        {"clavicle_left", 2, glm::dvec3(0)},
        {"clavicle_right", 2, glm::dvec3(0)},
    }};
    return kNodes;
}

const std::array<int, kNodeCount>& tree_order() {
    static constexpr std::array<int, kNodeCount> kOrder = {
        0,           1,  2,  kNeck, 3,  kLeftClavicle, 4,  5,  6,  7, kRightClavicle, 8, 9, 10, 11,
        kLeftPelvis, 12, 13, 14,    15, kRightPelvis,  16, 17, 18, 19};
    return kOrder;
}

double usual_bone_m(Joint end) {
    constexpr std::array<double, kJointCount> kBones = {
        0,    0.13, 0.34, 0.19,                          // trunk and head
        0.18, 0.28, 0.25, 0.08, 0.18, 0.28, 0.25, 0.08,  // arms
        0.10, 0.42, 0.41, 0.14, 0.10, 0.42, 0.41, 0.14,  // legs
    };
    return kBones[static_cast<std::size_t>(end)];
}

double tip_m(int node) {
    switch (node) {
        case static_cast<int>(Joint::head):
            return 0.12;
        case static_cast<int>(Joint::hand_left):
        case static_cast<int>(Joint::hand_right):
            return 0.10;
        case static_cast<int>(Joint::foot_left):
        case static_cast<int>(Joint::foot_right):
            return 0.06;
        default:
            return 0;
    }
}

}  // namespace kino::motion_export
