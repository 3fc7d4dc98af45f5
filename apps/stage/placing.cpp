#include "apps/stage/placing.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>

namespace kino {
namespace {

// Of a person of 1.7 m, metres: where the joint is above the floor.
constexpr double kFootUp = 0.03, kAnkleUp = 0.08;
constexpr double kHeadUp = 1.58, kSittingHeadUp = 1.2;
constexpr double kHeadOverShoulders = 0.28;
constexpr double kMiddleUp = 1;

Pose standing_at(glm::dvec3 mark_m, const Pose& world_from_depth) {
    glm::dvec3 z = world_from_depth.translation - mark_m;
    z.y = 0;
    if (!(glm::length(z) > 0.05)) {
        z = world_from_depth.rotation * glm::dvec3(0, 0, -1);
        z.y = 0;
    }
    z = glm::length(z) > 1e-6 ? glm::normalize(z) : glm::dvec3(0, 0, 1);
    const glm::dvec3 y(0, 1, 0);
    return {.rotation = glm::normalize(glm::quat_cast(glm::dmat3(glm::cross(y, z), y, z))),
            .translation = mark_m};
}

}  // namespace

std::optional<Pose> place_under(const CastMember& person, const Pose& world_from_depth) {
    glm::dvec3 sum(0);
    int count = 0;
    for (const Joint joint : {Joint::hip_center, Joint::spine, Joint::shoulder_center, Joint::head,
                              Joint::shoulder_left, Joint::shoulder_right}) {
        if (!person[joint].seen) continue;
        sum += person[joint].world_m;
        ++count;
    }
    const CastJoint& head = person[Joint::head];
    const CastJoint& shoulders = person[Joint::shoulder_center];
    if (count < 2 || !(head.seen || shoulders.seen)) return std::nullopt;
    std::optional<double> floor;
    const auto foot = [&](Joint joint, double up) {
        if (!person[joint].seen) return;
        const double y = person[joint].world_m.y - up;
        floor = std::min(floor.value_or(y), y);
    };
    foot(Joint::foot_left, kFootUp);
    foot(Joint::foot_right, kFootUp);
    foot(Joint::ankle_left, kAnkleUp);
    foot(Joint::ankle_right, kAnkleUp);
    if (!floor) {
        const bool stands = person[Joint::knee_left].seen || person[Joint::knee_right].seen ||
                            person[Joint::hip_center].seen;
        const double top = head.seen ? head.world_m.y : shoulders.world_m.y + kHeadOverShoulders;
        floor = top - (stands ? kHeadUp : kSittingHeadUp);
    }
    return standing_at({sum.x / count, *floor, sum.z / count}, world_from_depth);
}

Pose place_about(const glm::dvec3& middle_m, const Pose& world_from_depth) {
    return standing_at(middle_m - glm::dvec3(0, kMiddleUp, 0), world_from_depth);
}

}  // namespace kino
