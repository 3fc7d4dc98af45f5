#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "apps/demo/demo_state.h"
#include "apps/demo/easing.h"
#include "apps/stage/cutout.h"
#include "apps/stage/outline.h"
#include "apps/stage/placing.h"

namespace kino {
namespace {

// Ids of nodes; a stage's own are below the first (Director numbers from 1).
constexpr std::uint32_t kPaintIds = 20000, kBallIds = 30000, kAvatarIds = 40000;
static_assert(kPaintIds + demo::Painter::kIds <= kBallIds);

constexpr double kPlaceEaseS = 0.35, kPlacedM = 2e-3;
constexpr double kFollowFromM = 0.35, kFollowToM = 0.06;
constexpr float kBallIntensity = 0.55f, kBallRadiusM = 2.4f;
constexpr double kFlashLight = 0.8;

bool is_local(const Light& light) {
    return light.kind != LightKind::directional;
}

}  // namespace

const Pose& DemoPlay::State::world_from_stage() const {
    const auto& led = acts[act].director->world_from_stage();
    return led ? *led : stands;
}

void DemoPlay::State::find_place(const DemoMoment& moment) {
    for (const CastMember& one : cast.members()) {
        if (found_person) break;
        if (!one.present) continue;
        const auto under = place_under(one, world_from_depth);
        if (!under) continue;
        stands = stands_to = *under;
        placed = found_person = true;
    }
    if (!placed) {
        glm::dvec3 middle = moment.middle_m;
        if (!demo::is_finite(middle) || glm::length(middle) > 1e4) middle = glm::dvec3(0);
        stands = stands_to = place_about(middle, world_from_depth);
        placed = true;
    }
    // Nobody plays yet: the stage goes along with whoever looks for a place.
    const CastMember* one = phase == DemoPhase::invite ? member(ushered) : nullptr;
    const auto under = one != nullptr && one->present ? place_under(*one, world_from_depth)
                                                      : std::optional<Pose>();
    if (!under) return;
    const glm::dvec3 off = under->translation - stands_to.translation;
    following = std::hypot(off.x, off.z) > (following ? kFollowToM : kFollowFromM);
    if (following) stands_to = *under;
}

void DemoPlay::State::swap_act() {
    if (next_act == act) return;
    act = next_act;
    acts[act].director->reset();
    balls.clear();
    balls.set_solids(acts[act].solids);
}

void DemoPlay::State::run_stage(double dt_s, const DemoMoment&) {
    if (glm::distance(stands.translation, stands_to.translation) < kPlacedM) {
        stands = stands_to;  // for good: what stands still is not worked on
    } else {
        stands = interpolate(stands, stands_to, demo::eased(dt_s, kPlaceEaseS));
    }
    const bool swapped = curtain.step(dt_s);
    if (swapped) swap_act();
    for (demo::Colors& own : colors) own.step(dt_s);
    Director& director = *acts[act].director;

    leads.clear();
    std::optional<glm::dvec3> pivot;
    for (const demo::Player& player : players.all()) {
        if (player.id == 0) continue;
        leads.push_back(player.id);
        const CastMember* one = member(player.id);
        if (!player.primary || one == nullptr || !(*one)[Joint::hip_center].known) continue;
        pivot = inverse(world_from_stage()) * (*one)[Joint::hip_center].world_m;
    }
    turntable.step(dt_s, pivot, phase == DemoPhase::attract,
                   {director.file().camera, now().room, now().solids});
    painter.step(dt_s, players, cast.members(),
                 world_from_stage().rotation * glm::dvec3(0, 0, 0.08));
    aura.step(dt_s, cast.members(), players);
    balls.step(dt_s);

    std::size_t tinter = 0;  // whose colours the stage takes
    for (std::size_t i = 0; i < players.all().size(); ++i) {
        if (players.all()[i].primary) tinter = i;
    }
    const std::size_t palette = colors[tinter].palette();
    const auto& linear = demo::demo_palettes()[palette].linear;
    director.set_tint(palette == 0 ? std::vector<glm::vec3>()
                                   : std::vector<glm::vec3>(linear.begin(), linear.end()));
    director.step({.dt_s = dt_s,
                   .bodies = &bodies,
                   .world_from_depth = world_from_depth,
                   .world_from_stage = stands,
                   .leads = &leads,
                   .other_lights = painter.lights() + aura.lights(cast.members())});
    if (avatars) {
        const Pose& stage = world_from_stage();
        avatars->step(
            {.dt_s = dt_s,
             .bodies = &bodies,
             .world_from_depth = world_from_depth,
             .floor_y_m = found_person ? std::optional(stage.translation.y) : std::nullopt,
             .middle_m = stage.translation,
             .facing = stage.rotation * glm::dvec3(0, 0, 1)});
    }
    if (!swapped) return;
    compose(warm, 1);
    warm_ready = true;
}

void DemoPlay::State::cut_people(const DemoMoment& moment) {
    const SceneLive& file = now().director->file().live;
    const bool wanted = options.live_body && file.show != SceneShow::none && !lost &&
                        moment.surface && moment.surface->rays && cast.anybody();
    if (!wanted) {
        live.reset();
        seen.reset();
        cut.reset();
        return;
    }
    if (moment.surface != seen) {
        seen = moment.surface;
        cut = options.mirror ? mirror.of(*seen) : seen;
        if (file.show == SceneShow::people) {
            std::optional<double> floor_y_m;
            if (found_person) floor_y_m = stands.translation.y;
            const int outline_px =
                file.smooth_outline ? outline_radius_px(cut->depth_m.width()) : 0;
            cut = cut_out_people(*cut, bodies, file.margin_m, world_from_depth, floor_y_m,
                                 outline_px);
        }
    }
    const Pose previous = live ? live->previous_world_from_depth : world_from_depth;
    live = LiveDepth{.surface = cut,
                     .world_from_depth = world_from_depth,
                     .previous_world_from_depth = previous,
                     .style = file.style,
                     .splat_cap_px = file.splat_px,
                     .casts_shadows = file.casts_shadows};
}

void DemoPlay::State::add_balls(Scene& out, std::uint32_t glow) {
    const Pose& stage = world_from_stage();
    const double width = 2 * balls.rules().radius_m;
    for (const demo::Ball& ball : balls.all()) {
        const double weight = balls.weight(ball);
        const glm::dvec3 at = stage * ball.at_m;
        if (weight < 0.01 || !demo::is_finite(at)) continue;
        const auto whose = static_cast<std::size_t>(std::max(ball.painter, 0));
        const glm::vec3 color = colors[whose].along(ball.rounds);
        const auto strength = static_cast<float>(weight * (1 + 1.6 * demo::smooth(ball.flash)));
        out.lights.push_back({.kind = LightKind::point,
                              .position = at,
                              .color = color * (kBallIntensity * strength),
                              .radius_m = kBallRadiusM});
        const glm::dmat4 one(1);
        const glm::dvec3 size(width * std::sqrt(weight));
        out.meshes.push_back(
            {.id = kBallIds + static_cast<std::uint32_t>(ball.number % 4096),
             .mesh = ball_mesh,
             .world_from_object = glm::scale(glm::translate(one, at), size),
             .previous_world_from_object =
                 glm::scale(glm::translate(one, stage * ball.shown_m), size),
             .material = glow + static_cast<std::uint32_t>(whose * demo::kPaletteColors +
                                                           demo::Colors::index(ball.rounds))});
    }
}

void DemoPlay::State::compose(Scene& out, double light) {
    Director& director = *acts[act].director;
    if (!director.world_from_stage()) {
        out = {.frame_index = out.frame_index, .color_mode = ColorMode::relit};
        return;
    }
    out.bodies.clear();
    if (director.file().effects.skeleton) {
        for (const Body& body : bodies.bodies) {
            out.bodies.push_back(
                {.id = body.id, .body = body, .world_from_depth = world_from_depth});
        }
    }
    director.fill(out);
    out.live = live;
    if (avatars) avatars->fill(out, kAvatarIds);

    const auto glow = static_cast<std::uint32_t>(out.materials.size() + 1);
    std::array<std::uint32_t, demo::Players::kMost> glow_of{};
    for (std::size_t i = 0; i < colors.size(); ++i) {
        glow_of[i] = static_cast<std::uint32_t>(out.materials.size() + 1);
        for (std::size_t c = 0; c < demo::kPaletteColors; ++c) {
            out.materials.push_back(
                {.base_color = glm::vec3(0), .emission = kStageGlow * colors[i].at(c)});
        }
    }
    // What people do comes before what a full picture leaves out.
    const std::vector<Light> stage_lights = std::exchange(out.lights, {});
    add_balls(out, glow);
    const std::size_t most = demo::kDemoLights + out.lights.size();
    aura.fill(out, cast.members(), colors, world_from_stage());
    painter.fill(out, kPaintIds, colors, glow_of);
    std::size_t local = std::min(out.lights.size(), most);
    out.lights.resize(local);
    for (const Light& one : stage_lights) {
        if (is_local(one) && local >= most) continue;
        local += is_local(one) ? 1 : 0;
        out.lights.push_back(one);
    }
    local_lights = local;

    const auto level = static_cast<float>(light * light);
    out.exposure *= level * static_cast<float>(1 + kFlashLight * demo::smooth(flash));
    out.background_top *= level;
    out.background_bottom *= level;
}

}  // namespace kino
