#include "apps/avatar/avatar.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <optional>
#include <tuple>
#include <utility>

#include "apps/avatar/avatar_aim.h"
#include "apps/avatar/rest_body.h"
#include "apps/avatar/retarget.h"
#include "apps/avatar/turns.h"
#include "base/check.h"
#include "skeleton/synthetic/motion.h"

namespace kino {
namespace {

/// A body is taken for somebody else's where its middle is farther off than this.
constexpr double kSamePersonM = 0.8;
/// What a changed id weighs against a distance: people who cross keep their avatars.
constexpr double kOtherIdM = 0.35;
constexpr double kGrowS = 0.3, kSmallest = 0.25;

struct Avatar {
    Retarget retarget;
    std::uint32_t person = 0;
    bool idle = false;
    bool left = false;  ///< nobody moves it any more
    double age_s = 0;
    double left_s = 0;
    glm::dvec3 seen_m{0};  ///< the person's middle when it was seen last
    double floor_y_m = 0;
    double size = 1;  ///< grows when it comes, shrinks when it goes
    glm::dmat4 world_from_object{1};
    glm::dmat4 previous{1};
    std::shared_ptr<const std::vector<glm::mat4>> pose;
};

/// Where a body is, for telling people apart.
std::optional<glm::dvec3> middle_of(const BodyAim& aim) {
    for (const Joint joint : {Joint::hip_center, Joint::spine, Joint::shoulder_center}) {
        if (aim.seen[index_of(joint)]) return aim.joint_m[index_of(joint)];
    }
    return std::nullopt;
}

struct Seen {
    BodyAim aim;
    std::uint32_t id = 0;
    glm::dvec3 middle_m{0};
    std::optional<std::size_t> place;  ///< of the avatar that is his
};

}  // namespace

struct AvatarTroupe::State {
    std::shared_ptr<const AvatarRig> rig;
    std::shared_ptr<const RestBody> rest;
    AvatarOptions options;
    std::array<std::optional<Avatar>, kPlaces> places;
    double alone_s = 0;
    double idle_time_s = 0;

    [[nodiscard]] std::vector<Seen> look(const AvatarMoment& moment) const;
    void match(std::vector<Seen>& people);
    void move(Avatar& avatar, const BodyAim& aim, const AvatarMoment& moment, double dt_s) const;
    void idle(const AvatarMoment& moment, double dt_s);
    std::optional<Avatar>* free_place();
    void pose(Avatar& avatar) const;
    [[nodiscard]] bool shows(const std::optional<Avatar>& place) const {
        return place && place->pose != nullptr && place->size > 0.02;
    }
};

std::vector<Seen> AvatarTroupe::State::look(const AvatarMoment& moment) const {
    std::vector<Seen> people;
    if (moment.bodies == nullptr) return people;
    const glm::dvec3 facing = unit_or({moment.facing.x, 0, moment.facing.z}, {0, 0, 1});
    const MirrorPlane plane{moment.middle_m, glm::cross(glm::dvec3(0, 1, 0), facing)};
    for (const Body& body : moment.bodies->bodies) {
        if (body.id == 0) continue;
        Seen seen{.aim = aim_of(body, moment.world_from_depth), .id = body.id};
        if (options.mirror) seen.aim = mirrored(seen.aim, plane);
        const std::optional<glm::dvec3> middle = middle_of(seen.aim);
        if (!middle || !(glm::dot(*middle, *middle) < 1e16)) continue;
        seen.middle_m = *middle;
        people.push_back(seen);
    }
    return people;
}

/// Who is who: nearest pairs first, an unchanged id counting for some distance.
void AvatarTroupe::State::match(std::vector<Seen>& people) {
    struct Pair {
        double cost;
        std::size_t place, person;
    };
    std::vector<Pair> pairs;
    for (std::size_t a = 0; a < places.size(); ++a) {
        if (!places[a] || places[a]->idle) continue;
        for (std::size_t p = 0; p < people.size(); ++p) {
            const double far = glm::length(people[p].middle_m - places[a]->seen_m);
            const bool same = people[p].id == places[a]->person;
            // One who left may come back under another name only where he was.
            if (far > (same ? kSamePersonM : 0.5 * kSamePersonM)) continue;
            pairs.push_back({far + (same ? 0.0 : kOtherIdM), a, p});
        }
    }
    std::sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) {
        return std::tie(a.cost, a.place, a.person) < std::tie(b.cost, b.place, b.person);
    });
    std::array<bool, kPlaces> moved{};
    for (const Pair& pair : pairs) {
        if (moved[pair.place] || people[pair.person].place) continue;
        moved[pair.place] = true;
        people[pair.person].place = pair.place;
        Avatar& avatar = *places[pair.place];
        avatar.person = people[pair.person].id;
        avatar.seen_m = people[pair.person].middle_m;
        avatar.left = false;
    }
    for (std::size_t a = 0; a < places.size(); ++a) {
        if (places[a] && !places[a]->idle && !moved[a]) places[a]->left = true;
    }
}

