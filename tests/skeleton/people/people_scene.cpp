#include "tests/skeleton/people/people_scene.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <numbers>

#include "skeleton/synthetic/body_flesh.h"
#include "tests/support/random.h"

namespace kino::test {
namespace {

using glm::dvec3;

constexpr double kRad = std::numbers::pi / 180;
constexpr float kStepPerM = 0.00307f;  // of inverse depth, one raw step
constexpr float kSigmaSteps = 0.46f, kEdgeSteps = 6, kDropped = 0.45f;
constexpr float kNearM = 0.45f, kFarM = 8.0f;

}  // namespace

Actor actor_at(double x, double z, Motion motion, double t_s, double yaw_rad) {
    Actor a;
    a.pose = pose_at(motion, t_s);
    a.pose.place_m = dvec3(0, a.pose.place_m.y, -2.75);  // walking stays on the spot
    const glm::dquat turn = glm::angleAxis(yaw_rad, dvec3(0, 1, 0));
    a.world_from_body = {turn, dvec3(x, 0, z) - turn * dvec3(0, 0, -2.75)};
    return a;
}

Actor lying_at(double x, double z) {
    Actor a;
    a.pose = standing_pose();
    // Up becomes right, the front looks up.
    const glm::dmat3 turn(dvec3(0, 0, 1), dvec3(1, 0, 0), dvec3(0, 1, 0));
    a.world_from_body = {glm::normalize(glm::quat_cast(turn)), dvec3(x - 0.85, 0.14, z)};
    return a;
}

PeopleScene::PeopleScene(const RoomOptions& options)
    : options_(options), scene_(make_scene(Motion::idle, options.width, options.height)) {
    scene_.world_from_depth = Pose{glm::angleAxis(options.tilt_deg * kRad, dvec3(1, 0, 0)) *
                                       glm::angleAxis(options.roll_deg * kRad, dvec3(0, 0, 1)),
                                   dvec3(options.camera_x_m, options.camera_height_m, 0)} *
                              world_from_camera_axes();
    scene_.room.min_m.z = -options.back_wall_m;
    if (!options.furniture) scene_.furniture.clear();
    seen_ = std::make_unique<Visibility>(
        scene_, CastView(scene_.rig.depth, inverse(scene_.world_from_depth)), scene_.emitter_x_m());
    const CastView& view = seen_->view();
    rays_ = Image<RayXy>(view.width(), view.height());
    for (std::size_t i = 0; i < rays_.size(); ++i) {
        rays_.data()[i] = {view.ray_x().data()[i], view.ray_y().data()[i]};
    }
    Random random(5);
    for (int i = 0; i < 8192; ++i) {
        double sum = -6;
        for (int k = 0; k < 12; ++k) sum += random.real(0, 1);
        normal_.push_back(static_cast<float>(sum));
    }
}

glm::vec3 PeopleScene::up() const {
    return glm::vec3(inverse(scene_.world_from_depth).rotation * dvec3(0, 1, 0));
}

void PeopleScene::draw(std::span<const Actor> actors, std::uint64_t index) {
    std::vector<Primitive> solids;
    const int width = options_.width, height = options_.height;
    truth_ = Image<std::uint8_t>(width, height, 0);
    if (actors.empty()) {
        scene_.person_at(0, solids);
        for (Primitive& p : solids) p.origin_m += dvec3(0, 0, 100);  // behind the camera
        seen_->draw(solids);
        exact_ = seen_->z_m();
        lit_ = Image<std::uint8_t>(width, height, 0);
        for (std::size_t i = 0; i < lit_.size(); ++i) lit_.data()[i] = seen_->lit().data()[i] != 0;
    }
    for (std::size_t a = 0; a < actors.size(); ++a) {
        solids.clear();
        append_flesh(pose_body(actors[a].pose), solids);
        const Pose& place = actors[a].world_from_body;
        const glm::dmat3 turn = glm::mat3_cast(place.rotation);
        for (Primitive& p : solids) {
            p.origin_m = place * p.origin_m;
            p.axes = turn * p.axes;
        }
        seen_->draw(solids);
        if (a == 0) {
            exact_ = seen_->z_m();
            lit_ = Image<std::uint8_t>(width, height, 1);
        }
        for (std::size_t i = 0; i < exact_.size(); ++i) {
            const float z = seen_->z_m().data()[i];
            const bool person = seen_->id().data()[i] >= seen_->first_person_id();
            if (a == 0 || (person && z < exact_.data()[i])) {
                exact_.data()[i] = z;
                truth_.data()[i] = person ? static_cast<std::uint8_t>(a + 1) : std::uint8_t{0};
            }
            if (seen_->lit().data()[i] == 0) lit_.data()[i] = 0;
        }
    }
    add_noise(index);
    for (std::size_t i = 0; i < depth_.size(); ++i) {
        if (depth_.data()[i] == 0) truth_.data()[i] = 0;
    }
}

void PeopleScene::add_noise(std::uint64_t index) {
    depth_ = exact_;
    Random random(index * 977 + 11);
    const int width = depth_.width();
    for (int y = 0; y < depth_.height(); ++y) {
        const std::uint64_t start = random.bits(), drops = random.bits();
        for (int x = 0; x < width; ++x) {
            float& z = depth_.at(x, y);
            if (!lit_.at(x, y) || z < kNearM || z > kFarM) {
                z = 0;
                continue;
            }
            if (!options_.noise) continue;
            const float inverse = 1 / z;
            const float right = x + 1 < width ? exact_.at(x + 1, y) : z;
            const float below = y + 1 < depth_.height() ? exact_.at(x, y + 1) : z;
            const float jump =
                std::max(std::abs(1 / right - inverse), std::abs(1 / below - inverse));
            const std::uint64_t roll =
                (drops ^ (static_cast<std::uint64_t>(x) * 0x9E3779B97F4A7C15u)) *
                0xBF58476D1CE4E5B9u;
            const float chance = static_cast<float>(roll >> 40) / 16777216.0f;
            if (jump > kEdgeSteps * kStepPerM && chance < kDropped) {
                z = 0;
                continue;
            }
            const float noise = normal_[(start + static_cast<std::uint64_t>(x)) % normal_.size()];
            const float steps = std::round(inverse / kStepPerM + kSigmaSteps * noise);
            z = 1 / (kStepPerM * std::max(steps, 1.0f));
        }
    }
}

}  // namespace kino::test
