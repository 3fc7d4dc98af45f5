#include "apps/demo/throws.h"

#include "apps/demo/easing.h"

namespace kino::demo {
namespace {

constexpr double kFasterThanHand = 2.2;
constexpr double kLift = 0.16;
constexpr double kLeastWayM = 0.06;

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
        // The way from the farthest place of that time to where it is now.
        glm::dvec3 way(0);
        double since = took_s;
        const std::size_t kept = std::min(path.count, kSamples);
        for (std::size_t k = 0; k < kept; ++k) {
            const auto& [at_s, at_m] = path.samples[(path.count - 1 - k) % kSamples];
            if (time_s_ - at_s > took_s + kApartS) break;
            const glm::dvec3 to_here = place.now[side] - at_m;
            if (glm::length(to_here) > glm::length(way)) {
                way = to_here;
                since = std::max(time_s_ - at_s, 0.1);
            }
        }
        const double length = glm::length(way);
        const bool moved = length > kLeastWayM;
        glm::dvec3 direction = moved ? way / length : ahead;
        direction.y += kLift;
        direction = glm::normalize(direction);
        const double speed =
            moved ? std::clamp(kFasterThanHand * length / since, kLeastM_s, kMostM_s) : kLeastM_s;
        if (!is_finite(place.now[side]) || !is_finite(direction)) return std::nullopt;
        return Thrown{.from_m = place.now[side], .speed_m_s = speed * direction};
    }
    return std::nullopt;
}

}  // namespace kino::demo