std::optional<Avatar>* AvatarTroupe::State::free_place() {
    for (auto& place : places) {
        if (!place) return &place;
    }
    // One that only fades makes room, the idle one first.
    std::optional<Avatar>* best = nullptr;
    for (auto& place : places) {
        if (!place->left && !place->idle) continue;
        if (best == nullptr || (place->idle && !(*best)->idle) ||
            (place->idle == (*best)->idle && place->left_s > (*best)->left_s)) {
            best = &place;
        }
    }
    if (best != nullptr) best->reset();
    return best;
}

void AvatarTroupe::State::move(Avatar& avatar, const BodyAim& aim, const AvatarMoment& moment,
                               double dt_s) const {
    avatar.retarget.step(aim, {options.scale_bones, moment.floor_y_m}, dt_s);
    avatar.floor_y_m = moment.floor_y_m.value_or(
        std::min(avatar.retarget.sole_y_m(0), avatar.retarget.sole_y_m(1)));
}

void AvatarTroupe::State::pose(Avatar& avatar) const {
    const Retarget& retarget = avatar.retarget;
    if (!retarget.placed()) return;
    const glm::dvec3 hips = retarget.joint_m()[0];
    const double in = kSmallest + (1 - kSmallest) * ease_between(0, kGrowS, avatar.age_s);
    // One who comes back grows again from where it was.
    const double out =
        avatar.left_s > 0 ? 1 - ease_between(0, options.hand_over_s, avatar.left_s) : 1.0;
    avatar.size = in * out;
    // It grows out of the floor and shrinks into it.
    const glm::dvec3 foot(hips.x, avatar.floor_y_m, hips.z);
    glm::dmat4 m = glm::translate(glm::dmat4(1.0), foot + (hips - foot) * avatar.size);
    m = glm::scale(m, glm::dvec3(retarget.scale() * avatar.size));
    avatar.previous = avatar.pose == nullptr ? m : avatar.world_from_object;
    avatar.world_from_object = m;
    avatar.pose = std::make_shared<const std::vector<glm::mat4>>(retarget.object_from_bind(hips));
}

void AvatarTroupe::State::idle(const AvatarMoment& moment, double dt_s) {
    const auto busy = [](const std::optional<Avatar>& place) { return place && !place->idle; };
    const bool alone = std::none_of(places.begin(), places.end(), busy);
    alone_s = alone ? alone_s + dt_s : 0;
    const auto mine = std::find_if(places.begin(), places.end(),
                                   [](const auto& place) { return place && place->idle; });
    idle_time_s += dt_s;
    if (mine == places.end()) {
        if (!options.idle || !alone || alone_s < options.idle_after_s) return;
        idle_time_s = 0;
        places[0] = Avatar{.retarget = Retarget(rest), .idle = true};
        idle(moment, 0);
        return;
    }
    Avatar& avatar = **mine;
    if (!alone || !options.idle) avatar.left = true;
    BodyPose body = pose_at(Motion::idle, idle_time_s);
    // The synthetic person stands somewhere in its own room.
    body.place_m = glm::dvec3(0);
    body.yaw_rad = 0;
    move(avatar, aim_of(pose_body(body), moment.middle_m, moment.facing), moment, dt_s);
    avatar.age_s += dt_s;
}

