#include "apps/stage/director.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>
#include <utility>

#include "apps/stage/placing.h"

namespace kino {
namespace {

constexpr double kLongestStepS = 0.1;
/// A swarm's lights come and go in this time.
constexpr double kSwarmFadeS = 1;
/// Tints come with this time constant.
constexpr double kTintS = 0.15;
/// What is darker than this part of itself is not there.
constexpr double kLeastWeight = 1.0 / 256;
/// Smaller beads are a pixel or two wide.
constexpr double kSparkM = 0.015;
/// The oldest part of a full trail fades, so that nothing vanishes at once.
constexpr double kTailPart = 0.15;

double smooth_step(double x) {
    x = std::clamp(x, 0.0, 1.0);
    return x * x * (3 - 2 * x);
}

void approach(double& value, double target, double dt_s, double whole_s) {
    const double most = whole_s > 0 ? dt_s / whole_s : 1;
    value += std::clamp(target - value, -most, most);
}

bool is_finite(const glm::dvec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

glm::vec3 color_along(const std::vector<SceneColor>& palette, double rounds) {
    if (palette.empty()) return glm::vec3(1);
    const double at = (rounds - std::floor(rounds)) * static_cast<double>(palette.size());
    const auto i = std::min(static_cast<std::size_t>(at), palette.size() - 1);
    return glm::mix(to_linear(palette[i]), to_linear(palette[(i + 1) % palette.size()]),
                    static_cast<float>(at - static_cast<double>(i)));
}

/// Takes the rod of length 1 along y from `from` to `to`.
glm::dmat4 rod_between(const glm::dvec3& from, const glm::dvec3& to, double width) {
    const glm::dvec3 along = to - from;
    const glm::dvec3 y = glm::normalize(along);
    const glm::dvec3 other = std::abs(y.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0);
    const glm::dvec3 x = glm::normalize(glm::cross(y, other));
    // Longer by half a width, so that a bend shows no gap.
    const glm::dvec3 longer = along + 0.5 * width * y;
    return {glm::dvec4(width * x, 0), glm::dvec4(longer, 0),
            glm::dvec4(width * glm::cross(x, y), 0), glm::dvec4(0.5 * (from + to), 1)};
}

std::vector<Joint> joints_of(const SceneRole& role) {
    if (!role.joints.empty()) return role.joints;
    std::vector<Joint> all;
    for (std::size_t i = 0; i < kJointCount; ++i) all.push_back(static_cast<Joint>(i));
    return all;
}

/// Ids that a role needs for each place of the cast.
std::uint32_t ids_of(const SceneRole& role, const StageProp& prop) {
    std::size_t ids = 0;
    if (role.trail && role.trail->stroke_m > 0) ids += static_cast<std::size_t>(role.trail->lights);
    if (role.prop) ids += static_cast<std::size_t>(role.prop->copies) * prop.parts.size();
    return static_cast<std::uint32_t>(ids);
}

}  // namespace

Director::Director(StageSet stage) : stage_(std::move(stage)) {
    for (SceneRole& role : stage_.file.roles) role.joints = joints_of(role);
    for (const SceneSwarm& swarm : stage_.file.swarms) swarms_.emplace_back(swarm);
    reset();
}

void Director::reset() {
    cast_.clear();
    tint_.reset();
    swarm_colors_.clear();
    role_colors_.clear();
    const auto linear = [](const std::vector<SceneColor>& palette) {
        std::vector<glm::vec3> colors;
        for (const SceneColor& color : palette) colors.push_back(to_linear(color));
        return colors;
    };
    for (const SceneSwarm& swarm : stage_.file.swarms) {
        swarm_colors_.push_back(linear(swarm.palette));
    }
    for (const SceneRole& role : stage_.file.roles) role_colors_.push_back(linear(role.palette));
    world_from_stage_.reset();
    found_person_ = false;
    time_s_ = 0;
    lights_.clear();
    nodes_.clear();
    before_.clear();
    now_.clear();
    shown_ = true;
    led_.clear();
    for (const SceneRole& role : stage_.file.roles) {
        auto& of_role = led_.emplace_back(Cast::kPlaces * role.joints.size());
        if (!role.trail) continue;
        for (Led& led : of_role) {
            led.trail.emplace(static_cast<std::size_t>(role.trail->lights), role.trail->spacing_m);
        }
    }
    swarm_presence_.clear();
    for (const Swarm& swarm : swarms_) swarm_presence_.emplace_back(swarm.all().size(), -1.0);
}

glm::dvec3 Director::turned(const glm::dvec3& stage_direction) const {
    return world_from_stage_->rotation * stage_direction;
}

glm::dvec3 Director::eye_m() const {
    return *world_from_stage_ * stage_.file.camera.eye_m;
}

glm::dvec3 Director::target_m() const {
    return *world_from_stage_ * stage_.file.camera.target_m;
}

void Director::set_tint(std::vector<glm::vec3> colors) {
    tint_ = std::move(colors);
}

void Director::tint(double dt_s) {
    if (!tint_) return;
    const auto part = static_cast<float>(1 - std::exp(-dt_s / kTintS));
    const auto move = [&](std::vector<glm::vec3>& now, const std::vector<SceneColor>& own) {
        for (std::size_t i = 0; i < now.size(); ++i) {
            const glm::vec3 to = tint_->empty() ? to_linear(own[i]) : (*tint_)[i % tint_->size()];
            now[i] = glm::mix(now[i], to, part);
        }
    };
    for (std::size_t i = 0; i < swarms_.size(); ++i) {
        move(swarm_colors_[i], swarms_[i].file().palette);
    }
    for (std::size_t i = 0; i < role_colors_.size(); ++i) {
        move(role_colors_[i], stage_.file.roles[i].palette);
    }
}

void Director::place(const StageMoment& moment) {
    if (stage_.file.origin == SceneOrigin::world) {
        world_from_stage_ = Pose{};
        return;
    }
    if (moment.world_from_stage) {
        world_from_stage_ = moment.world_from_stage;
        found_person_ = true;
        return;
    }
    if (found_person_) return;
    for (const CastMember& member : cast_.members()) {
        if (!member.present) continue;
        const auto placed = place_under(member, moment.world_from_depth);
        if (!placed) continue;
        world_from_stage_ = placed;
        found_person_ = true;
        return;
    }
    if (!world_from_stage_) {
        world_from_stage_ = place_about(moment.middle_m, moment.world_from_depth);
    }
}

void Director::add_light(const SceneLight& file, const glm::dvec3& world_m,
                         const glm::dvec3& direction, const glm::vec3& color, double weight) {
    if (weight < kLeastWeight || !is_finite(world_m) || !is_finite(direction)) return;
    const bool local = file.kind != LightKind::directional;
    if (local && local_lights_ >= static_cast<std::size_t>(kMaxStageLights)) return;
    local_lights_ += local ? 1 : 0;
    lights_.push_back({.kind = file.kind,
                       .position = world_m,
                       .direction = direction,
                       .color = color * static_cast<float>(file.intensity * weight),
                       .radius_m = static_cast<float>(file.radius_m),
                       .inner_rad = static_cast<float>(glm::radians(file.cone_deg.x)),
                       .outer_rad = static_cast<float>(glm::radians(file.cone_deg.y)),
                       .material_mask = material_mask(stage_.file, file.only),
                       .shadow = file.shadow ? LightShadow::raycast : LightShadow::none,
                       .indirect = file.indirect});
}

void Director::add_node(std::uint32_t id, const StandingMesh& mesh,
                        const glm::dmat4& world_from_object, std::uint32_t material) {
    if (nodes_.size() >= static_cast<std::size_t>(kMaxStageNodes)) return;
    if (now_.size() <= id) now_.resize(id + 1);
    now_[id] = world_from_object;
    const bool was = id < before_.size() && before_[id];
    nodes_.push_back({.id = id,
                      .mesh = mesh.mesh,
                      .world_from_object = world_from_object,
                      .previous_world_from_object = was ? *before_[id] : world_from_object,
                      .material = material,
                      .pose = mesh.pose});
}

void Director::light_standing() {
    for (const SceneLight& light : stage_.file.lights) {
        add_light(light, *world_from_stage_ * light.at_m, turned(light.direction),
                  to_linear(light.color), 1);
    }
}

void Director::follow_trail(std::size_t role, Led& led, std::uint32_t first_id) {
    const SceneTrail& file = *stage_.file.roles[role].trail;
    Trail& trail = *led.trail;
    trail.forget_before(time_s_ - file.life_s);
    SceneLight light{.intensity = file.intensity, .radius_m = file.radius_m};
    const double capacity = static_cast<double>(trail.capacity());
    for (std::size_t i = 0; i < trail.size(); ++i) {
        const TrailPoint& point = trail.newest(i);
        const double left = 1 - (time_s_ - point.born_s) / file.life_s;
        const double tail = (1 - static_cast<double>(i) / capacity) / kTailPart;
        const double weight = smooth_step(left) * smooth_step(tail);
        const double rounds = point.way_m / file.palette_m;
        add_light(light, point.world_m, {0, -1, 0}, color_along(file.palette, rounds), weight);
        if (file.stroke_m <= 0 || !point.joined || i + 1 >= trail.size()) continue;
        const std::vector<std::uint32_t>& glow = stage_.trail_glow[role];
        const double width = file.stroke_m * std::sqrt(weight);
        if (width < 0.02 * file.stroke_m) continue;
        const auto color = static_cast<std::size_t>((rounds - std::floor(rounds)) *
                                                    static_cast<double>(glow.size()));
        const auto id = first_id + static_cast<std::uint32_t>(point.number % trail.capacity());
        // It lies still; another one may have had its number.
        if (id < before_.size()) before_[id].reset();
        add_node(id, {.mesh = stage_.stroke},
                 rod_between(trail.newest(i + 1).world_m, point.world_m, width),
                 glow[std::min(color, glow.size() - 1)]);
    }
}

void Director::follow_prop(std::size_t role, const Led& led, const glm::dvec3& at_m,
                           std::uint32_t first_id) {
    const SceneProp& file = *stage_.file.roles[role].prop;
    const StageProp& prop = stage_.props[role];
    // A circle that leans, so that its far side is seen above its near one.
    const glm::dvec3 right = turned({1, 0, 0});
    const glm::dvec3 up = turned(glm::normalize(glm::dvec3(0.25, 0.45, 1)));
    const glm::dmat4 turn = glm::mat4_cast(world_from_stage_->rotation);
    std::uint32_t id = first_id;
    for (int copy = 0; copy < file.copies; ++copy) {
        const double angle = 2 * std::numbers::pi *
                             (static_cast<double>(copy) / file.copies + time_s_ / file.period_s);
        const glm::dvec3 at =
            at_m + file.orbit_m * (std::cos(angle) * right + std::sin(angle) * up);
        const double size = smooth_step(led.presence);
        for (const StandingMesh& part : prop.parts) {
            const std::uint32_t material =
                prop.materials.empty()
                    ? part.material
                    : prop.materials[static_cast<std::size_t>(copy) % prop.materials.size()];
            const glm::dmat4 place = glm::translate(glm::dmat4(1), at) * turn;
            if (size > 0.01 && is_finite(at)) {
                add_node(id, part, glm::scale(place, glm::dvec3(size)) * part.stage_from_object,
                         material);
            }
            ++id;
        }
    }
}

void Director::follow(std::size_t role_index, double dt_s,
                      const std::vector<std::uint32_t>* leads_role) {
    const SceneRole& role = stage_.file.roles[role_index];
    int people = 0;
    std::uint32_t first_id = 1 + static_cast<std::uint32_t>(stage_.standing.size());
    for (std::size_t before = 0; before < role_index; ++before) {
        first_id += ids_of(stage_.file.roles[before], stage_.props[before]) *
                    static_cast<std::uint32_t>(led_[before].size());
    }
    const std::uint32_t ids = ids_of(role, stage_.props[role_index]);
    const std::uint32_t trail_ids =
        role.trail && role.trail->stroke_m > 0 ? static_cast<std::uint32_t>(role.trail->lights) : 0;
    std::size_t number = 0;
    for (const CastMember& member : cast_.members()) {
        const bool may = leads_role == nullptr || std::find(leads_role->begin(), leads_role->end(),
                                                            member.id) != leads_role->end();
        const bool has_role = member.present && may && people++ < role.people;
        for (const Joint joint : role.joints) {
            Led& led = led_[role_index][number];
            const std::uint32_t id = first_id + ids * static_cast<std::uint32_t>(number);
            const std::size_t color = number++;
            const CastJoint& at = member[joint];
            const bool leads = has_role && at.seen;
            if (!at.known) led.presence = 0;
            approach(led.presence, leads ? 1 : 0, dt_s, role.fade_s);
            if (led.trail) {
                leads ? led.trail->reach(at.world_m + turned(role.trail->off_m), time_s_)
                      : led.trail->lift();
                follow_trail(role_index, led, id);
            }
            if (led.presence <= 0) continue;
            if (role.light) {
                const CastJoint& parent = member[kJointParent[static_cast<std::size_t>(joint)]];
                const glm::dvec3 limb = at.world_m - parent.world_m;
                const bool along =
                    role.aim != SceneAim::fixed && parent.known && glm::length(limb) > 0.02;
                glm::dvec3 beam = along ? glm::normalize(limb) : turned(role.light->direction);
                if (along && role.aim == SceneAim::mirror) {
                    const glm::dvec3 out = turned({0, 0, 1});
                    beam -= 2 * std::max(0.0, glm::dot(beam, out)) * out;
                }
                add_light(*role.light, at.world_m + turned(role.light->at_m), beam,
                          role.palette.empty()
                              ? to_linear(role.light->color)
                              : role_colors_[role_index][color % role.palette.size()],
                          smooth_step(led.presence));
            }
            if (role.prop) {
                follow_prop(role_index, led, at.world_m + turned(role.prop->off_m), id + trail_ids);
            }
        }
    }
}

void Director::let_swarm(std::size_t index, double dt_s, std::uint32_t first_id) {
    const Swarm& swarm = swarms_[index];
    const SceneSwarm& file = swarm.file();
    const bool on =
        file.when == SceneWhen::always || (file.when == SceneWhen::people) == cast_.anybody();
    const auto room =
        static_cast<std::int64_t>(file.fill_to) - static_cast<std::int64_t>(local_lights_);
    const std::int64_t wanted = !on                ? 0
                                : file.fill_to > 0 ? std::clamp<std::int64_t>(room, 0, file.count)
                                                   : file.count;
    for (std::size_t i = 0; i < swarm.all().size(); ++i) {
        double& presence = swarm_presence_[index][i];
        const double target = static_cast<std::int64_t>(i) < wanted ? 1 : 0;
        if (presence < 0) presence = target;  // at the beginning they burn already
        approach(presence, target, dt_s, kSwarmFadeS);
        const double weight = smooth_step(presence);
        if (weight < kLeastWeight) continue;
        const Swarm::One& one = swarm.all()[i];
        const SwarmMoment moment = swarm.at(i, time_s_);
        const glm::dvec3 world = *world_from_stage_ * moment.stage_m;
        const glm::vec3 color =
            file.palette.empty() ? glm::vec3(1) : swarm_colors_[index][one.color];
        add_light({.intensity = one.intensity, .radius_m = one.radius_m, .shadow = file.shadow},
                  world, {0, -1, 0}, color, weight * moment.weight);
        const double bead = file.bead_m * std::sqrt(weight * moment.weight);
        if (file.bead_m <= 0 || bead < 0.05 * file.bead_m) continue;
        // A light that casts shadows hangs below its ball, which would swallow it otherwise.
        const glm::dvec3 hung = world + glm::dvec3(0, file.shadow ? 0.8 * file.bead_m : 0, 0);
        add_node(first_id + static_cast<std::uint32_t>(i),
                 {.mesh = file.bead_m < kSparkM ? stage_.spark : stage_.bead},
                 glm::scale(glm::translate(glm::dmat4(1), hung), glm::dvec3(bead)),
                 stage_.swarm_glow[index][one.color]);
    }
}

void Director::step(const StageMoment& moment) {
    // Written so that what is not a number becomes 0.
    const double dt_s = moment.dt_s > 0 ? std::min(moment.dt_s, kLongestStepS) : 0;
    time_s_ += dt_s;
    cast_.step(dt_s, moment.bodies, moment.world_from_depth);
    place(moment);
    lights_.clear();
    nodes_.clear();
    local_lights_ = moment.other_lights;
    tint(dt_s);
    // What was never asked for was never shown, and nothing moved since then.
    if (std::exchange(shown_, false)) std::swap(before_, now_);
    now_.assign(std::max(before_.size(), now_.size()), std::nullopt);

    const glm::dmat4 world = world_from_stage_->matrix();
    std::uint32_t id = 1;
    for (const StandingMesh& mesh : stage_.standing) {
        add_node(id++, mesh, world * mesh.stage_from_object, mesh.material);
    }
    light_standing();
    for (std::size_t i = 0; i < stage_.file.roles.size(); ++i) {
        follow(i, dt_s, moment.leads);
        id += ids_of(stage_.file.roles[i], stage_.props[i]) *
              static_cast<std::uint32_t>(led_[i].size());
    }
    for (std::size_t i = 0; i < swarms_.size(); ++i) {
        let_swarm(i, dt_s, id);
        if (swarms_[i].file().bead_m > 0) id += static_cast<std::uint32_t>(swarms_[i].all().size());
    }
    local_lights_ -= std::min(local_lights_, moment.other_lights);
}

void Director::fill(Scene& scene) {
    shown_ = true;
    const SceneFile& file = stage_.file;
    const auto srgb = [](const SceneColor& c) { return glm::vec3(c.r, c.g, c.b) / 255.0f; };
    scene.meshes = nodes_;
    scene.materials = stage_.materials;
    for (std::size_t i = 0; tint_ && i < swarms_.size(); ++i) {
        const std::vector<std::uint32_t>& glow = stage_.swarm_glow[i];
        for (std::size_t c = 0; c < std::min(glow.size(), swarm_colors_[i].size()); ++c) {
            scene.materials[glow[c] - 1].emission = kStageGlow * swarm_colors_[i][c];
        }
    }
    scene.lights = lights_;
    scene.color_mode = file.color;
    scene.ambient = to_linear(file.ambient);
    scene.exposure = static_cast<float>(file.exposure);
    scene.background_top = srgb(file.background_top);
    scene.background_bottom = srgb(file.background_bottom);
    if (!file.effects.skeleton) scene.bodies.clear();
}

}  // namespace kino
