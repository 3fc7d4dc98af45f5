#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "skeleton/gestures/arm_gestures.h"

namespace kino {

namespace {

bool raised(const BodyView& view, std::size_t side, const RaiseDefinition& d) {
    const glm::dvec3 hand = view.hand[side];
    const double aside = std::abs(hand.x - view.shoulder[side].x);
    const double elbow = view.elbow[side].y - view.shoulder[side].y;
    return hand.y - view.head.y > d.hand_above_head && elbow > d.elbow_above_shoulder &&
           aside < d.max_aside;
}

}  // namespace

void PoseGestures::update(const BodyView& view, const std::array<bool, 2>& waving,
                          const GestureDefinitions& d, std::vector<Sighting>& out) {
    if (view.head_seen) raise(view, waving, d.raise, out);
    t_pose(view, d.t_pose, out);
}

bool PoseGestures::held(const BodyView& view, std::size_t side, const RaiseDefinition& d) const {
    if (!up_[side] || view.time_s - since_s_[side] < d.hold_s) return false;
    return std::all_of(way_[side].begin(), way_[side].end(), [&](const auto& place) {
        return glm::distance(place.second, view.hand[side]) <= d.max_stir;
    });
}

void PoseGestures::raise(const BodyView& view, const std::array<bool, 2>& waving,
                         const RaiseDefinition& d, std::vector<Sighting>& out) {
    std::array<double, 2> height{};
    for (std::size_t side = 0; side < 2; ++side) {
        if (!view.arm_seen[side]) continue;
        height[side] = view.hand[side].y - view.head.y;
        if (!up_[side] && raised(view, side, d)) {
            up_[side] = true;
            since_s_[side] = view.time_s;
            way_[side].clear();
        } else if (up_[side] && height[side] < d.release_above_head) {
            up_[side] = told_[side] = told_both_ = false;
        } else if (!told_[side] && !raised(view, side, d)) {
            up_[side] = false;
        }
        if (!up_[side]) continue;
        way_[side].emplace_back(view.time_s, view.hand[side]);
        while (way_[side].front().first < view.time_s - d.hold_s) way_[side].pop_front();
    }
    const auto is_held = [&](std::size_t side) {
        return !told_[side] && !waving[side] && held(view, side, d);
    };
    if (view.time_s < raise_ready_s_) return;
    const std::array<bool, 2> now = {is_held(0), is_held(1)};
    const bool first = now[0] || now[1];
    // Two hands on the way up together are one gesture even if one is a little later.
    if (up_[0] && up_[1]) {
        if (told_both_ || !first) return;
        told_both_ = told_[0] = told_[1] = true;
        out.push_back({GestureKind::raise_both, GesturePhase::once, Hand::both,
                       std::min(since_s_[0], since_s_[1]), std::min(height[0], height[1]) * 2});
    } else if (first) {
        const std::size_t side = now[0] ? 0 : 1;
        told_[side] = true;
        out.push_back({GestureKind::raise, GesturePhase::once, side == 0 ? Hand::left : Hand::right,
                       since_s_[side], height[side] * 2});
    } else {
        return;
    }
    raise_ready_s_ = view.time_s + d.cooldown_s;
}

void PoseGestures::t_pose(const BodyView& view, const TPoseDefinition& d,
                          std::vector<Sighting>& out) {
    if (!view.arm_seen[0] || !view.arm_seen[1]) return;
    double reach = 1e9, off = 0;
    for (std::size_t side = 0; side < 2; ++side) {
        const glm::dvec3 arm = view.hand[side] - view.shoulder[side];
        reach = std::min(reach, side == 0 ? arm.x : -arm.x);
        off = std::max({off, std::abs(arm.y), std::abs(arm.z)});
    }
    if (!tee_ && reach > d.min_reach && off < d.max_off) {
        tee_ = true;
        tee_since_s_ = view.time_s;
    } else if (tee_ && (reach < d.release_reach || off > d.release_off)) {
        tee_ = told_tee_ = false;
    }
    if (!tee_ || told_tee_ || view.time_s - tee_since_s_ < d.hold_s) return;
    told_tee_ = true;
    out.push_back({GestureKind::t_pose, GesturePhase::once, Hand::both, tee_since_s_,
                   2 * (1 - off / d.release_off)});
}

void TwoHandGestures::stop(std::vector<Sighting>& out) {
    if (zoom_)
        out.push_back({GestureKind::zoom, GesturePhase::end, Hand::both, begin_s_, 1, zoom_value_});
    if (rotate_)
        out.push_back(
            {GestureKind::rotate, GesturePhase::end, Hand::both, begin_s_, 1, rotate_value_});
    reset();
}

void TwoHandGestures::update(const BodyView& view, const TwoHandDefinition& d,
                             std::vector<Sighting>& out) {
    std::array<glm::dvec3, 2> hand{};
    bool ready = view.arm_seen[0] && view.arm_seen[1];
    for (std::size_t side = 0; side < 2 && ready; ++side) {
        ready = view.hand[side].z > d.zone_forward && view.hand[side].y > d.zone_up;
        if (!ready) break;
        constexpr double kSmoothingS = 0.1;
        const auto fitted = motion_[side].add(view.time_s, view.hand[side], kSmoothingS);
        hand[side] = fitted ? fitted->place : view.hand[side];
    }
    if (!ready) {
        if (in_zone_ && view.time_s - seen_s_ > d.release_s) stop(out);
        return;
    }
    const glm::dvec3 middle = (hand[0] + hand[1]) * 0.5, line = hand[0] - hand[1];
    const double distance = std::max(glm::length(line), 0.05);
    seen_s_ = view.time_s;
    const double direction = std::atan2(line.y, line.x);
    if (in_zone_) {
        // Unwound, so that a rotation goes on beyond half a turn.
        constexpr double kTurn = 2 * std::numbers::pi;
        angle_ = direction + kTurn * std::round((angle_ - direction) / kTurn);
    }
    const auto settle = [&] {
        base_middle_ = middle;
        base_distance_ = distance;
        base_angle_ = angle_;
    };
    if (!in_zone_) {
        in_zone_ = true;
        since_s_ = view.time_s;
        angle_ = direction;
    }
    if (view.time_s - since_s_ < d.settle_s) {
        settle();
        return;
    }
    if (!active() && glm::distance(middle, base_middle_) > d.max_drift) settle();
    const double stretch = std::abs(distance - base_distance_);
    const double turn = angle_ - base_angle_;
    const auto report = [&](GestureKind kind, bool& on, bool start, double& value, double now) {
        if (!on && !start) return;
        value = now;
        if (!active()) begin_s_ = view.time_s;
        out.push_back({kind, on ? GesturePhase::change : GesturePhase::begin, Hand::both, begin_s_,
                       1, value});
        on = true;
    };
    // Hands close together have no steady direction.
    const bool apart = std::min(distance, base_distance_) > 0.25;
    report(GestureKind::zoom, zoom_, stretch > d.min_stretch, zoom_value_,
           distance / base_distance_);
    report(GestureKind::rotate, rotate_,
           apart && std::abs(turn) > d.min_turn_deg * std::numbers::pi / 180, rotate_value_, turn);
}

}  // namespace kino
