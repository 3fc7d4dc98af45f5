#include "skeleton/actors/scripted_motion.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include "skeleton/actors/actor_random.h"
#include "skeleton/synthetic/motion.h"

namespace kino {
namespace {

using glm::dvec3;

constexpr int kFrames = 300;
constexpr double kToRight = -M_PI / 2;  // towards -x

double ease(double from, double to, double t) {
    const double x = std::clamp((t - from) / (to - from), 0.0, 1.0);
    return x * x * (3 - 2 * x);
}

double sign_of(std::size_t side) {
    return side == 0 ? 1.0 : -1.0;
}

// Walking legs on any way; `pace` 0 stands, 1 walks.
BodyPose on_the_way(double t, double pace, double x, double yaw) {
    BodyPose walk = pose_at(Motion::walk, 1.8 * t), stand = pose_at(Motion::idle, t);
    for (BodyPose* pose : {&walk, &stand}) {
        pose->place_m = {x, 0, 0};
        pose->yaw_rad = yaw;
    }
    return blend(stand, walk, pace);
}

void arms_of(BodyPose& pose, double w, const dvec3& upper, const dvec3& lower) {
    BodyPose other = pose;
    for (std::size_t side = 0; side < 2; ++side) {
        const dvec3 turn(sign_of(side), 1, 1);
        ArmPose& arm = other.arm[side];
        arm.upper = glm::normalize(upper * turn);
        arm.lower = glm::normalize(lower * turn);
        arm.hand = arm.lower;
        arm.palm = dvec3(-sign_of(side), 0, 0);
    }
    pose = blend(pose, other, w);
}

BodyPose cross(double t) {
    const double x = 1.4 - 2.8 * ease(0.2, 4.3, t) + 2.8 * ease(5.2, 9.3, t);
    const double yaw = kToRight + M_PI * (ease(4.2, 5.2, t) - ease(9.2, 10.0, t));
    const double pace = 1 - ease(4.0, 4.3, t) * ease(5.4, 5.1, t) - ease(9.1, 9.4, t);
    return on_the_way(t, std::clamp(pace, 0.0, 1.0), x, yaw);
}

BodyPose enter(double t) {
    const double x = 3.4 - 3.4 * ease(0.0, 3.6, t) - 3.4 * ease(7.0, 10.0, t);
    const double yaw = kToRight * (1 - ease(3.2, 4.0, t) + ease(6.6, 7.2, t));
    const double pace = 1 - ease(3.3, 3.7, t) + ease(6.9, 7.2, t);
    BodyPose pose = on_the_way(t, pace, x, yaw);
    BodyPose waving = pose;
    waving.arm[1] = pose_at(Motion::wave, t).arm[1];
    return blend(pose, waving, ease(3.8, 4.6, t) * ease(6.6, 6.0, t));
}

BodyPose hug(double t) {
    const double near = ease(1.0, 3.0, t) * ease(9.2, 7.2, t);
    const double pace =
        std::max(ease(0.9, 1.2, t) * ease(3.1, 2.8, t), ease(7.1, 7.4, t) * ease(9.3, 9.0, t));
    BodyPose pose = on_the_way(t, pace, 0.95 - 0.79 * near, kToRight);
    arms_of(pose, ease(2.0, 3.2, t) * ease(7.8, 6.8, t), {0.55, -0.35, 0.75}, {-0.65, 0.05, 0.75});
    return pose;
}

BodyPose hold(double t) {
    BodyPose pose = pose_at(Motion::idle, t);
    pose.place_m = {0, 0, 0};
    const double lift = 0.25 * std::sin(2 * M_PI * t / 5);
    arms_of(pose, 1, {0.30, -0.90, 0.35 + 0.5 * lift}, {-0.02, 0.10 + lift, 1});
    pose.yaw_rad = 0.4 * std::sin(2 * M_PI * t / 10);
    return pose;
}

BodyPose wall(double t) {
    BodyPose pose = pose_at(Motion::idle, t);
    pose.place_m = {0, 0, 0};
    ArmPose& arm = pose.arm[0];
    const double up = 0.30 * std::sin(2 * M_PI * t / 5);
    arm.upper = glm::normalize(dvec3(1, up, 0.25));
    arm.lower = glm::normalize(dvec3(1, up + 0.15, 0.05));
    arm.hand = glm::normalize(dvec3(0.25, 1, 0.1));
    arm.palm = {1, 0, 0};
    arm.shrug_rad = 0.1;
    return pose;
}

class ScriptedMotion : public ActorMotion {
  public:
    ScriptedMotion(BodyPose (*play)(double), const ActorProps& props)
        : play_(play), props_(props) {}
    [[nodiscard]] int frames() const override { return kFrames; }
    [[nodiscard]] ActorProps props() const override { return props_; }
    [[nodiscard]] ActorPose pose(int frame) const override {
        return actor_pose(pose_body(play_(frame / kActorRateHz)));
    }

