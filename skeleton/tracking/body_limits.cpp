#include "skeleton/tracking/body_limits.h"

#include <glm/geometric.hpp>

namespace kino {

using glm::mat3;
using glm::vec3;

mat3 limb_frame(const mat3& body, const vec3& direction) {
    return shortest_arc(-body[1], direction, body[0]) * body;
}

std::array<RestDirection, kSegmentCount> rest_directions(const JointedPose& pose) {
    std::array<RestDirection, kSegmentCount> rest{};
    const mat3 &chest = pose.chest, &pelvis = pose.pelvis;
    rest[0] = {Segment::neck, glm::normalize(chest * vec3(0, 1, 0.12f)), kChestUnknown, 0.35f};
    std::size_t n = 1;
    for (int side = 0; side < 2; ++side) {
        const float s = side == 0 ? 1.0f : -1.0f;
        const Segment upper = segment_of(Segment::upper_arm_left, side);
        const Segment fore = segment_of(Segment::forearm_left, side);
        const Segment hand = segment_of(Segment::hand_left, side);
        rest[n++] = {upper, glm::normalize(chest * vec3(s * 0.2f, -1, 0)), kChestUnknown, 1.5f};
        const mat3 arm = limb_frame(chest, pose[upper]);
        rest[n++] = {fore, glm::normalize(arm * vec3(-s * 0.1f, -1, 0.4f)), -1, 1.2f};
        rest[n++] = {hand, pose[fore], -1, 0.35f};
    }
    for (int side = 0; side < 2; ++side) {
        const float s = side == 0 ? 1.0f : -1.0f;
        const Segment thigh = segment_of(Segment::thigh_left, side);
        const Segment shin = segment_of(Segment::shin_left, side);
        const Segment foot = segment_of(Segment::foot_left, side);
        rest[n++] = {thigh, glm::normalize(pelvis * vec3(s * 0.05f, -1, 0.05f)), kPelvisUnknown,
                     1.5f};
        const mat3 leg = limb_frame(pelvis, pose[thigh]);
        rest[n++] = {shin, glm::normalize(leg * vec3(0, -1, -0.1f)), -1, 0.8f};
        // About the shin's frame, which the knee turns back.
        const mat3 lower = shortest_arc(-leg[1], pose[shin], leg[0]) * leg;
        rest[n++] = {foot, glm::normalize(lower * vec3(s * 0.2f, -0.36f, 0.93f)), -1, 0.4f};
    }
    return rest;
}

std::array<DirectionLimit, kDirectionLimits> direction_limits(const JointedPose& pose) {
    std::array<DirectionLimit, kDirectionLimits> limits{};
    const mat3 &chest = pose.chest, &pelvis = pose.pelvis;
    std::size_t n = 0;
    limits[n++] = {Segment::neck, -chest[1], -0.3f};
    for (int side = 0; side < 2; ++side) {
        const float s = side == 0 ? 1.0f : -1.0f;
        const Segment upper = segment_of(Segment::upper_arm_left, side);
        const Segment fore = segment_of(Segment::forearm_left, side);
        const Segment hand = segment_of(Segment::hand_left, side);
        const Segment thigh = segment_of(Segment::thigh_left, side);
        const Segment shin = segment_of(Segment::shin_left, side);
        const Segment foot = segment_of(Segment::foot_left, side);
        limits[n++] = {upper, -chest[2], 0.8f};       // backwards
        limits[n++] = {upper, -chest[0] * s, 0.75f};  // across the chest
        limits[n++] = {fore, -pose[upper], 0.87f};    // flexed by 150 degrees
        const mat3 arm = limb_frame(chest, pose[upper]);
        limits[n++] = {fore, -arm[2], 0.45f};  // the elbow's wrong way, arm turned
        limits[n++] = {hand, -pose[fore], -0.2f};
        limits[n++] = {thigh, -pelvis[2], 0.5f};
        limits[n++] = {thigh, -pelvis[0] * s, 0.5f};
        limits[n++] = {thigh, pelvis[0] * s, 0.85f};
        const mat3 leg = limb_frame(pelvis, pose[thigh]);
        limits[n++] = {shin, leg[2], 0.1f};  // the knee's wrong way
        limits[n++] = {shin, -pose[thigh], 0.8f};
        limits[n++] = {shin, leg[0], 0.5f};
        limits[n++] = {shin, -leg[0], 0.5f};
        const mat3 lower = shortest_arc(-leg[1], pose[shin], leg[0]) * leg;
        limits[n++] = {foot, -lower[2], -0.1f};
    }
    return limits;
}

}  // namespace kino
