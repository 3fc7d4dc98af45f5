#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>

#include "base/camera_model.h"
#include "skeleton/actors/actor_body.h"
#include "skeleton/synthetic/raycast_kernel.h"

namespace kino {

/// Draws posed vertices (view space: x right, y down, z forward, metres) into z and id of `target`
/// where they are the nearest; `camera` has no distortion. A pixel shows the triangle that its
/// centre's ray meets and gets the id `first_id` + part. Triangles that reach nearer than
/// kMeshNearM are left out. Returns what may have been touched.
raycast::Rect draw_mesh(const ActorBody& body, std::span<const glm::vec3> view_m,
                        const CameraModel& camera, const raycast::Rect& clip, std::int32_t first_id,
                        const raycast::Target& target);
constexpr float kMeshNearM = 0.10f;

/// Pixels that could show these vertices; empty if all are behind the camera.
[[nodiscard]] raycast::Rect mesh_bounds(std::span<const glm::vec3> view_m,
                                        const CameraModel& camera);

}  // namespace kino
