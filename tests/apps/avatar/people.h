#pragma once

#include <vector>

#include "apps/avatar/avatar.h"
#include "skeleton/synthetic/body_model.h"
#include "skeleton/synthetic/motion.h"

namespace kino::test {

/// A tracked body whose depth space is the world.
[[nodiscard]] inline Body body_of(const PosedBody& posed, std::uint32_t id = 1) {
    Body body;
    body.id = id;
    for (std::size_t j = 0; j < kJointCount; ++j) {
        body.joints[j] = {glm::vec3(posed.joint_m[j]), JointState::tracked, 1};
    }
    return body;
}

/// The synthetic person at the origin, or elsewhere.
[[nodiscard]] inline PosedBody person_at(Motion motion, double t_s,
                                         const glm::dvec3& place_m = {}) {
    BodyPose pose = pose_at(motion, t_s);
    pose.place_m = place_m;
    return pose_body(pose);
}

[[nodiscard]] inline AvatarMoment moment_of(const BodyFrame& frame, double dt_s = 1.0 / 30) {
    AvatarMoment moment;
    moment.dt_s = dt_s;
    moment.bodies = &frame;
    return moment;
}

}  // namespace kino::test
