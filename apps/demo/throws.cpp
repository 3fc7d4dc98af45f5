#include "apps/demo/throws.h"

#include "apps/demo/easing.h"

namespace kino::demo {
namespace {

constexpr double kFasterThanHand = 2.2;
constexpr double kLift = 0.16;
constexpr double kStretchS = 0.09;
constexpr double kSlowestHandM_s = 0.25, kFastestHandM_s = 8;

constexpr std::array<Joint, 2> kHands = {Joint::hand_left, Joint::hand_right};

}  // namespace

void Throws::step(double dt_s, std::span<const CastMember> cast) {
    time_s_ += dt_s;
    for (std::size_t i = 0; i < places_.size() && i < cast.size(); ++i) {
        OfPlace& place = places_[i];
        if (place.id != cast[i].id) place = {.id = cast[i].id};
        for (std::size_t side = 0; side < 2; ++side) {
            const CastJoint& hand = cast[i][kHands[side]];
            Path& path = place.hands[side];
            place.known[side] = hand.known;
            place.now[side] = hand.world_m;
            if (!hand.seen) continue;
            const bool soon = path.count > 0 &&
                              time_s_ - path.samples[(path.count - 1) % kSamples].first < kApartS;
            if (soon) continue;
            path.samples[path.count % kSamples] = {time_s_, hand.world_m};
            ++path.count;
        }
    }
}

std::optional<Throws::Thrown> Throws::of(std::uint32_t id, Joint hand, double took_s,
                                         const glm::dvec3& ahead) const {
    const std::size_t side = hand == Joint::hand_left ? 0 : 1;
    for (const OfPlace& place : places_) {
        if (place.id != id || id == 0 || !place.known[side]) continue;
        took_s = std::isfinite(took_s) ? std::clamp(took_s, 0.12, 0.7) : 0.3;
        const Path& path = place.hands[side];
        // Along the fastest stretch of that time: at its ends the hand rests.
        glm::dvec3 fastest(0);
        const std::size_t kept = std::min(path.count, kSamples);
        const auto sample = [&](std::size_t k) {
            return path.samples[(path.count - 1 - k) % kSamples];
        };
        for (std::size_t k = 0; k < kept; ++k) {
            const auto& [to_s, to_m] = sample(k);
            if (time_s_ - to_s > took_s + kApartS) break;
            for (std::size_t before = k + 1; before < kept; ++before) {
                const auto& [from_s, from_m] = sample(before);
                if (to_s - from_s < kStretchS) continue;
                const glm::dvec3 speed = (to_m - from_m) / (to_s - from_s);
                // Joints that jump are not hands.
                const double fast = glm::length(speed);
                if (fast > glm::length(fastest) && fast < kFastestHandM_s) fastest = speed;
                break;
            }
        }
        const double hand_speed = glm::length(fastest);
        const bool moved = hand_speed > kSlowestHandM_s;
        glm::dvec3 direction = moved ? fastest / hand_speed : ahead;
        direction.y += kLift;
        direction = glm::normalize(direction);
        const double speed =
            moved ? std::clamp(kFasterThanHand * hand_speed, kLeastM_s, kMostM_s) : kLeastM_s;
        if (!is_finite(place.now[side]) || !is_finite(direction)) return std::nullopt;
        return Thrown{.from_m = place.now[side], .speed_m_s = speed * direction};
    }
    return std::nullopt;
}

}  // namespace kino::demo
