#include "apps/avatar/avatar_aim.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

#include "apps/avatar/turns.h"

namespace kino {
namespace {

/// No depth camera of this kind sees so far.
constexpr double kFarthestM = 30;

}  // namespace

BodyAim aim_of(const Body& body, const Pose& world_from_depth) {
    BodyAim aim;
    if (!is_valid(world_from_depth)) return aim;
    for (std::size_t j = 0; j < kJointCount; ++j) {
        const glm::dvec3 p(body.joints[j].position_m);
        // Written so that nothing which is not a number passes.
        aim.seen[j] =
            body.joints[j].state != JointState::lost && glm::dot(p, p) < kFarthestM * kFarthestM;
        if (aim.seen[j]) aim.joint_m[j] = world_from_depth * p;
    }
    return aim;
}

BodyAim aim_of(const PosedBody& body, const glm::dvec3& middle_m, const glm::dvec3& facing) {
    const glm::dvec3 forward = unit_or({facing.x, 0, facing.z}, {0, 0, 1});
    BodyAim aim;
    for (std::size_t j = 0; j < kJointCount; ++j) {
        const glm::dvec3& p = body.joint_m[j];
        aim.joint_m[j] = middle_m + glm::cross(glm::dvec3(0, 1, 0), forward) * p.x +
                         glm::dvec3(0, p.y, 0) + forward * p.z;
        aim.seen[j] = true;
    }
    return aim;
}

BodyAim mirrored(const BodyAim& aim, const MirrorPlane& plane) {
    BodyAim out = aim;
    for (glm::dvec3& p : out.joint_m) {
        p -= plane.normal * (2 * glm::dot(plane.normal, p - plane.point_m));
    }
    for (const Joint left : {Joint::shoulder_left, Joint::hip_left}) {
        for (std::size_t i = 0; i < 4; ++i) {
            std::swap(out.joint_m[index_of(left) + i], out.joint_m[index_of(left) + 4 + i]);
            std::swap(out.seen[index_of(left) + i], out.seen[index_of(left) + 4 + i]);
        }
    }
    return out;
}

}  // namespace kino
