#pragma once

#include <array>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "skeleton/actors/actor_look.h"
#include "skeleton/actors/base_mesh.h"

namespace kino {

/// The undressed body: the base mesh stretched bone by bone to somebody's proportions.
struct ActorShape {
    std::vector<glm::dvec3> vertex_m;
    std::array<glm::dvec3, kActorBoneCount> head_m;
    std::array<glm::dvec3, kJointCount> joint_m;
};
[[nodiscard]] ActorShape shape_body(const ActorLook& look);

/// Unit normals, outwards.
[[nodiscard]] std::vector<glm::dvec3> mesh_normals(
    const std::vector<glm::dvec3>& vertex_m,
    const std::vector<std::array<std::uint32_t, 3>>& triangles);

/// 0 on the side of `from`, 1 on that of `to` (either way round), smooth between.
[[nodiscard]] double smooth_step(double from, double to, double x);

}  // namespace kino
