#include "apps/demo/demo_play.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "apps/demo/demo_state.h"
#include "apps/demo/easing.h"
#include "apps/stage/stage_shapes.h"
#include "base/check.h"

namespace kino {
namespace {

constexpr double kLongestS = 0.1;
/// Somebody who is not seen for so long is gone.
constexpr double kGoneS = 0.8;
constexpr double kFlashS = 0.5;
constexpr double kUnknownM = 100;
constexpr std::size_t kMostEvents = 4096;  // that nobody took

}  // namespace

const char* demo_phase_name(DemoPhase phase) {
    switch (phase) {
        case DemoPhase::attract:
            return "attract";
        case DemoPhase::invite:
            return "invite";
        case DemoPhase::playing:
            return "playing";
        case DemoPhase::lost:
            return "lost";
    }
    return "?";
}

const char* demo_hint_name(DemoHint hint) {
    switch (hint) {
        case DemoHint::none:
            return "none";
        case DemoHint::step_into_view:
            return "step_into_view";
        case DemoHint::step_back:
            return "step_back";
        case DemoHint::step_closer:
            return "step_closer";
        case DemoHint::wave_to_start:
            return "wave_to_start";
        case DemoHint::paint:
            return "paint";
        case DemoHint::swipe:
            return "swipe";
        case DemoHint::push:
            return "push";
        case DemoHint::two_hands:
            return "two_hands";
        case DemoHint::raise_both:
            return "raise_both";
    }
    return "?";
}

DemoPlay::State::State(DemoOptions chosen)
    : options(std::move(chosen)),
      painter(options.seed),
      ball_mesh(make_stage_shape(SceneShape::sphere, glm::dvec3(1))) {
    // Bodies are mirrored before anything else sees them.
    if (options.avatar) avatars = std::make_unique<AvatarTroupe>(options.avatar, AvatarOptions{});
}

void DemoPlay::State::reset() {
    cast.clear();
    players.clear();
    for (std::size_t i = 0; i < colors.size(); ++i) colors[i].set(2 * i);
    painter.reset();
    balls = demo::Balls();
    aura.reset();
    if (avatars) avatars->reset();
    throws.reset();
    turntable.reset();
    curtain.open();
    for (demo::Coach& coach : coaches) coach.reset();
    usher.reset();
    ushered = 0;
    act = next_act = 0;
    acts[act].director->reset();
    acts[act].director->set_tint({});
    balls.set_solids(acts[act].solids);
    phase = DemoPhase::attract;
    lost = placed = found_person = following = warm_ready = false;
    time = 0;
    time_s = empty_s = flash = undrawn_s = 0;
    bodies = {};
    leads.clear();
    world_from_depth = world_from_camera_axes();
    events.clear();
    seen.reset();
    cut.reset();
    live.reset();
    scene = warm = {};
    local_lights = 0;
}

void DemoPlay::State::log(const char* what, std::string detail, std::uint32_t id) {
    if (events.size() >= kMostEvents) events.erase(events.begin());
    events.push_back({.time = time, .what = what, .detail = std::move(detail), .body_id = id});
}

void DemoPlay::State::find_phase(double dt_s) {
    empty_s = cast.anybody() ? 0 : empty_s + dt_s;
    const DemoPhase before = phase;
    if (lost) {
        phase = DemoPhase::lost;
    } else if (players.anybody()) {
        phase = DemoPhase::playing;
    } else if (cast.anybody() || (empty_s < kGoneS && before != DemoPhase::attract)) {
        phase = DemoPhase::invite;
    } else {
        phase = DemoPhase::attract;
    }
    if (phase == before) return;
    if (phase == DemoPhase::attract) {
        log("alone", {}, 0);
        turntable.straighten();
    }
    if (before == DemoPhase::attract && phase != DemoPhase::lost) log("visitor", {}, 0);
}

void DemoPlay::State::guide(double dt_s, const DemoMoment& moment) {
    const auto body_of = [&](std::uint32_t id) -> const Body* {
        if (moment.bodies == nullptr || lost || id == 0) return nullptr;
        for (const Body& body : moment.bodies->bodies) {
            if (body.id == id) return &body;
        }
        return nullptr;
    };
    for (std::size_t i = 0; i < coaches.size(); ++i) {
        const demo::Player& player = players.all()[i];
        if (player.id == 0) continue;
        // With nobody in the lead, a wave is what comes next.
        const bool led = players.primary() != nullptr || phase != DemoPhase::playing;
        coaches[i].step({.time_s = time_s,
                         .dt_s = dt_s,
                         .phase = led ? phase : DemoPhase::invite,
                         .body = body_of(player.id),
                         .member = member(player.id),
                         .mirror = options.mirror,
                         .primary = player.primary,
                         .painted_m = painter.painted_m(static_cast<int>(i))});
    }
    // The nearest one is shown how to begin, until they leave.
    const CastMember* first = member(ushered);
    if (ushered != 0 && (first == nullptr || !first->present)) ushered = 0;
    if (ushered == 0) {
        double nearest = std::numeric_limits<double>::max();
        for (const CastMember& one : cast.members()) {
            if (!one.present) continue;
            const CastJoint& spine = one[Joint::spine];
            const double far = spine.known
                                   ? glm::distance(spine.world_m, world_from_depth.translation)
                                   : kUnknownM;
            if (far < nearest) nearest = far, ushered = one.id;
        }
        if (ushered != 0) usher.reset();
    }
    usher.step({.time_s = time_s,
                .dt_s = dt_s,
                .phase = phase == DemoPhase::playing ? DemoPhase::invite : phase,
                .body = body_of(ushered),
                .member = member(ushered),
                .mirror = options.mirror});
}

void DemoPlay::State::step(const DemoMoment& moment) {
    // Written so that what is not a number becomes 0.
    const double dt_s = moment.dt_s > 0 ? std::min(moment.dt_s, kLongestS) : 0;
    time = moment.time;
    time_s += dt_s;
    undrawn_s += dt_s;
    if (moment.source_lost != lost) {
        lost = moment.source_lost;
        log(lost ? "lost" : "back", {}, 0);
    }
    bodies = {};
    if (moment.bodies != nullptr && !lost) {
        bodies = options.mirror ? demo::mirrored(*moment.bodies) : *moment.bodies;
    }
    if (is_valid(moment.world_from_depth)) world_from_depth = moment.world_from_depth;
    // While the sensor is away everybody keeps their place.
    const double seen_dt_s = lost ? 0 : dt_s;
    cast.step(seen_dt_s, &bodies, world_from_depth);
    throws.step(seen_dt_s, cast.members());
    if (!lost) {
        for (const GestureEvent& event : moment.gestures) hear(event);
        for (const std::uint32_t id : players.step(seen_dt_s, cast.members())) log("left", {}, id);
    }
    find_phase(seen_dt_s);
    find_place(moment);
    guide(dt_s, moment);
    flash = std::max(0.0, flash - dt_s / kFlashS);
    run_stage(dt_s, moment);
    cut_people(moment);
}

DemoPlay::DemoPlay(std::unique_ptr<State> state) : state_(std::move(state)) {}
DemoPlay::~DemoPlay() = default;
DemoPlay::DemoPlay(DemoPlay&&) noexcept = default;
DemoPlay& DemoPlay::operator=(DemoPlay&&) noexcept = default;

Result<DemoPlay> DemoPlay::create(DemoOptions options) {
    const std::size_t own = demo::kPaletteColors * demo::Players::kMost +
                            (options.avatar ? options.avatar->materials.size() : 0);
    auto state = std::make_unique<State>(std::move(options));
    for (const std::string& name : demo::acts_or_default(state->options.scenes)) {
        KINO_ASSIGN(demo::Act act, demo::open_act(name, own));
        state->acts.push_back(std::move(act));
    }
    KINO_CHECK(!state->acts.empty());
    state->reset();
    return DemoPlay(std::move(state));
}

void DemoPlay::reset() {
    state_->reset();
}

void DemoPlay::next_scene() {
    state_->change_scene(1, 0);
}

void DemoPlay::step(const DemoMoment& moment) {
    state_->step(moment);
}

DemoPhase DemoPlay::phase() const {
    return state_->phase;
}

const DemoGuidance& DemoPlay::guidance() const {
    const demo::Players& players = state_->players;
    const demo::Player* first = players.primary();
    for (std::size_t i = 0; i < demo::Players::kMost; ++i) {
        const demo::Player& player = players.all()[i];
        if (player.id == 0) continue;
        if (first == nullptr || first == &player) return state_->coaches[i].guidance();
    }
    return state_->usher.guidance();
}

const DemoGuidance* DemoPlay::second_guidance() const {
    const demo::Players& players = state_->players;
    const DemoGuidance* first = &guidance();
    for (std::size_t i = 0; i < demo::Players::kMost; ++i) {
        const DemoGuidance* one = &state_->coaches[i].guidance();
        if (players.all()[i].id != 0 && one != first) return one;
    }
    return nullptr;
}

std::vector<DemoEvent> DemoPlay::take_events() {
    return std::exchange(state_->events, {});
}

const std::string& DemoPlay::scene_name() const {
    return state_->now().name;
}

std::size_t DemoPlay::local_lights() const {
    return state_->local_lights;
}

const Scene* DemoPlay::scene_to_warm() {
    if (!std::exchange(state_->warm_ready, false)) return nullptr;
    return &state_->warm;
}

const Scene& DemoPlay::scene() {
    State& s = *state_;
    s.compose(s.scene, s.curtain.light());
    ++s.scene.frame_index;
    s.scene.dt_s = std::exchange(s.undrawn_s, 0);
    s.painter.shown();
    s.balls.shown();
    if (s.live) s.live->previous_world_from_depth = s.live->world_from_depth;
    return s.scene;
}

View DemoPlay::view(int width, int height) const {
    constexpr double kFov = 0.86;  // rad, vertical
    const State& s = *state_;
    const demo::Turntable::Look look =
        s.turntable.look(s.now().director->file().camera, s.now().room);
    const Pose& stage = s.world_from_stage();
    View view{.width = width, .height = height, .projection = perspective(kFov, width, height)};
    view.world_from_view = look_at(stage * look.eye_m, stage * look.target_m);
    return view;
}

}  // namespace kino
