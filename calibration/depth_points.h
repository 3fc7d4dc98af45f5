#pragma once

#include <glm/vec3.hpp>

#include "calibration/rig.h"

namespace kino {

/// Every depth pixel as a point in the depth camera's space, metres; the origin where there is no
/// reading or the ray is NaN. `rays` are Rig::depth_rays() of the same size; `points` is resized
/// and reused.
void unproject_depth(const Image<float>& depth_m, const Image<RayXy>& rays,
                     Image<glm::vec3>& points);

}  // namespace kino
