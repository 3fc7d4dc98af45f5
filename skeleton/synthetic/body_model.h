#pragma once

#include <array>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include "base/body.h"

namespace kino {

/// Of x on a side: 1 on the person's left (side 0), -1 on the right.
[[nodiscard]] constexpr double sign_of(int side) {
    return side == 0 ? 1.0 : -1.0;
}

/// Person's frame: origin on the floor below the pelvis, x to the person's left, y up, z where the
/// person faces. Side 0 is the person's left, side 1 the right.
struct ArmPose {
    glm::dvec3 upper{0, -1, 0}, lower{0, -1, 0}, hand{0, -1, 0};  ///< directions, chest frame
    glm::dvec3 palm{1, 0, 0};  ///< where the palm looks, chest frame, about normal to `hand`
    double shrug_rad = 0;      ///< lifts the shoulder
};

struct LegPose {
    glm::dvec3 ankle_m{0};     ///< wanted place in the person's frame; pulled in if out of reach
    double toe_yaw_rad = 0;    ///< outwards
    double toe_pitch_rad = 0;  ///< positive: toes down
    double knee_out = 0.15;    ///< sideways part of the direction in which the knee bends
};

struct BodyPose {
    glm::dvec3 place_m{0};             ///< world, of the person's frame
    double yaw_rad = 0;                ///< about y; 0 faces world +z
    glm::dvec3 pelvis_m{0, 0.955, 0};  ///< hip_center, person's frame
    glm::dquat pelvis{1, 0, 0, 0}, spine{1, 0, 0, 0}, neck{1, 0, 0, 0};  ///< each to its parent
    std::array<ArmPose, 2> arm;
    std::array<LegPose, 2> leg;
};

/// Where everything of the body is, in world space.
struct PosedBody {
    std::array<glm::dvec3, kJointCount> joint_m;
    glm::dmat3 pelvis, waist, chest, head;  ///< columns: left, up, forward
    std::array<glm::dmat3, 2> hand;  ///< columns: thumb side, back along the fingers, back of hand
    std::array<glm::dmat3, 2> foot;  ///< columns: left, up, toes
    [[nodiscard]] const glm::dvec3& operator[](Joint j) const {
        return joint_m[static_cast<std::size_t>(j)];
    }
};

/// Standing at ease, arms hanging, facing world +z.
[[nodiscard]] BodyPose standing_pose();

/// The arm whose wrist is at `wrist_m` (chest frame from the joint spine, where the left shoulder
/// is at (0.178, 0.305, -0.015); pulled in if out of reach), the elbow hanging outwards, the palm
/// to the front.
[[nodiscard]] ArmPose arm_reaching(int side, const glm::dvec3& wrist_m);

/// Every part between two poses; directions and rotations take the short way. w in [0, 1].
[[nodiscard]] BodyPose blend(const BodyPose& from, const BodyPose& to, double w);

/// Places the joints of a 1.75 m person; bone lengths do not depend on the pose.
[[nodiscard]] PosedBody pose_body(const BodyPose& pose);

}  // namespace kino
