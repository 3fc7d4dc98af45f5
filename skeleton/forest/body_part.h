#pragma once

#include <cstdint>
#include <string_view>

#include "skeleton/forest/coarse_part.h"

namespace kino {

/// The labels of our own forest. Left and right are the person's own. Each lies within one bone and
/// one CoarsePart, so that a label alone names the bone it may be matched with. The halves of a
/// limb meet at the middle of its bone; chest and belly at the middle between hip centre and
/// shoulder centre, and their sides at the sagittal plane.
enum class BodyPart : std::uint8_t {
    head,
    neck,
    chest_left,
    belly_left,  ///< with the hips
    chest_right,
    belly_right,
    upper_arm_left_high,  ///< with the shoulder
    upper_arm_left_low,
    forearm_left_high,
    forearm_left_low,
    hand_left,  ///< from the wrist on
    upper_arm_right_high,
    upper_arm_right_low,
    forearm_right_high,
    forearm_right_low,
    hand_right,
    thigh_left_high,
    thigh_left_low,
    shin_left_high,
    shin_left_low,
    foot_left,  ///< from the ankle on
    thigh_right_high,
    thigh_right_low,
    shin_right_high,
    shin_right_low,
    foot_right,
};
constexpr int kBodyPartCount = 26;

/// "head", "upper_arm_left_high", ...: the labels in our forest's file.
[[nodiscard]] std::string_view body_part_name(BodyPart part);
[[nodiscard]] CoarsePart coarse_part_of(BodyPart part);
[[nodiscard]] BodyPart mirrored(BodyPart part);

}  // namespace kino
