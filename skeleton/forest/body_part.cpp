#include "skeleton/forest/body_part.h"

#include <array>

#include "base/check.h"

namespace kino {
namespace {

struct Entry {
    std::string_view name;
    CoarsePart coarse;
    BodyPart mirrored;
};

constexpr std::array<Entry, kBodyPartCount> kParts = {{
    {"head", CoarsePart::head, BodyPart::head},
    {"neck", CoarsePart::torso, BodyPart::neck},
    {"chest_left", CoarsePart::torso, BodyPart::chest_right},
    {"belly_left", CoarsePart::torso, BodyPart::belly_right},
    {"chest_right", CoarsePart::torso, BodyPart::chest_left},
    {"belly_right", CoarsePart::torso, BodyPart::belly_left},
    {"upper_arm_left_high", CoarsePart::upper_arm_left, BodyPart::upper_arm_right_high},
    {"upper_arm_left_low", CoarsePart::upper_arm_left, BodyPart::upper_arm_right_low},
    {"forearm_left_high", CoarsePart::lower_arm_left, BodyPart::forearm_right_high},
    {"forearm_left_low", CoarsePart::lower_arm_left, BodyPart::forearm_right_low},
    {"hand_left", CoarsePart::hand_left, BodyPart::hand_right},
    {"upper_arm_right_high", CoarsePart::upper_arm_right, BodyPart::upper_arm_left_high},
    {"upper_arm_right_low", CoarsePart::upper_arm_right, BodyPart::upper_arm_left_low},
    {"forearm_right_high", CoarsePart::lower_arm_right, BodyPart::forearm_left_high},
    {"forearm_right_low", CoarsePart::lower_arm_right, BodyPart::forearm_left_low},
    {"hand_right", CoarsePart::hand_right, BodyPart::hand_left},
    {"thigh_left_high", CoarsePart::upper_leg_left, BodyPart::thigh_right_high},
    {"thigh_left_low", CoarsePart::upper_leg_left, BodyPart::thigh_right_low},
    {"shin_left_high", CoarsePart::lower_leg_left, BodyPart::shin_right_high},
    {"shin_left_low", CoarsePart::lower_leg_left, BodyPart::shin_right_low},
    {"foot_left", CoarsePart::foot_left, BodyPart::foot_right},
    {"thigh_right_high", CoarsePart::upper_leg_right, BodyPart::thigh_left_high},
    {"thigh_right_low", CoarsePart::upper_leg_right, BodyPart::thigh_left_low},
    {"shin_right_high", CoarsePart::lower_leg_right, BodyPart::shin_left_high},
    {"shin_right_low", CoarsePart::lower_leg_right, BodyPart::shin_left_low},
    {"foot_right", CoarsePart::foot_right, BodyPart::foot_left},
}};

const Entry& entry(BodyPart part) {
    KINO_CHECK(static_cast<std::size_t>(part) < kParts.size());
    return kParts[static_cast<std::size_t>(part)];
}

}  // namespace

std::string_view body_part_name(BodyPart part) {
    return entry(part).name;
}

CoarsePart coarse_part_of(BodyPart part) {
    return entry(part).coarse;
}

BodyPart mirrored(BodyPart part) {
    return entry(part).mirrored;
}

}  // namespace kino
