#pragma once

#include <array>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "base/body.h"
#include "skeleton/actors/actor_body.h"
#include "skeleton/synthetic/body_model.h"

namespace kino {

/// A pose without a body: directions of bones and frames of what is rigid, so that one motion
/// drives any build. World space, y up. Side 0 is the person's left.
struct ActorPose {
    glm::dmat3 pelvis{1}, chest{1}, head{1};  ///< columns: left, up, forward
    std::array<double, 2> shrug_rad{};        ///< lifts the shoulder
    std::array<glm::dvec3, 2> upper_arm{glm::dvec3(0, -1, 0), glm::dvec3(0, -1, 0)};
    std::array<glm::dvec3, 2> forearm{glm::dvec3(0, -1, 0), glm::dvec3(0, -1, 0)};
    std::array<glm::dvec3, 2> hand{glm::dvec3(0, -1, 0), glm::dvec3(0, -1, 0)};
    std::array<glm::dvec3, 2> hand_back{glm::dvec3(1, 0, 0), glm::dvec3(-1, 0, 0)};
    std::array<double, 2> curl{0.25, 0.25};  ///< of the fingers: 0 straight, 1 a fist
    std::array<glm::dvec3, 2> thigh{glm::dvec3(0, -1, 0), glm::dvec3(0, -1, 0)};
    std::array<glm::dvec3, 2> shin{glm::dvec3(0, -1, 0), glm::dvec3(0, -1, 0)};
    std::array<glm::dmat3, 2> foot{glm::dmat3(1), glm::dmat3(1)};  ///< columns: left, up, toes
    glm::dvec2 place_m{0};  ///< of the hip centre, world x and z
    double lift_m = 0;      ///< of the lowest point of the body above the floor
};

/// What the posed 1.75 m person of skeleton/synthetic says; fingers half open, on the floor.
[[nodiscard]] ActorPose actor_pose(const PosedBody& body);

/// From joints alone, world space. Where they say nothing (hands, turned heads, twist) the pose is
/// at ease; feet near `floor_m` stand flat.
[[nodiscard]] ActorPose actor_pose(const std::array<glm::dvec3, kJointCount>& joint_m,
                                   double floor_m);

/// A pose turned about the vertical through the world's origin.
[[nodiscard]] ActorPose turned(const ActorPose& pose, double yaw_rad);

/// A pose turned about the world's origin any way.
[[nodiscard]] ActorPose turned(const ActorPose& pose, const glm::dquat& rotation);

/// The same pose with left and right exchanged, mirrored at the plane x = 0.
[[nodiscard]] ActorPose mirrored(const ActorPose& pose);

/// Where a body's bones stand: world = place + turn * (rest - head_m).
struct PosedBones {
    std::array<glm::dmat3, kActorBoneCount> turn;
    std::array<glm::dvec3, kActorBoneCount> place_m;
    std::array<glm::dvec3, kJointCount> joint_m;
};

/// Poses the bones with the hip centre at (place, height 0); `settle` then lifts them.
[[nodiscard]] PosedBones pose_bones(const ActorBody& body, const ActorPose& pose);

/// Skinned vertices, world space.
void skin(const ActorBody& body, const PosedBones& bones, std::vector<glm::vec3>& out);

/// Both of the above; the lowest vertex ends at pose.lift_m above the floor.
PosedBones pose_actor(const ActorBody& body, const ActorPose& pose, std::vector<glm::vec3>& out);

}  // namespace kino
