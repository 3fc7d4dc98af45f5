#include "apps/demo/coach.h"

#include <utility>

#include "apps/demo/easing.h"

namespace kino::demo {
namespace {

constexpr std::array<DemoHint, 5> kLessonOf = {DemoHint::paint, DemoHint::swipe, DemoHint::push,
                                               DemoHint::two_hands, DemoHint::raise_both};
constexpr double kPaintedM = 1.5;

double distance_of(const Body& body) {
    for (const Joint joint : {Joint::spine, Joint::hip_center, Joint::shoulder_center, Joint::head,
                              Joint::shoulder_left, Joint::shoulder_right}) {
        if (body[joint].state == JointState::lost) continue;
        const glm::dvec3 at(body[joint].position_m);
        const double far = std::hypot(at.x, at.z);
        if (std::isfinite(far) && far < 50) return far;
    }
    return 0;
}

bool ends(const GestureEvent& event) {
    return event.phase == GesturePhase::once || event.phase == GesturePhase::end;
}

}  // namespace

void Coach::learn(DemoHint hint) {
    for (std::size_t i = 0; i < kLessons; ++i) {
        if (kLessonOf[i] == hint) learned_[i] = true;
    }
}

void Coach::hear(const GestureEvent& event) {
    if (event.kind == GestureKind::released || event.kind == GestureKind::dwell) return;
    guidance_.praised = event.kind;
    guidance_.praised_ago_s = 0;
    just_praised_ = true;
    switch (event.kind) {
        case GestureKind::swipe_left:
        case GestureKind::swipe_right:
        case GestureKind::swipe_up:
        case GestureKind::swipe_down:
            return learn(DemoHint::swipe);
        case GestureKind::push:
            return learn(DemoHint::push);
        case GestureKind::zoom:
        case GestureKind::rotate:
            if (ends(event)) learn(DemoHint::two_hands);
            return;
        case GestureKind::raise_both:
            return learn(DemoHint::raise_both);
        default:
            return;
    }
}

DemoHint Coach::lesson(bool primary) {
    for (std::size_t tried = 0; tried < kLessons; ++tried) {
        const DemoHint hint = kLessonOf[at_];
        const bool theirs = primary || (hint != DemoHint::two_hands && hint != DemoHint::swipe);
        const bool tired = guidance_.hint == hint && guidance_.shown_s > kPatienceS;
        if (!learned_[at_] && theirs && !tired) return hint;
        at_ = (at_ + 1) % kLessons;
    }
    // The only one left, though it was shown for long.
    const bool theirs =
        primary || (kLessonOf[at_] != DemoHint::two_hands && kLessonOf[at_] != DemoHint::swipe);
    return !learned_[at_] && theirs ? kLessonOf[at_] : DemoHint::none;
}

double Coach::progress(const Moment& moment) const {
    switch (guidance_.hint) {
        case DemoHint::wave_to_start:
            return hands_.waved();
        case DemoHint::paint:
            return std::clamp(moment.painted_m / kPaintedM, 0.0, 1.0);
        case DemoHint::swipe:
            return hands_.swiped();
        case DemoHint::push:
            return hands_.pushed();
        case DemoHint::two_hands:
            return hands_.both_in_zone();
        case DemoHint::raise_both:
            return hands_.raised();
        case DemoHint::step_back:
            return std::clamp(guidance_.distance_m / kTooNearM, 0.0, 1.0);
        case DemoHint::step_closer:
            return std::clamp(kTooFarM / std::max(guidance_.distance_m, kTooFarM), 0.0, 1.0);
        default:
            return 0;
    }
}

void Coach::anchor(const Moment& moment) {
    guidance_.anchor_m.reset();
    guidance_.hand = Hand::none;
    if (moment.member == nullptr || guidance_.hint == DemoHint::none) return;
    const auto of = [&](Joint joint) -> std::optional<glm::dvec3> {
        const CastJoint& at = (*moment.member)[joint];
        if (!at.known || !is_finite(at.world_m)) return std::nullopt;
        return at.world_m;
    };
    const auto of_hand = [&](std::size_t side) {
        guidance_.hand = side == 0 ? Hand::left : Hand::right;
        const bool on_left = (side == 0) != moment.mirror;
        return of(on_left ? Joint::hand_left : Joint::hand_right);
    };
    switch (guidance_.hint) {
        case DemoHint::wave_to_start:
        case DemoHint::paint:
        case DemoHint::swipe:
        case DemoHint::push:
            guidance_.anchor_m = of_hand(hands_.busier());
            break;
        case DemoHint::two_hands:
            guidance_.hand = Hand::both;
            guidance_.anchor_m = of(Joint::shoulder_center);
            break;
        case DemoHint::raise_both:
            guidance_.hand = Hand::both;
            guidance_.anchor_m = of(Joint::head);
            break;
        default:
            guidance_.anchor_m = of(Joint::head);
            break;
    }
    for (const Joint joint : {Joint::head, Joint::shoulder_center, Joint::spine}) {
        if (!guidance_.anchor_m) guidance_.anchor_m = of(joint);
    }
}

void Coach::step(const Moment& moment) {
    if (!std::exchange(just_praised_, false)) guidance_.praised_ago_s += moment.dt_s;
    hands_.step(moment.time_s, moment.dt_s, moment.body);
    if (moment.body != nullptr) {
        const double distance = distance_of(*moment.body);
        if (distance > 0) guidance_.distance_m = distance;
    } else if (moment.phase == DemoPhase::attract) {
        guidance_.distance_m = 0;
    }
    const double distance = guidance_.distance_m;
    near_ = distance > 0 && distance < kTooNearM + (near_ ? kSlackM : 0);
    far_ = distance > kTooFarM - (far_ ? kSlackM : 0);
    if (moment.painted_m >= kPaintedM) learn(DemoHint::paint);

    DemoHint hint = DemoHint::none;
    switch (moment.phase) {
        case DemoPhase::lost:
            break;
        case DemoPhase::attract:
            hint = DemoHint::step_into_view;
            break;
        case DemoPhase::invite:
        case DemoPhase::playing:
            if (near_) {
                hint = DemoHint::step_back;
            } else if (far_) {
                hint = DemoHint::step_closer;
            } else {
                hint = moment.phase == DemoPhase::invite ? DemoHint::wave_to_start
                                                         : lesson(moment.primary);
            }
            break;
    }
    guidance_.shown_s = hint == guidance_.hint ? guidance_.shown_s + moment.dt_s : 0;
    guidance_.hint = hint;
    guidance_.progress = progress(moment);
    anchor(moment);
}

}  // namespace kino::demo
