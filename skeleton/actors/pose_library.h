#pragma once

#include "skeleton/actors/actor_random.h"
#include "skeleton/synthetic/body_model.h"

namespace kino {

enum class Stance : std::uint8_t {
    standing,
    stepping,  ///< feet apart fore and aft, or one in the air
    sitting,   ///< needs a seat
    crouching,
    bending,
};

/// Plausible poses of the 1.75 m person at the origin facing +z, within the limits of the joints;
/// arms do not run through the trunk or head. Place and yaw are left at zero.
[[nodiscard]] BodyPose random_pose(ActorRandom& random, Stance stance);
/// Standing mostly.
[[nodiscard]] Stance random_stance(ActorRandom& random);
/// New arms, head and a little of the trunk for a pose.
void change_upper_body(ActorRandom& random, BodyPose& pose);

/// An arm whose wrist is at a place in the chest's frame (origin in the joint `spine`, m), pulled
/// in if out of reach; the elbow hangs outwards, the hand goes on along the forearm, palm forwards.
[[nodiscard]] ArmPose arm_to(int side, const glm::dvec3& wrist_m);

}  // namespace kino
