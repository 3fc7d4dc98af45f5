#include "apps/bench/governor_script.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <utility>

#include "apps/pipeline/stepper.h"
#include "apps/stage/stage.h"
#include "skeleton/synthetic/synthetic_source.h"

namespace kino::bench {
namespace {

constexpr const char* kPerson = "synthetic:wave?size=320x240";
constexpr const char* kScene = "light-painting";
constexpr double kScriptStep = 1.0 / 30;
constexpr int kMostPerson = 90;
constexpr double kFov = 0.8;

}  // namespace

const std::vector<Disturbance>& GovernorScript::disturbances() {
    static const std::vector<Disturbance> kAll = {
        {.name = "as it is"},
        {.name = "view from aside", .turn = 0.7},
        {.name = "person fills the picture", .nearer = 2.2},
        {.name = "twice the lights", .lights = 2},
        {.name = "as it is again"},
        {.name = "another program on one core", .busy = true},
        {.name = "three times the lights, near", .nearer = 1.6, .lights = 3},
        {.name = "far away", .nearer = 0.6},
    };
    return kAll;
}

Result<std::unique_ptr<GovernorScript>> GovernorScript::create(int width, int height, int frames) {
    register_synthetic_source();
    std::unique_ptr<GovernorScript> script(new GovernorScript(width, height, frames));
    KINO_ASSIGN(OpenedSource opened,
                open_for_playing(kPerson, {.mode = LoopMode::loop, .filters = {}, .bodies = {}}));
    Stepper stepper(std::move(opened));
    for (int i = 0; i < std::min(frames, kMostPerson); ++i) {
        KINO_ASSIGN(auto frame, stepper.next());
        if (!frame) break;
        script->person_.push_back(std::move(*frame));
    }
    if (script->person_.empty()) return fail("brings no frames", kPerson);
    script->restart();
    if (!script->builder_) return fail("cannot be made", kScene);
    return script;
}

GovernorScript::~GovernorScript() {
    let_busy(false);
}

void GovernorScript::let_busy(bool busy) {
    if (busy == busy_) return;
    busy_ = busy;
    if (neighbour_.joinable()) neighbour_.join();
    if (!busy) return;
    neighbour_ = std::thread([this] {
        volatile double waste = 1;
        while (busy_) {
            for (int i = 0; i < 10000; ++i) waste = std::sqrt(waste + i);
        }
    });
}

void GovernorScript::restart() {
    let_busy(false);
    at_ = 0;
    builder_.reset();
    auto stage = open_stage(kScene);
    if (!stage) return;
    builder_ = std::make_unique<SceneBuilder>();
    builder_->put_on_stage(std::make_unique<Director>(std::move(*stage)));
}

GovernorScript::Moment GovernorScript::next() {
    const auto& all = disturbances();
    const auto count = static_cast<int>(all.size());
    const int length = std::max(1, frames_ / count);
    const int index = std::min(count - 1, at_ / length);
    const Disturbance& now = all[static_cast<std::size_t>(index)];
    const bool fresh = at_ == index * length && at_ > 0;
    let_busy(now.busy);

    builder_->show(person_[static_cast<std::size_t>(at_) % person_.size()]);
    (void)builder_->advance(kScriptStep);
    const Director& director = *builder_->director();
    const SceneLive& live = director.file().live;
    scene_ = builder_->scene({.style = live.style, .splat_px = live.splat_px, .color = {}});
    // More of the same lights, so that every tile's list grows alike; together as bright as before.
    const std::vector<Light> lights = scene_.lights;
    for (Light& light : scene_.lights) {
        if (light.kind != LightKind::directional) light.color /= static_cast<float>(now.lights);
    }
    for (int copy = 1; copy < now.lights; ++copy) {
        for (const Light& light : lights) {
            if (light.kind == LightKind::directional) continue;
            scene_.lights.push_back(light);
            scene_.lights.back().color /= static_cast<float>(now.lights);
            scene_.lights.back().position += glm::dvec3(0.05 * copy, 0.03, -0.04 * copy);
        }
    }
    const glm::dvec3 target = director.target_m();
    glm::dvec3 away = (director.eye_m() - target) / now.nearer;
    const double sway = now.turn + 0.2 * std::sin(at_ * 0.03);
    away = glm::angleAxis(sway, glm::dvec3(0, 1, 0)) * away;
    const View view{.width = width_,
                    .height = height_,
                    .projection = perspective(kFov, width_, height_),
                    .world_from_view = look_at(target + away, target)};
    ++at_;
    return {.scene = scene_, .view = view, .disturbance = now, .fresh = fresh};
}

}  // namespace kino::bench
