#pragma once

#include <glm/vec3.hpp>

#include "skeleton/synthetic/primitive.h"
#include "skeleton/synthetic/raycast_kernel.h"
#include "skeleton/synthetic/scene.h"

namespace kino {

/// Linear colour without light.
[[nodiscard]] glm::vec3 albedo(Covering material);

/// How the person's solid is painted.
[[nodiscard]] raycast::Paint paint_of(const Primitive& solid);

/// The room's light, turned into a view's axes.
[[nodiscard]] raycast::Lights lights_for(const Pose& view_from_world);

/// Linear colour, lit, of a point on the room (plane 0..5: low x, high x, floor, ceiling, low z,
/// high z) or on a solid of the furniture, world space. Textures are functions of the place.
[[nodiscard]] glm::vec3 color_of_room(const RoomBox& room, int plane, const glm::dvec3& point);
[[nodiscard]] glm::vec3 color_of_solid(const Primitive& solid, const glm::dvec3& point);

/// The camera's tone curve, linear [0, 1] to 8 bits, as the fast path has it.
[[nodiscard]] std::uint32_t to_rgba8(const glm::vec3& linear);

}  // namespace kino
