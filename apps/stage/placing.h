#pragma once

#include <glm/vec3.hpp>
#include <optional>

#include "apps/stage/cast.h"
#include "base/pose.h"

namespace kino {

/// World from stage: the origin on the floor under the person, z towards the sensor. Where no foot
/// is seen, the floor is where it would be under somebody of common height who sits (without hips
/// or knees) or stands. Empty where nobody is seen well enough.
[[nodiscard]] std::optional<Pose> place_under(const CastMember& person,
                                              const Pose& world_from_depth);

/// The same for a place where nobody was seen yet: about the middle of what is there.
[[nodiscard]] Pose place_about(const glm::dvec3& middle_m, const Pose& world_from_depth);

}  // namespace kino
