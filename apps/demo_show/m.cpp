#include "skeleton/actors/actor_truth.h"

#include <cmath>

namespace kino {
namespace {

// Parts whose flesh lies round a joint, left side; bit n is the part of value n.
std::uint32_t flesh_of(Joint joint) {
    const auto bits = [](std::initializer_list<BodyPart> parts) {
        std::uint32_t b = 0;
        for (const BodyPart p : parts) b |= 1u << static_cast<unsigned>(p);
        return b;
    };
    using enum BodyPart;
    switch (joint) {
        case Joint::hip_center:
            return bits({belly_left, belly_right, thigh_left_high, thigh_right_high});
        case Joint::spine:
            return bits({belly_left, belly_right, chest_left, chest_right});
        case Joint::shoulder_center:
            return bits({chest_left, chest_right, neck, head});
        case Joint::head:
            return bits({head, neck});
        case Joint::shoulder_left:
            return bits({upper_arm_left_high, upper_arm_left_low, chest_left});
        case Joint::elbow_left:
            return bits(
                {upper_arm_left_high, upper_arm_left_low, forearm_left_high, forearm_left_low});
        case Joint::wrist_left:
        case Joint::hand_left:
            return bits({forearm_left_high, forearm_left_low, hand_left});
        case Joint::hip_left:
            return bits({belly_left, thigh_left_high, thigh_left_low});
        case Joint::knee_left:
            return bits({thigh_left_high, thigh_left_low, shin_left_high, shin_left_low});
        case Joint::ankle_left:
        case Joint::foot_left:
            return bits({shin_left_high, shin_left_low, foot_left});
        default:
            break;
    }
    const std::uint32_t left = flesh_of(static_cast<Joint>(static_cast<int>(joint) - 4));
    std::uint32_t right = 0;
    for (int p = 0; p < kBodyPartCount; ++p) {
        if (left >> p & 1u)
            right |= 1u << static_cast<unsigned>(mirrored(static_cast<BodyPart>(p)));
    }
    return right;
}

}  // namespace

Body actor_truth(const PosedBones& bones, const Pose& view_from_world, int actor,
                 const Image<float>& z_m, const Image<std::int32_t>& id,
                 const CameraModel& camera) {
    // Thicker than any limb or trunk from its joint to the skin.
    constexpr double kFleshM = 0.25;
    Body body;
    body.id = static_cast<std::uint32_t>(actor);
    for (std::size_t j = 0; j < kJointCount; ++j) {
        const glm::dvec3 p = view_from_world * bones.joint_m[j];
        JointPosition& out = body.joints[j];
        out.position_m = glm::vec3(p);
        out.state = JointState::inferred;
        out.confidence = 0.5f;
        if (p.z < 0.1) continue;
        const int x = static_cast<int>(std::lround(camera.fx * p.x / p.z + camera.cx));
        const int y = static_cast<int>(std::lround(camera.fy * p.y / p.z + camera.cy));
        if (!id.contains(x, y)) continue;
        const std::int32_t seen = id.at(x, y);

        const std::uint32_t flesh = flesh_of(static_cast<Joint>(j));
        if (!(flesh >> part_of(seen) & 1u)) continue;
        if (std::abs(p.z - static_cast<double>(z_m.at(x, y))) > kFleshM) continue;
        out.state = JointState::tracked;
        out.confidence = 1;
    }
    return body;
}

}  // namespace kino
