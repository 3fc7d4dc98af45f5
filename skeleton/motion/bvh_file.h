#pragma once

#include <glm/gtc/quaternion.hpp>
#include <glm/vec3.hpp>
#include <string>

#include "skeleton/motion/skeletal_motion.h"

namespace kino::motion_export {

/// Angles in radians with rotation = Rz(z) * Rx(x) * Ry(y). Of all that give the rotation, those
/// nearest to `before`, so that curves have no jumps; straight at the pole y stays.
[[nodiscard]] glm::dvec3 euler_zxy(const glm::dquat& rotation, const glm::dvec3& before);

/// Biovision hierarchy: centimetres, degrees, positions of the root only.
[[nodiscard]] std::string bvh_text(const SkeletalMotion& motion);

}  // namespace kino::motion_export
