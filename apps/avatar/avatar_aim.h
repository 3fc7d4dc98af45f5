#pragma once

#include <glm/vec3.hpp>

#include "apps/avatar/retarget.h"
#include "base/body.h"
#include "base/pose.h"
#include "skeleton/synthetic/body_model.h"

namespace kino {

/// The vertical plane that a mirror image is reflected in: through a point, with a level normal.
struct MirrorPlane {
    glm::dvec3 point_m{0};
    glm::dvec3 normal{1, 0, 0};
};

/// Joints of a tracked body in the world. Those that are lost, not finite or farther than any
/// sensor sees are not seen.
[[nodiscard]] BodyAim aim_of(const Body& body, const Pose& world_from_depth);

/// The posed person, put with its own frame at `middle_m`, facing `facing` (level).
[[nodiscard]] BodyAim aim_of(const PosedBody& body, const glm::dvec3& middle_m,
                             const glm::dvec3& facing);

/// Reflected, left and right changed over: again a person.
[[nodiscard]] BodyAim mirrored(const BodyAim& aim, const MirrorPlane& plane);

}  // namespace kino
