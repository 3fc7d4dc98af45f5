#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <string_view>

#include "base/body.h"
#include "skeleton/forest/pcl_forest.h"

namespace kino {

/// The parts in which forests with different labels are compared. Left and right are the person's
/// own.
enum class CoarsePart : std::uint8_t {
    head,
    torso,
    upper_arm_left,
    lower_arm_left,
    hand_left,
    upper_arm_right,
    lower_arm_right,
    hand_right,
    upper_leg_left,
    lower_leg_left,
    foot_left,
    upper_leg_right,
    lower_leg_right,
    foot_right,
};
constexpr int kCoarsePartCount = 14;

[[nodiscard]] std::string_view coarse_part_name(CoarsePart part);

/// A set of parts, bit n for the part of value n.
using CoarsePartSet = std::uint16_t;
[[nodiscard]] constexpr CoarsePartSet coarse_set(CoarsePart part) {
    return static_cast<CoarsePartSet>(1u << static_cast<unsigned>(part));
}

/// The part of a point on the flesh that the synthetic person counts to a joint (its part ids are
/// joints plus one). That flesh reaches over the joint on both sides, so the nearest bone of the
/// limb decides. `joints_m` are the person's true joints in the order of Joint; any frame, metres.
[[nodiscard]] CoarsePart coarse_part_at(Joint flesh, const glm::dvec3& point_m,
                                        const std::array<glm::dvec3, kJointCount>& joints_m);

/// Where most of the pretrained label lies: knees with the lower leg, elbows with the lower arm,
/// the neck with the torso.
[[nodiscard]] CoarsePart coarse_part_of(PclPart part);

/// Every part in which the pretrained label is not wrong: its knees, elbows and neck straddle two.
/// Comparing through these sets favours the peer.
[[nodiscard]] CoarsePartSet coarse_parts_of(PclPart part);

/// The same part of the other side; head and torso are their own.
[[nodiscard]] CoarsePart mirrored(CoarsePart part);

}  // namespace kino
