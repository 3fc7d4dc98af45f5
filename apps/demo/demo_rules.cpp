#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/demo/demo_state.h"
#include "apps/demo/easing.h"
#include "apps/stage/placing.h"

// What each gesture does. The table for people is in docs/demo.md.

namespace kino {
namespace {

/// A whole change shows in the log once it is this large.
constexpr double kDegrees = 180 / 3.14159265358979323846;
constexpr std::size_t kSprayed = 70;

}  // namespace

const CastMember* DemoPlay::State::member(std::uint32_t id) const {
    for (const CastMember& one : cast.members()) {
        if (id != 0 && one.id == id) return &one;
    }
    return nullptr;
}

Joint DemoPlay::State::seen_hand(Hand hand) const {
    const bool left = (hand == Hand::left) != options.mirror;
    return left ? Joint::hand_left : Joint::hand_right;
}

void DemoPlay::State::praise(const GestureEvent& event) {
    const int place = players.place_of(event.body_id);
    if (place >= 0) {
        coaches[static_cast<std::size_t>(place)].hear(event);
    } else if (event.body_id == ushered) {
        usher.hear(event);
    }
    aura.swell(event.body_id);
}

void DemoPlay::State::engage(std::uint32_t id, bool as_primary) {
    const bool first = !players.anybody();
    const demo::Player* was = players.primary();
    const std::uint32_t before = was != nullptr ? was->id : 0;
    const auto change = as_primary ? players.engage(id) : players.join(id);
    if (change == demo::Players::Change::full) return log("full", {}, id);
    if (change == demo::Players::Change::none) return;
    const auto place = static_cast<std::size_t>(players.place_of(id));
    if (change == demo::Players::Change::joined) {
        coaches[place].reset();
        // Never two in the same colours.
        const std::size_t other = colors[1 - place].palette();
        const bool alone = !players.all()[1 - place].id;
        if (!alone && colors[place].palette() == other) {
            colors[place].turn_to((other + 2) % demo::demo_palettes().size());
        }
    }
    log(as_primary ? "engaged" : "joined", {}, id);
    if (as_primary && before != id) turntable.let_go();
    if (!first) return;
    // The stage comes to where they play.
    if (const CastMember* one = member(id)) {
        if (const auto under = place_under(*one, world_from_depth)) {
            stands_to = *under;
            found_person = true;
        }
    }
}

void DemoPlay::State::change_scene(int by, std::uint32_t id) {
    const auto count = static_cast<int>(acts.size());
    const int next = (static_cast<int>(next_act) + by + count) % count;
    next_act = static_cast<std::size_t>(next);
    curtain.close();
    log("scene", acts[next_act].name, id);
}

void DemoPlay::State::change_palette(int by, std::uint32_t id) {
    const int place = players.place_of(id);
    if (place < 0) return;
    demo::Colors& own = colors[static_cast<std::size_t>(place)];
    const auto count = static_cast<int>(demo::demo_palettes().size());
    const int next = (static_cast<int>(own.palette()) + by + count) % count;
    own.turn_to(static_cast<std::size_t>(next));
    log("palette", demo::demo_palettes()[own.palette()].name, id);
}

void DemoPlay::State::throw_ball(const GestureEvent& event) {
    const int place = players.place_of(event.body_id);
    const Pose& stage = world_from_stage();
    const glm::dvec3 ahead = stage.rotation * glm::dvec3(0, 0, 1);
    const Joint hand = seen_hand(event.hand);
    const double took_s = to_seconds(event.time - event.start_time);
    const auto thrown = throws.of(event.body_id, hand, took_s, ahead);
    if (!thrown) return;
    const Pose stage_from_world = inverse(stage);
    const double rounds = 0.17 * static_cast<double>(balls.thrown());
    const bool flies = balls.throw_ball(stage_from_world * thrown->from_m,
                                        stage_from_world.rotation * thrown->speed_m_s, place,
                                        rounds - std::floor(rounds));
    if (!flies) return;
    log("throw",
        fmt::format("{} hand, {:.1f} m/s", hand_name(event.hand), glm::length(thrown->speed_m_s)),
        event.body_id);
}

void DemoPlay::State::clear(std::uint32_t id) {
    const int place = players.place_of(id);
    const bool all = place >= 0 && players.all()[static_cast<std::size_t>(place)].primary;
    const CastMember* one = member(id);
    glm::dvec3 from = world_from_stage() * glm::dvec3(0, 1.1, 0);
    if (one != nullptr && (*one)[Joint::spine].known) from = (*one)[Joint::spine].world_m;
    const std::size_t lights = painter.burst(all ? -1 : place, from);
    std::size_t gone = 0;
    const Pose& stage = world_from_stage();
    std::erase_if(balls.all(), [&](const demo::Ball& ball) {
        if (!all && ball.painter != place) return false;
        painter.spray(ball.painter, stage * ball.at_m, 6);
        ++gone;
        return true;
    });
    flash = 1;
    log("clear", fmt::format("{} lights, {} balls", lights, gone), id);
}

void DemoPlay::State::hear_continuous(const GestureEvent& event) {
    const int place = players.place_of(event.body_id);
    if (place < 0 || !players.all()[static_cast<std::size_t>(place)].primary) return;
    turntable.hear(event, options.mirror);
    if (event.phase != GesturePhase::end && event.phase != GesturePhase::once) return;
    if (event.kind == GestureKind::rotate) {
        log("turn", fmt::format("{:.0f} degrees", turntable.yaw_to_rad() * kDegrees),
            event.body_id);
    } else {
        log("zoom", fmt::format("{:.2f} of the distance", turntable.zoom_to()), event.body_id);
    }
}

void DemoPlay::State::hear(const GestureEvent& event) {
    const std::uint32_t id = event.body_id;
    if (event.kind == GestureKind::engaged) {
        engage(id, true);
        return praise(event);
    }
    if (event.kind == GestureKind::released) {
        const CastMember* one = member(id);
        if (players.release(id, one != nullptr && one->present)) log("released", {}, id);
        turntable.let_go();
        return;
    }
    if (event.kind == GestureKind::wave) {
        const demo::Player* primary = players.primary();
        if (primary != nullptr && primary->id != id) engage(id, false);
        if (primary != nullptr && primary->id == id) log("wave", {}, id);  // offers the lead
        return praise(event);
    }
    const int place = players.place_of(id);
    if (place < 0) return;
    const bool primary = players.all()[static_cast<std::size_t>(place)].primary;
    switch (event.kind) {
        case GestureKind::swipe_left:
        case GestureKind::swipe_right:
            // The second one has no say in where they both are.
            if (primary) change_scene(event.kind == GestureKind::swipe_left ? 1 : -1, id);
            break;
        case GestureKind::swipe_up:
            change_palette(1, id);
            break;
        case GestureKind::swipe_down:
            change_palette(-1, id);
            break;
        case GestureKind::push:
            throw_ball(event);
            break;
        case GestureKind::raise:
            if (const CastMember* one = member(id); one != nullptr) {
                const CastJoint& hand = (*one)[seen_hand(event.hand)];
                if (hand.known) painter.spray(place, hand.world_m, kSprayed);
            }
            log("fountain", fmt::format("{} hand", hand_name(event.hand)), id);
            break;
        case GestureKind::raise_both:
            clear(id);
            break;
        case GestureKind::zoom:
        case GestureKind::rotate:
            hear_continuous(event);
            break;
        case GestureKind::t_pose:
            if (primary) turntable.straighten();
            if (primary) log("view", "straight", id);
            break;
        case GestureKind::dwell:
            return log("dwell", {}, id);
        case GestureKind::learned:
            log("learned", event.name, id);
            break;
        default:
            break;
    }
    praise(event);
}

}  // namespace kino
