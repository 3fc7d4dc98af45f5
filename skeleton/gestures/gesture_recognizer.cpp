#include "skeleton/gestures/gesture_recognizer.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <utility>

namespace kino {
namespace {

constexpr double kForgetS = 2.0, kPathS = 8.0, kWalkWindowS = 0.4, kSettledS = 0.1;
constexpr int kDurations = 6;

double stroke_cooldown(const GestureDefinitions& d, GestureKind kind) {
    switch (kind) {
        case GestureKind::wave:
            return d.wave.cooldown_s;
        case GestureKind::push:
        case GestureKind::swipe_left:
        case GestureKind::swipe_right:
        case GestureKind::swipe_up:
        case GestureKind::swipe_down:
            return d.stroke.cooldown_s;
        default:
            return 0;
    }
}

}  // namespace

GestureRecognizer::GestureRecognizer(GestureDefinitions definitions)
    : definitions_(std::move(definitions)) {}

bool GestureRecognizer::walking(Person& person, const BodyView& view) const {
    auto& trunk = person.trunk;
    trunk.emplace_back(view.time_s, view.trunk_m);
    while (trunk.front().first < view.time_s - kWalkWindowS) trunk.pop_front();
    const double span_s = view.time_s - trunk.front().first;
    if (span_s < kWalkWindowS / 2) return false;
    const double way = glm::distance(view.trunk_m, trunk.front().second) / view.arm_m;
    return way / span_s > definitions_.tracking.max_walk_per_s;
}

void GestureRecognizer::rest(Person& person, std::vector<Sighting>& out) {
    person.two_hands.stop(out);
    for (ArmGestures& arm : person.arms) arm.reset();
    person.poses.reset();
    person.path.samples.clear();
    for (Candidate& c : person.learned) c = {1e9, 0, 0, c.ready_s};
}

void GestureRecognizer::match(Person& person, const BodyView& view,
                              std::vector<Sighting>& out) const {
    const auto& samples = person.path.samples;
    person.learned.resize(definitions_.learned.size());
    for (std::size_t i = 0; i < definitions_.learned.size(); ++i) {
        const GestureTemplate& gesture = definitions_.learned[i];
        Candidate& candidate = person.learned[i];
        for (int k = 0; k < kDurations; ++k) {
            const double w = static_cast<double>(k) / (kDurations - 1);
            const double from_s =
                view.time_s - (gesture.least_s() * (1 - w) + gesture.most_s() * w);
            if (samples.front().time_s > from_s || from_s < candidate.ready_s) continue;
            const auto first =
                std::lower_bound(samples.begin(), samples.end(), from_s,
                                 [](const HandPath::Sample& s, double t) { return s.time_s < t; });
            const double distance = gesture.distance(HandPath{{first, samples.end()}});
            if (distance < candidate.distance && distance < gesture.threshold())
                candidate = {distance, from_s, view.time_s, candidate.ready_s};
        }
        if (candidate.distance > 1 || view.time_s - candidate.time_s < kSettledS) continue;
        out.push_back({GestureKind::learned, GesturePhase::once, gesture.hand(), candidate.start_s,
                       2 * (1 - candidate.distance / gesture.threshold()), 0, gesture.name()});
        candidate = {1e9, 0, 0, candidate.time_s};
    }
}

void GestureRecognizer::observe(Person& person, const Body& body, double time_s,
                                std::vector<Sighting>& out) {
    if (time_s - person.seen_s > definitions_.tracking.max_gap_s) {
        rest(person, out);
        person.trunk.clear();
    }
    const auto view = person.space.view(body, time_s);
    person.here = view.has_value();
    if (!view) return;
    person.seen_s = time_s;
    person.distance_m = glm::length(view->trunk_m);
    person.confidence = std::max(view->confidence[0], view->confidence[1]);
    const double turn_deg = view->turn_rad * 180 / std::numbers::pi;
    if (walking(person, *view) || turn_deg > definitions_.tracking.max_turn_deg) {
        rest(person, out);
        return;
    }
    for (ArmGestures& arm : person.arms) arm.update(*view, definitions_, out);
    const std::array<bool, 2> waving = {person.arms[0].waving(), person.arms[1].waving()};
    person.poses.update(*view, waving, definitions_, out);
    person.two_hands.update(*view, definitions_.two_hand, out);
    if (view->arm_seen[0] && view->arm_seen[1]) {
        auto& samples = person.path.samples;
        samples.push_back({time_s, view->hand});
        if (samples.front().time_s < time_s - 2 * kPathS)
            std::erase_if(samples, [&](const auto& s) { return s.time_s < time_s - kPathS; });
        match(person, *view, out);
    }
}

std::vector<GestureEvent> GestureRecognizer::update(const BodyFrame& frame) {
    std::vector<GestureEvent> events;
    if (started_ && frame.time == time_) return events;
    if (!started_ || frame.time < time_) {
        people_.clear();
        primary_ = {};
    }
    started_ = true;
    time_ = frame.time;
    const double now_s = to_seconds(frame.time);
    const auto tell = [&](std::uint32_t id, const Sighting& s, float seen) {
        GestureEvent event{s.kind, s.phase, s.hand, id, id == primary_.id(), frame.time};
        event.start_time = std::min(frame.time, from_seconds(s.start_s));
        event.confidence =
            static_cast<float>(0.5 + 0.5 * std::clamp(s.margin, 0.0, 1.0)) * (0.5f + 0.5f * seen);
        event.value = s.value;
        event.name = s.name;
        events.push_back(std::move(event));
    };

    for (auto& [id, person] : people_) person.here = false;
    std::vector<std::pair<std::uint32_t, std::vector<Sighting>>> seen;
    for (const Body& body : frame.bodies) {
        if (body.id == 0) continue;
        const auto [entry, fresh] = people_.try_emplace(body.id);
        Person& person = entry->second;
        if (fresh) person.seen_s = now_s;
        if (person.here) continue;  // the same id twice: the first counts
        observe(person, body, now_s, seen.emplace_back(body.id, std::vector<Sighting>{}).second);
    }

    const std::uint32_t before = primary_.id();
    const auto at = people_.find(before);
    const bool there = at != people_.end() && at->second.here;
    if (primary_.update(frame.time, there, there ? at->second.distance_m : 0, definitions_.primary))
        tell(before, {GestureKind::released, GesturePhase::once, Hand::none, now_s, 1}, 1);

    for (auto& [id, sightings] : seen) {
        Person& person = people_.at(id);
        const float joints = person.confidence;
        for (const Sighting& s : sightings) {
            if (s.phase == GesturePhase::once) {
                double& ready_s = person.ready_s[s.kind];
                if (now_s < ready_s) continue;
                ready_s = now_s + stroke_cooldown(definitions_, s.kind);
                if (s.kind != GestureKind::dwell)
                    for (ArmGestures& arm : person.arms) arm.calm_dwell();
            }
            const std::uint32_t was = primary_.id();
            if (s.kind == GestureKind::wave &&
                primary_.wave(id, frame.time, person.distance_m, definitions_.primary)) {
                const Sighting change{GestureKind::released, GesturePhase::once, s.hand, now_s, 1};
                if (was != 0) tell(was, change, 1);
                tell(id, s, joints);
                tell(id, {GestureKind::engaged, GesturePhase::once, s.hand, s.start_s, 1}, 1);
                continue;
            }
            tell(id, s, joints);
        }
    }
    for (auto it = people_.begin(); it != people_.end();) {
        if (now_s - it->second.seen_s <= kForgetS) {
            ++it;
            continue;
        }
        std::vector<Sighting> ended;
        rest(it->second, ended);
        for (const Sighting& s : ended) tell(it->first, s, 0);
        it = people_.erase(it);
    }
    return events;
}

HandPath GestureRecognizer::recent_hands(std::uint32_t body_id, double seconds) const {
    HandPath out;
    const auto found = people_.find(body_id);
    if (found == people_.end()) return out;
    for (const HandPath::Sample& s : found->second.path.samples)
        if (s.time_s >= to_seconds(time_) - seconds) out.samples.push_back(s);
    return out;
}

}  // namespace kino
