#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "base/pose.h"
#include "skeleton/actors/actor_pose.h"
#include "skeleton/actors/actor_random.h"
#include "skeleton/synthetic/primitive.h"

namespace kino {

/// World space: y up, origin on the floor below the camera, which looks towards -z.
[[nodiscard]] Pose camera_pose(double height_m, double tilt_down_rad);

/// Vertices in the camera's view space.
void to_view(const Pose& view_from_world, std::vector<glm::vec3>& points);

/// Height of the lowest flesh that one sits on: trunk and upper thighs; world y.
[[nodiscard]] double seat_height(const ActorBody& body, const std::vector<glm::vec3>& posed);

/// A chair or stool whose seat is at `seat_m`, under `at`, its back opposite to `forward`.
void add_chair(ActorRandom& random, const glm::dvec3& at, const glm::dvec3& forward, double seat_m,
               std::vector<Primitive>& out);
/// A table whose top's centre is above `at`.
void add_table(ActorRandom& random, const glm::dvec3& at, double yaw_rad,
               std::vector<Primitive>& out);
/// Any box-like thing that stands on the floor.
void add_thing(ActorRandom& random, const glm::dvec3& at, std::vector<Primitive>& out);
/// Floor, ceiling and four walls round [x0, x1] x [z0, z1].
void add_room(double x0, double x1, double z0, double z1, double height_m,
              std::vector<Primitive>& out);

}  // namespace kino
