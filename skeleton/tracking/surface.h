#pragma once

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "skeleton/tracking/jointed_model.h"
#include "skeleton/tracking/part_points.h"

namespace kino {

/// A point against a bone's surface.
struct SurfaceGap {
    float gap_m = 0;      ///< positive outside; see surface_gap()
    float t = 0;          ///< of the nearest point of the axis, 0..1
    glm::vec3 normal{0};  ///< unit, from there to the point, or away from it
};

/// Distance of a point p, seen from the origin, to the part [from, to] of a bone. The camera sees
/// only the side that faces it: a point behind the axis counts from the far side's point of view,
/// so that the bone is drawn behind what is seen.
inline SurfaceGap surface_gap(const JointedModel& model, Bone bone, float from, float to,
                              const glm::vec3& p) {
    const BoneShape& shape = bone_shape(bone);
    const glm::vec3 a = model.node[shape.from], along = model.node[shape.to] - a;
    const float length2 = glm::dot(along, along);
    const float t = length2 > 1e-9f ? std::clamp(glm::dot(p - a, along) / length2, from, to) : 0.0f;
    const glm::vec3 away = p - (a + along * t);
    const float distance = std::sqrt(std::max(glm::dot(away, away), 1e-12f));
    const float radius = (shape.radius_from_m + (shape.radius_to_m - shape.radius_from_m) * t) *
                         model.shape[shape.girth];
    const glm::vec3 normal = away / distance;
    if (glm::dot(away, p) > 0.35f * distance * p.z) return {-distance - radius, t, -normal};
    return {distance - radius, t, normal};
}

}  // namespace kino
