#include "skeleton/tracking/pose_guess.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

namespace kino {
namespace {

using glm::vec3;

const PartMode* best(const PartModes& modes, BodyPart part) {
    constexpr float kLeastM2 = 0.0008f;
    const auto& list = modes.of(part);
    return list.empty() || list[0].weight_m2 < kLeastM2 ? nullptr : list.data();
}

BodyPart of_side(BodyPart left, int stride, int side) {
    return static_cast<BodyPart>(static_cast<int>(left) + stride * side);
}

struct Mean {
    vec3 sum{0};
    float weight = 0;
    void add(const vec3& v, float w) {
        sum += v * w;
        weight += w;
    }
    [[nodiscard]] vec3 value() const { return sum / weight; }
};

}  // namespace

PoseGuess guess_pose(const PartModes& modes, const BodyShape& shape, const vec3& up,
                     float turn_rad) {
    using enum BodyPart;
    const float torso = shape[Length::torso];
    Mean top, low, chest, belly;
    float left_weight = 0, right_weight = 0;
    vec3 across(0);
    const auto pair = [&](BodyPart left, int stride, float w) {
        const PartMode* l = best(modes, left);
        const PartMode* r = best(modes, of_side(left, stride, 1));
        if (l && r) across += (l->center_m - r->center_m) * w;
        if (l) left_weight += l->weight_m2;
        if (r) right_weight += r->weight_m2;
    };
    pair(chest_left, 2, 1);
    pair(belly_left, 2, 1);
    pair(upper_arm_left_high, 5, 0.7f);
    pair(thigh_left_high, 5, 0.7f);
    for (int side = 0; side < 2; ++side) {
        if (const PartMode* m = best(modes, of_side(chest_left, 2, side))) {
            chest.add(m->center_m, m->weight_m2);
        }
        if (const PartMode* m = best(modes, of_side(belly_left, 2, side))) {
            belly.add(m->center_m, m->weight_m2);
        }
        if (const PartMode* m = best(modes, of_side(thigh_left_high, 5, side))) {
            low.add(m->center_m, 0.3f * m->weight_m2);
        }
    }
    if (const PartMode* m = best(modes, head)) top.add(m->center_m, m->weight_m2);
    if (const PartMode* m = best(modes, neck)) top.add(m->center_m, m->weight_m2);
    if (chest.weight > 0) (belly.weight > 0 ? top : low).add(chest.value(), chest.weight);
    if (belly.weight > 0) low.add(belly.value(), belly.weight);
    if (chest.weight + belly.weight + top.weight <= 0) return {};
    const vec3 axis =
        top.weight > 0 && low.weight > 0 ? unit_or(top.value() - low.value() + up * 0.05f, up) : up;
    Mean hips;
    if (belly.weight > 0) hips.add(belly.value() - axis * (0.03f * torso), belly.weight);
    if (chest.weight > 0) hips.add(chest.value() - axis * (0.32f * torso), 0.5f * chest.weight);
    if (hips.weight <= 0) {
        if (const PartMode* m = best(modes, head)) {
            hips.add(m->center_m - axis * (0.66f * torso), m->weight_m2);
        } else {
            return {};
        }
    }
    const vec3 hips_m = hips.value();
    const vec3 view = unit_or(hips_m, vec3(0, 0, 1));
    // The side that shows more is the nearer one.
    const float turned = (left_weight - right_weight) / (left_weight + right_weight + 1e-6f);
    vec3 left = across - view * glm::dot(across, view) * 0.5f - view * (0.35f * turned);
    if (glm::dot(left, left) < 1e-4f) left = glm::cross(axis, -view);
    PoseGuess guess;
    guess.usable = true;
    const glm::mat3 frame = rotation_of(axis * turn_rad) * frame_of(axis, left);
    guess.pose = resting_pose(hips_m, frame[1], frame[2]);
    if (const PartMode* h = best(modes, head); h && chest.weight > 0) {
        guess.pose[Segment::neck] =
            unit_or(h->center_m - (hips_m + axis * (0.47f * torso)), guess.pose[Segment::neck]);
    }
    for (int limb = 0; limb < 4; ++limb) static_cast<void>(guess_limb(modes, limb, guess.pose));
    return guess;
}

bool guess_limb(const PartModes& modes, int limb, JointedPose& pose) {
    using enum BodyPart;
    const int side = limb % 2;
    const BodyPart first = limb < 2 ? upper_arm_left_high : thigh_left_high;
    std::array<const PartMode*, 5> seen{};
    int count = 0;
    for (int k = 0; k < 5; ++k) {
        const auto part = static_cast<BodyPart>(static_cast<int>(first) + 5 * side + k);
        seen[static_cast<std::size_t>(k)] = best(modes, part);
        count += seen[static_cast<std::size_t>(k)] ? 1 : 0;
    }
    if (count < 2) return false;
    const Segment upper =
        segment_of(limb < 2 ? Segment::upper_arm_left : Segment::thigh_left, side);
    const auto segment = [upper](int k) {
        return static_cast<Segment>(static_cast<int>(upper) + k);
    };
    // The first pair of parts that tells a direction.
    const auto between = [&](std::initializer_list<std::pair<int, int>> pairs, vec3& direction) {
        for (const auto& [from, to] : pairs) {
            const PartMode* a = seen[static_cast<std::size_t>(from)];
            const PartMode* b = seen[static_cast<std::size_t>(to)];
            if (!a || !b) continue;
            const vec3 way = b->center_m - a->center_m;
            if (glm::dot(way, way) < 0.03f * 0.03f) continue;
            direction = glm::normalize(way);
            return true;
        }
        return false;
    };
    bool told = between({{0, 1}, {0, 2}, {1, 2}}, pose[segment(0)]);
    const bool lower = between({{2, 3}, {2, 4}, {1, 3}, {3, 4}, {1, 4}}, pose[segment(1)]);
    told = told || lower;
    if (limb < 2) {
        if (!between({{3, 4}, {2, 4}}, pose[segment(2)]) && lower)
            pose[segment(2)] = pose[segment(1)];
    }
    return told;
}

JointedPose mirrored(const JointedPose& pose) {
    JointedPose other = pose;
    for (const Segment left : {Segment::upper_arm_left, Segment::forearm_left, Segment::hand_left,
                               Segment::thigh_left, Segment::shin_left, Segment::foot_left}) {
        std::swap(other[left], other[segment_of(left, 1)]);
    }
    for (glm::mat3* frame : {&other.pelvis, &other.chest}) {
        (*frame)[0] = -(*frame)[0];
        (*frame)[2] = -(*frame)[2];
    }
    return other;
}

}  // namespace kino
