#include "skeleton/actors/gesture_motion.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>

#include "base/check.h"
#include "skeleton/actors/pose_library.h"
#include "skeleton/synthetic/motion.h"

namespace kino {
namespace {

using glm::dvec3;

constexpr int kRight = 1;

double ease_to_rest(double from, double to, double t) {
    const double x = std::clamp((t - from) / (to - from), 0.0, 1.0);
    return x * x * x * (x * (6 * x - 15) + 10);
}

BodyPose at_ease(double t) {
    BodyPose pose = pose_at(Motion::idle, t);
    pose.place_m = {0, 0, 0};
    return pose;
}

struct Stroke {
    dvec3 from_m, to_m;  ///< of the right wrist, chest frame
    double stroke_s = 0.35;
};

// Up to `from`, rest, stroke, rest at `to`, down: thrice in ten seconds.
BodyPose stroking(const Stroke& s, double t) {
    const double local = std::fmod(t, 10.0 / 3);
    const BodyPose rest = at_ease(t);
    // By way of places, not of directions: the hand goes straight.
    BodyPose going = rest;
    going.arm[kRight] =
        arm_to(kRight, glm::mix(s.from_m, s.to_m, ease_to_rest(1.4, 1.4 + s.stroke_s, local)));
    const double up = ease_to_rest(0.1, 0.9, local), down = ease_to_rest(2.4, 3.2, local);
    return blend(blend(rest, going, up), rest, down);
}

BodyPose holding(const dvec3& wrist, double t) {
    const double local = std::fmod(t, 5.0);
    const BodyPose rest = at_ease(t);
    BodyPose out = rest;
    out.arm[kRight] = arm_to(kRight, wrist);
    return blend(rest, out, ease_to_rest(0.3, 1.2, local) - ease_to_rest(3.9, 4.8, local));
}

// Both hands in front; `half_m` apart from the middle, turned by `angle_rad` in the picture.
BodyPose both_hands(double t, double half_m, double angle_rad) {
    const BodyPose rest = at_ease(2 * t);
    BodyPose out = rest;
    for (int side = 0; side < 2; ++side) {
        const double s = side == 0 ? 1 : -1;
        const dvec3 wrist(s * half_m * std::cos(angle_rad), 0.29 + s * half_m * std::sin(angle_rad),
                          0.40);
        out.arm[static_cast<std::size_t>(side)] = arm_to(side, wrist);
    }
    return blend(rest, out, ease_to_rest(0.5, 1.2, t) - ease_to_rest(3.4, 4.1, t));
}

BodyPose zooming(double t) {
    const double local = std::fmod(t, 5.0);
    const double wide = ease_to_rest(1.5, 2.3, local) - ease_to_rest(2.3, 3.2, local);
    return both_hands(local, 0.12 + 0.22 * wide, 0);
}

BodyPose rotating(double t) {
    const double local = std::fmod(t, 5.0);
    const double turn = ease_to_rest(1.5, 2.3, local) - ease_to_rest(2.3, 3.2, local);
    return both_hands(local, 0.22, 0.9 * turn);
}

class PosedMotion : public ActorMotion {
  public:
    PosedMotion(std::function<BodyPose(double)> pose_at, double seconds, const ActorProps& props)
        : pose_at_(std::move(pose_at)),
          frames_(static_cast<int>(std::lround(seconds * kActorRateHz))),
          props_(props) {
        KINO_CHECK(frames_ > 0);
    }
    [[nodiscard]] int frames() const override { return frames_; }
    [[nodiscard]] ActorProps props() const override { return props_; }
    [[nodiscard]] ActorPose pose(int frame) const override {
        return actor_pose(pose_body(pose_at_(frame / kActorRateHz)));
    }

  private:
    std::function<BodyPose(double)> pose_at_;
    int frames_;
    ActorProps props_;
};

}  // namespace

std::shared_ptr<const ActorMotion> posed_motion(std::function<BodyPose(double t_s)> pose_at,
                                                double seconds, const ActorProps& props) {
    return std::make_shared<PosedMotion>(std::move(pose_at), seconds, props);
}

const std::vector<std::string>& gesture_motions() {
    static const std::vector<std::string> names = {
        "gesture-swipe-left", "gesture-swipe-right", "gesture-swipe-up",
        "gesture-swipe-down", "gesture-push",        "gesture-zoom",
        "gesture-rotate",     "gesture-dwell",       "gesture-raise"};
    return names;
}

std::shared_ptr<const ActorMotion> gesture_motion(const std::string& name) {
    const auto stroke = [](const dvec3& from, const dvec3& to) {
        return posed_motion([s = Stroke{from, to}](double t) { return stroking(s, t); }, 10);
    };
    // x to the person's left; shoulders are at 0.305.
    const dvec3 left(0.12, 0.25, 0.40), right(-0.42, 0.25, 0.38), high(-0.17, 0.52, 0.38),
        low(-0.17, 0.05, 0.40);
    if (name == "gesture-swipe-left") return stroke(right, left);
    if (name == "gesture-swipe-right") return stroke(left, right);
    if (name == "gesture-swipe-up") return stroke(low, high);
    if (name == "gesture-swipe-down") return stroke(high, low);
    if (name == "gesture-push") return stroke({-0.20, 0.22, 0.20}, {-0.17, 0.28, 0.50});
    if (name == "gesture-zoom") return posed_motion(zooming, 10);
    if (name == "gesture-rotate") return posed_motion(rotating, 10);
    if (name == "gesture-dwell") {
        return posed_motion([](double t) { return holding({-0.20, 0.30, 0.46}, t); }, 10);
    }
    if (name == "gesture-raise") {
        return posed_motion([](double t) { return holding({-0.25, 0.82, 0.05}, t); }, 10);
    }
    return nullptr;
}

}  // namespace kino
