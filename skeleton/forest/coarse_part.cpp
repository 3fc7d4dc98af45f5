#include "skeleton/forest/coarse_part.h"

#include <algorithm>
#include <array>
#include <glm/geometric.hpp>
#include <limits>

namespace kino {
namespace {

using enum CoarsePart;

constexpr std::array<std::string_view, kCoarsePartCount> kCoarseNames = {
    "head",
    "torso",
    "upper_arm_left",
    "lower_arm_left",
    "hand_left",
    "upper_arm_right",
    "lower_arm_right",
    "hand_right",
    "upper_leg_left",
    "lower_leg_left",
    "foot_left",
    "upper_leg_right",
    "lower_leg_right",
    "foot_right",
};

struct Bone {
    CoarsePart part;
    Joint from, to;
};

constexpr std::array<Bone, 12> kBones = {{
    {upper_arm_left, Joint::shoulder_left, Joint::elbow_left},
    {lower_arm_left, Joint::elbow_left, Joint::wrist_left},
    {hand_left, Joint::wrist_left, Joint::hand_left},
    {upper_arm_right, Joint::shoulder_right, Joint::elbow_right},
    {lower_arm_right, Joint::elbow_right, Joint::wrist_right},
    {hand_right, Joint::wrist_right, Joint::hand_right},
    {upper_leg_left, Joint::hip_left, Joint::knee_left},
    {lower_leg_left, Joint::knee_left, Joint::ankle_left},
    {foot_left, Joint::ankle_left, Joint::foot_left},
    {upper_leg_right, Joint::hip_right, Joint::knee_right},
    {lower_leg_right, Joint::knee_right, Joint::ankle_right},
    {foot_right, Joint::ankle_right, Joint::foot_right},
}};

double squared_distance(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b) {
    const glm::dvec3 along = b - a;
    const double length2 = glm::dot(along, along);
    const double t = length2 > 0 ? std::clamp(glm::dot(p - a, along) / length2, 0.0, 1.0) : 0.0;
    const glm::dvec3 away = p - (a + t * along);
    return glm::dot(away, away);
}

struct PclMeaning {
    CoarsePart most;
    CoarsePart also;
};

// In the order of PclPart.
constexpr std::array<PclMeaning, kPclPartCount> kOfPcl = {{
    {foot_left, foot_left},
    {lower_leg_left, lower_leg_left},
    {lower_leg_left, upper_leg_left},
    {upper_leg_left, upper_leg_left},
    {foot_right, foot_right},
    {lower_leg_right, lower_leg_right},
    {lower_leg_right, upper_leg_right},
    {upper_leg_right, upper_leg_right},
    {torso, torso},
    {torso, torso},
    {torso, head},
    {upper_arm_right, upper_arm_right},
    {lower_arm_right, upper_arm_right},
    {lower_arm_right, lower_arm_right},
    {hand_right, hand_right},
    {upper_arm_left, upper_arm_left},
    {lower_arm_left, upper_arm_left},
    {lower_arm_left, lower_arm_left},
    {hand_left, hand_left},
    {head, head},
    {head, head},
    {head, head},
    {head, head},
    {torso, torso},
    {torso, torso},
}};

}  // namespace

std::string_view coarse_part_name(CoarsePart part) {
    return kCoarseNames.at(static_cast<std::size_t>(part));
}

CoarsePart coarse_part_at(Joint flesh, const glm::dvec3& point_m,
                          const std::array<glm::dvec3, kJointCount>& joints_m) {
    const auto joint = static_cast<std::size_t>(flesh);
    if (flesh == Joint::head) return head;
    if (joint < static_cast<std::size_t>(Joint::head)) return torso;
    // Joints come in fours per limb, bones in threes.
    const std::size_t limb = (joint - static_cast<std::size_t>(Joint::shoulder_left)) / 4;
    const std::size_t end = (joint - static_cast<std::size_t>(Joint::shoulder_left)) % 4;
    if (end == 3) return kBones[limb * 3 + 2].part;
    CoarsePart nearest = torso;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t b = limb * 3; b < limb * 3 + 3; ++b) {
        const Bone& bone = kBones[b];
        const double d = squared_distance(point_m, joints_m[static_cast<std::size_t>(bone.from)],
                                          joints_m[static_cast<std::size_t>(bone.to)]);
        if (d < least) {
            least = d;
            nearest = bone.part;
        }
    }
    return nearest;
}

CoarsePart coarse_part_of(PclPart part) {
    return kOfPcl.at(static_cast<std::size_t>(part)).most;
}

CoarsePartSet coarse_parts_of(PclPart part) {
    const PclMeaning& meaning = kOfPcl.at(static_cast<std::size_t>(part));
    return static_cast<CoarsePartSet>(coarse_set(meaning.most) | coarse_set(meaning.also));
}

CoarsePart mirrored(CoarsePart part) {
    const auto value = static_cast<int>(part);
    const auto group = [&](int first) { return value >= first && value < first + 3; };
    if (group(2) || group(8)) return static_cast<CoarsePart>(value + 3);
    if (group(5) || group(11)) return static_cast<CoarsePart>(value - 3);
    return part;
}

}  // namespace kino
