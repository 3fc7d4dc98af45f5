#include "skeleton/gestures/arm_gestures.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace kino {
namespace {
Hand hand_of(std::size_t side) {
    return side == 0 ? Hand::left : Hand::right;
}
}  // namespace

void ArmGestures::reset() {
    const double wave_ready_s = wave_ready_s_, stroke_ready_s = stroke_ready_s_;
    *this = ArmGestures(side_);
    wave_ready_s_ = wave_ready_s;
    stroke_ready_s_ = stroke_ready_s;
}

void ArmGestures::update(const BodyView& view, const GestureDefinitions& d,
                         std::vector<Sighting>& out) {
    if (!view.arm_seen[side_]) {
        if (view.time_s - seen_s_ > d.tracking.max_gap_s) reset();
        return;
    }
    if (view.time_s - seen_s_ > d.tracking.max_gap_s) reset();
    seen_s_ = view.time_s;
    const glm::dvec3 hand = view.hand[side_], elbow = view.elbow[side_];
    // Both hands in the air is another gesture, however they swing.
    const std::size_t other = 1 - side_;
    const bool other_up =
        view.arm_seen[other] && view.head_seen && view.hand[other].y > view.head.y;
    if (const auto swing = against_elbow_.add(view.time_s, hand - elbow, d.tracking.smoothing_s))
        wave(*swing, !other_up, d.wave, out);
    const auto fitted = motion_.add(view.time_s, hand, d.tracking.smoothing_s);
    if (!fitted) return;
    if (const auto done = motion_.cut(*fitted, d.stroke)) stroke(*done, d, out);
    dwell(*fitted, d.dwell, out);
}

void ArmGestures::wave(const HandSample& hand, bool alone, const WaveDefinition& d,
                       std::vector<Sighting>& out) {
    if (!alone || hand.place.y < d.hand_above_elbow) {
        direction_ = 0;
        reversals_.clear();
        turn_x_ = hand.place.x;
        return;
    }
    const double x = hand.place.x;
    while (!reversals_.empty() && hand.time_s - reversals_.front().time_s > d.window_s)
        reversals_.pop_front();
    if (direction_ == 0) {
        if (std::abs(x - turn_x_) >= d.min_swing) {
            from_x_ = turn_x_;
            direction_ = x > turn_x_ ? 1 : -1;
            turn_x_ = x;
            turn_s_ = hand.time_s;
        }
        return;
    }
    if ((x - turn_x_) * direction_ > 0) {
        turn_x_ = x;
        turn_s_ = hand.time_s;
        return;
    }
    if (std::abs(x - turn_x_) < d.min_swing) return;
    direction_ = -direction_;
    reversals_.push_back({turn_s_, std::abs(turn_x_ - from_x_)});
    from_x_ = turn_x_;
    turn_x_ = x;
    const auto large = std::count_if(reversals_.begin(), reversals_.end(),
                                     [&](const Reversal& r) { return r.swing >= d.large_swing; });
    if (static_cast<double>(reversals_.size()) < d.reversals &&
        static_cast<double>(large) < d.large_reversals)
        return;
    if (hand.time_s >= wave_ready_s_) {
        const double first_s = reversals_.front().time_s;
        out.push_back({GestureKind::wave, GesturePhase::once, hand_of(side_), first_s,
                       0.5 + (d.window_s - (hand.time_s - first_s)) / d.window_s});
    }
    // While it goes on it is the same wave.
    wave_ready_s_ = hand.time_s + d.cooldown_s;
}

void ArmGestures::stroke(const Stroke& stroke, const GestureDefinitions& d,
                         std::vector<Sighting>& out) {
    const double span_s = stroke.to.time_s - stroke.from.time_s;
    if (span_s < d.stroke.min_s || span_s > d.stroke.max_s || stroke.to.time_s < stroke_ready_s_)
        return;
    const glm::dvec3 way = stroke.to.place - stroke.from.place;
    const glm::dvec3 size = glm::abs(way);
    const auto tell = [&](GestureKind kind, double travel, double least) {
        stroke_ready_s_ = stroke.to.time_s + d.stroke.cooldown_s;
        out.push_back({kind, GesturePhase::once, hand_of(side_), stroke.from.time_s,
                       2 * (travel / least - 1)});
    };
    if (way.z >= d.push.min_travel && std::max(size.x, size.y) <= d.push.max_aside * way.z &&
        stroke.to.place.z >= d.push.min_reach && stroke.low.y >= d.push.zone_up) {
        tell(GestureKind::push, way.z, d.push.min_travel);
        return;
    }
    const bool sideways = size.x > size.y;
    const double along = std::max(size.x, size.y), across = std::min(size.x, size.y);
    if (along < d.swipe.min_travel || across > d.swipe.max_across * along ||
        size.z > d.swipe.max_depth * along || stroke.low.z < d.swipe.zone_forward ||
        stroke.low.y < d.swipe.zone_up)
        return;
    const GestureKind kind = sideways
                                 ? (way.x > 0 ? GestureKind::swipe_left : GestureKind::swipe_right)
                                 : (way.y > 0 ? GestureKind::swipe_up : GestureKind::swipe_down);
    tell(kind, along, d.swipe.min_travel);
}

void ArmGestures::dwell(const HandSample& hand, const DwellDefinition& d,
                        std::vector<Sighting>& out) {
    if (hand.place.z < d.zone_forward || hand.place.y < d.zone_up) {
        dwelling_ = dwelled_ = false;
        return;
    }
    const double off = glm::distance(hand.place, dwell_at_);
    if (!dwelling_ || off > (dwelled_ ? d.release_radius : d.radius)) {
        // The gesture that ended in this place is still at rest here until it moves on.
        if (dwelling_) dwelled_ = false;
        dwelling_ = true;
        dwell_at_ = hand.place;
        dwell_from_s_ = hand.time_s;
        return;
    }
    if (dwelled_ || hand.time_s - dwell_from_s_ < d.hold_s) return;
    dwelled_ = true;
    out.push_back({GestureKind::dwell, GesturePhase::once, hand_of(side_), dwell_from_s_,
                   1 - off / d.radius});
}

}  // namespace kino
