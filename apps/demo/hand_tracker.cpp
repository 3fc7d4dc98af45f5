#include "apps/demo/hand_tracker.h"

#include <algorithm>
#include <cmath>

#include "apps/demo/easing.h"

namespace kino::demo {
namespace {

// Of GestureDefinitions as they ship, in arm lengths.
constexpr double kSwing = 0.15, kAboveElbow = 0.15, kWaveWindowS = 2;
constexpr double kSwipe = 0.5, kPush = 0.35;
constexpr double kZoneForward = 0.55, kZoneUp = -0.45;
constexpr double kAboveHead = 0.1, kHoldS = 0.6;
constexpr double kSlowS = 0.35;

}  // namespace

void HandTracker::step(double time_s, double dt_s, const Body* body) {
    time_s_ = time_s;
    const auto view = body != nullptr ? space_.view(*body, time_s) : std::nullopt;
    for (std::size_t i = 0; i < 2; ++i) {
        Side& side = sides_[i];
        const bool seen =
            view && view->arm_seen[i] && is_finite(view->hand[i]) && is_finite(view->elbow[i]);
        if (!seen) {
            side = {};
            continue;
        }
        const glm::dvec3& at = view->hand[i];
        if (!side.seen) {
            side.slow = at;
            side.turn_x = at.x;
        }
        side.seen = true;
        side.at = at;
        side.slow += eased(dt_s, kSlowS) * (at - side.slow);
        side.up = at.y > view->elbow[i].y + kAboveElbow;
        side.in_zone = at.z > kZoneForward && at.y > kZoneUp;
        side.raised = view->head_seen && at.y > view->head.y + kAboveHead;
        // An extreme is passed once the hand is back from it by a part of a swing.
        const double off = at.x - side.turn_x;
        if (side.way == 0) {
            if (std::abs(off) > kSwing) {
                side.way = off > 0 ? 1 : -1;
                side.turn_x = at.x;
            }
        } else if (off * side.way > 0) {
            side.turn_x = at.x;
        } else if (std::abs(off) > kSwing) {
            side.way = -side.way;
            side.turn_x = at.x;
            if (side.up) {
                side.turned_s[side.next] = time_s;
                side.next = (side.next + 1) % side.turned_s.size();
            }
        }
    }
    const bool both = sides_[0].raised && sides_[1].raised;
    raised_s_ = both ? raised_s_ + dt_s : 0;
}

double HandTracker::waved() const {
    double most = 0;
    for (const Side& side : sides_) {
        if (!side.seen || !side.up) continue;
        double count = 0.5;  // the hand is up: that is the beginning
        for (const double turned : side.turned_s) count += time_s_ - turned < kWaveWindowS;
        most = std::max(most, count / 4);
    }
    return std::min(most, 1.0);
}

double HandTracker::swiped() const {
    double most = 0;
    for (const Side& side : sides_) {
        if (!side.seen || side.at.y < -0.5) continue;
        most = std::max(most, std::abs(side.at.x - side.slow.x) / kSwipe);
    }
    return std::min(most, 1.0);
}

double HandTracker::pushed() const {
    double most = 0;
    for (const Side& side : sides_) {
        if (!side.seen || side.at.y < -0.7) continue;
        most = std::max(most, (side.at.z - side.slow.z) / kPush);
    }
    return std::clamp(most, 0.0, 1.0);
}

double HandTracker::both_in_zone() const {
    return 0.5 * (sides_[0].in_zone ? 1 : 0) + 0.5 * (sides_[1].in_zone ? 1 : 0);
}

double HandTracker::raised() const {
    const double hands = 0.25 * (sides_[0].raised ? 1 : 0) + 0.25 * (sides_[1].raised ? 1 : 0);
    return std::min(1.0, hands + 0.5 * raised_s_ / kHoldS);
}

std::size_t HandTracker::busier() const {
    if (!sides_[0].seen) return 1;
    if (!sides_[1].seen) return 0;
    return sides_[0].at.y > sides_[1].at.y ? 0 : 1;
}

}  // namespace kino::demo
