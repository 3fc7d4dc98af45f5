#include "skeleton/tracking/part_points.h"

#include <algorithm>
#include <cmath>

namespace kino {
namespace {

// Forests take left for right more often than anything else.
constexpr float kMirrorShare = 0.12f, kLeastShare = 0.02f;

constexpr std::array<PartPlace, kBodyPartCount> kPlaces = [] {
    std::array<PartPlace, kBodyPartCount> p{};
    const auto set = [&p](BodyPart part, Bone bone, float from, float to, float middle,
                          float inward) {
        p[static_cast<std::size_t>(part)] = {bone, from, to, middle, inward};
    };
    using enum BodyPart;
    set(head, Bone::head, 0, 1, 0, 0.07f);
    set(neck, Bone::neck, 0, 1, 0.4f, 0.045f);
    for (int s = 0; s < 2; ++s) {
        const auto part = [s](BodyPart left, int stride) {
            return static_cast<BodyPart>(static_cast<int>(left) + stride * s);
        };
        const auto bone = [s](Bone left, int stride) {
            return static_cast<Bone>(static_cast<int>(left) + stride * s);
        };
        set(part(chest_left, 2), bone(Bone::chest_left, 2), 0, 1, 0.25f, 0.105f);
        set(part(belly_left, 2), bone(Bone::belly_left, 2), 0, 1, 0.35f, 0.105f);
        set(part(upper_arm_left_high, 5), bone(Bone::upper_arm_left, 3), 0, 0.5f, 0.18f, 0.052f);
        set(part(upper_arm_left_low, 5), bone(Bone::upper_arm_left, 3), 0.5f, 1, 0.72f, 0.045f);
        set(part(forearm_left_high, 5), bone(Bone::forearm_left, 3), 0, 0.5f, 0.24f, 0.037f);
        set(part(forearm_left_low, 5), bone(Bone::forearm_left, 3), 0.5f, 1, 0.73f, 0.03f);
        set(part(hand_left, 5), bone(Bone::hand_left, 3), 0, 1, 0.52f, 0.024f);
        set(part(thigh_left_high, 5), bone(Bone::thigh_left, 3), 0, 0.5f, 0.31f, 0.093f);
        set(part(thigh_left_low, 5), bone(Bone::thigh_left, 3), 0.5f, 1, 0.76f, 0.075f);
        set(part(shin_left_high, 5), bone(Bone::shin_left, 3), 0, 0.5f, 0.23f, 0.05f);
        set(part(shin_left_low, 5), bone(Bone::shin_left, 3), 0.5f, 1, 0.69f, 0.042f);
        set(part(foot_left, 5), bone(Bone::foot_left, 3), 0, 1, 0.62f, 0.03f);
    }
    return p;
}();

}  // namespace

const PartPlace& part_place(BodyPart part) {
    return kPlaces[static_cast<std::size_t>(part)];
}

void PartPoints::clear() {
    at_.clear();
    share_.clear();
    best_.clear();
    count_.fill(0);
}

void PartPoints::add(const glm::vec3& at_m, std::span<const float> share) {
    if (!(at_m.z > 0.1f) || !std::isfinite(at_m.x + at_m.y + at_m.z)) return;
    at_.push_back(at_m);
    const auto parts = share.first(kBodyPartCount);
    share_.insert(share_.end(), parts.begin(), parts.end());
    const auto best = static_cast<std::size_t>(std::ranges::max_element(parts) - parts.begin());
    best_.push_back(static_cast<std::uint8_t>(best));
    ++count_[best];
}

void PartPoints::choose(int per_part, std::vector<PartPoint>& out) const {
    out.clear();
    std::array<int, kBodyPartCount> due{};
    for (std::size_t i = 0; i < size(); ++i) {
        const std::size_t best = best_[i];
        const int all = count_[best];
        if (all > per_part) {
            due[best] += per_part;
            if (due[best] < all) continue;
            due[best] -= all;
        }
        PartPoint point;
        point.at_m = at_[i];
        const std::span<const float> shares = share(i);
        const auto consider = [&](std::size_t part, float chance) {
            int place = point.count;
            while (place > 0 &&
                   point.candidate[static_cast<std::size_t>(place - 1)].cost < chance) {
                --place;
            }
            if (place >= PartPoint::kCandidates) return;
            const int last = std::min(point.count, PartPoint::kCandidates - 1);
            for (int k = last; k > place; --k) {
                point.candidate[static_cast<std::size_t>(k)] =
                    point.candidate[static_cast<std::size_t>(k - 1)];
            }
            point.candidate[static_cast<std::size_t>(place)] = {static_cast<std::uint8_t>(part),
                                                                chance};
            point.count = std::min(point.count + 1, PartPoint::kCandidates);
        };
        for (std::size_t part = 0; part < kBodyPartCount; ++part) {
            const auto other = static_cast<std::size_t>(mirrored(static_cast<BodyPart>(part)));
            const float chance = (1 - kMirrorShare) * shares[part] + kMirrorShare * shares[other];
            if (chance > kLeastShare) consider(part, chance);
        }
        for (int k = 0; k < point.count; ++k) {
            float& cost = point.candidate[static_cast<std::size_t>(k)].cost;
            cost = -std::log(cost);
        }
        if (point.count > 0) out.push_back(point);
    }
}

}  // namespace kino