AvatarTroupe::AvatarTroupe(std::shared_ptr<const AvatarRig> rig, const AvatarOptions& options)
    : state_(std::make_unique<State>()) {
    KINO_CHECK(rig != nullptr);
    state_->rest = std::make_shared<const RestBody>(make_rest_body(*rig));
    state_->rig = std::move(rig);
    state_->options = options;
}

AvatarTroupe::~AvatarTroupe() = default;
AvatarTroupe::AvatarTroupe(AvatarTroupe&&) noexcept = default;
AvatarTroupe& AvatarTroupe::operator=(AvatarTroupe&&) noexcept = default;

void AvatarTroupe::reset() {
    for (auto& place : state_->places) place.reset();
    state_->alone_s = 0;
    state_->idle_time_s = 0;
}

void AvatarTroupe::step(const AvatarMoment& moment) {
    State& s = *state_;
    // Not a number counts as no time.
    const double dt_s = moment.dt_s > 0 ? std::min(moment.dt_s, 0.1) : 0.0;
    std::vector<Seen> people = s.look(moment);
    s.match(people);
    for (const Seen& person : people) {
        if (person.place) {
            Avatar& avatar = *s.places[*person.place];
            avatar.left_s = std::max(avatar.left_s - dt_s, 0.0);
            avatar.age_s += dt_s;
            s.move(avatar, person.aim, moment, dt_s);
            continue;
        }
        std::optional<Avatar>* place = s.free_place();
        if (place == nullptr) continue;
        *place =
            Avatar{.retarget = Retarget(s.rest), .person = person.id, .seen_m = person.middle_m};
        s.move(**place, person.aim, moment, dt_s);
    }
    for (auto& place : s.places) {
        if (!place || place->idle || !place->left) continue;
        s.move(*place, BodyAim{}, moment, dt_s);
    }
    s.idle(moment, dt_s);
    for (auto& place : s.places) {
        if (!place) continue;
        if (place->left) place->left_s += dt_s;
        if (!place->retarget.placed() || (place->left && place->left_s >= s.options.hand_over_s)) {
            place.reset();
            continue;
        }
        s.pose(*place);
    }
}

void AvatarTroupe::fill(Scene& scene, std::uint32_t first_id) const {
    if (shown() == 0) return;
    const AvatarRig& rig = *state_->rig;
    // Where the scene has no room for materials, the plain one does.
    const bool room = scene.materials.size() + rig.materials.size() < kMaxMaterials;
    const auto first_material = static_cast<std::uint32_t>(scene.materials.size());
    if (room) {
        scene.materials.insert(scene.materials.end(), rig.materials.begin(), rig.materials.end());
    }
    for (std::size_t a = 0; a < kPlaces; ++a) {
        const auto& place = state_->places[a];
        if (!state_->shows(place)) continue;
        for (std::size_t p = 0; p < rig.parts.size(); ++p) {
            MeshNode node;
            node.id = first_id + static_cast<std::uint32_t>(a * rig.parts.size() + p);
            node.mesh = rig.parts[p].mesh;
            node.world_from_object = place->world_from_object;
            node.previous_world_from_object = place->previous;
            node.material =
                rig.parts[p].material == 0 || !room ? 0 : first_material + rig.parts[p].material;
            node.pose = place->pose;
            node.skin = state_->options.skin;
            scene.meshes.push_back(std::move(node));
        }
    }
}

std::size_t AvatarTroupe::shown() const {
    return static_cast<std::size_t>(
        std::count_if(state_->places.begin(), state_->places.end(),
                      [&](const auto& place) { return state_->shows(place); }));
}

bool AvatarTroupe::idling() const {
    return std::any_of(state_->places.begin(), state_->places.end(),
                       [](const auto& place) { return place && place->idle && !place->left; });
}

const AvatarRig& AvatarTroupe::rig() const {
    return *state_->rig;
}

void AvatarTroupe::set_options(const AvatarOptions& options) {
    state_->options = options;
}

}  // namespace kino