  private:
    BodyPose (*play_)(double);
    ActorProps props_;
};

class TurnedMotion : public ActorMotion {
  public:
    TurnedMotion(std::shared_ptr<const ActorMotion> motion, double yaw_rad)
        : motion_(std::move(motion)), yaw_rad_(yaw_rad) {}
    [[nodiscard]] int frames() const override { return motion_->frames(); }
    [[nodiscard]] ActorPose pose(int frame) const override {
        return turned(motion_->pose(frame), yaw_rad_);
    }

  private:
    std::shared_ptr<const ActorMotion> motion_;
    double yaw_rad_;
};

// On the back, the head to +x; the right arm goes up and down.
class LyingMotion : public ActorMotion {
  public:
    explicit LyingMotion(double yaw_rad) : yaw_rad_(yaw_rad) {}
    [[nodiscard]] int frames() const override { return kFrames; }
    [[nodiscard]] ActorPose pose(int frame) const override {
        BodyPose pose = standing_pose();
        pose.arm[1].upper = glm::normalize(
            dvec3(-0.2, -1, 1.3 * (0.5 - 0.5 * std::cos(2 * M_PI * frame / kActorRateHz / 5))));
        pose.arm[1].lower = pose.arm[1].hand = pose.arm[1].upper;
        const ActorPose up = actor_pose(pose_body(pose));
        return turned(up, glm::angleAxis(yaw_rad_, dvec3(0, 1, 0)) *
                              glm::angleAxis(-M_PI / 2, dvec3(1, 0, 0)));
    }

  private:
    double yaw_rad_;
};

}  // namespace

const std::vector<std::string>& scripted_motions() {
    static const std::vector<std::string> names = {"back",  "sideways", "lie",  "cross",
                                                   "enter", "hug",      "hold", "wall"};
    return names;
}

std::shared_ptr<const ActorMotion> scripted_motion(const std::string& name, std::uint64_t seed) {
    if (name == "cross")
        return std::make_shared<ScriptedMotion>(cross, ActorProps{.partner = true});
    if (name == "enter") return std::make_shared<ScriptedMotion>(enter, ActorProps{});
    if (name == "hug") return std::make_shared<ScriptedMotion>(hug, ActorProps{.partner = true});
    if (name == "hold") return std::make_shared<ScriptedMotion>(hold, ActorProps{.box = true});
    if (name == "wall") return std::make_shared<ScriptedMotion>(wall, ActorProps{.wall = true});
    // Feet to the left, a little towards the camera or away.
    if (name == "lie")
        return std::make_shared<LyingMotion>(-M_PI / 2 + 0.3 * ActorRandom{seed}.in(-1, 1));
    if (name == "back" || name == "sideways") {
        auto arms = make_actor_motion("arms", seed);
        return std::make_shared<TurnedMotion>(std::move(*arms), name == "back" ? M_PI : M_PI / 2);
    }
    return nullptr;
}

}  // namespace kino
