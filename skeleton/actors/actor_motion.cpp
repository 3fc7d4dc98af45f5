#include "skeleton/actors/actor_motion.h"

#include <algorithm>
#include <cmath>

#include "skeleton/actors/actor_sequence.h"
#include "skeleton/actors/gesture_motion.h"
#include "skeleton/actors/pose_library.h"
#include "skeleton/actors/recorded_motion.h"
#include "skeleton/actors/scripted_motion.h"
#include "skeleton/synthetic/motion.h"

namespace kino {
namespace {

// A loop of skeleton/synthetic, from some moment on.
class LoopMotion : public ActorMotion {
  public:
    LoopMotion(Motion motion, double start_s) : motion_(motion), start_s_(start_s) {}
    [[nodiscard]] int frames() const override { return 300; }
    [[nodiscard]] ActorPose pose(int frame) const override {
        BodyPose pose = pose_at(motion_, start_s_ + frame / kActorRateHz);
        pose.place_m -= glm::dvec3(0, 0, -2.75);
        return actor_pose(pose_body(pose));
    }

  private:
    Motion motion_;
    double start_s_;
};

double ease(double x) {
    return x * x * x * (x * (6 * x - 15) + 10);
}

// From pose to pose, with rests between; the feet are set anew now and then.
class WanderMotion : public ActorMotion {
  public:
    WanderMotion(Stance stance, bool arms_only, std::uint64_t seed) : stance_(stance) {
        ActorRandom random{seed, 0x3A4D};
        BodyPose pose = random_pose(random, stance);
        double yaw = 0;
        for (double t = 0; t < kFrames / kActorRateHz + 3;) {
            keys_.push_back({t, pose});
            if (random.chance(0.35)) {  // stay
                t += random.in(0.2, 0.8);
                keys_.push_back({t, pose});
            }
            t += random.in(0.45, 1.5);
            if (!arms_only && stance != Stance::sitting && random.chance(0.3)) {
                pose = random_pose(
                    random, stance == Stance::standing ? random_stance_on_feet(random) : stance);
                yaw = std::clamp(yaw + random.normal(0, 0.5), -1.2, 1.2);
                pose.yaw_rad = yaw;
                pose.place_m.x = std::clamp(random.normal(0, 0.25), -0.5, 0.5);
                pose.place_m.z = std::clamp(random.normal(0, 0.2), -0.4, 0.4);
            } else {
                change_upper_body(random, pose);
            }
        }
    }
    [[nodiscard]] int frames() const override { return kFrames; }
    [[nodiscard]] ActorProps props() const override { return {.seat = stance_ == Stance::sitting}; }
    [[nodiscard]] ActorPose pose(int frame) const override {
        const double t = frame / kActorRateHz;
        std::size_t next = 1;
        while (next + 1 < keys_.size() && keys_[next].t < t) ++next;
        const Key &a = keys_[next - 1], &b = keys_[next];
        const double w = ease(std::clamp((t - a.t) / (b.t - a.t), 0.0, 1.0));
        return actor_pose(pose_body(blend(a.pose, b.pose, w)));
    }

  private:
    static constexpr int kFrames = 300;
    struct Key {
        double t;
        BodyPose pose;
    };
    static Stance random_stance_on_feet(ActorRandom& random) {
        const double kind = random.unit();
        return kind < 0.6    ? Stance::standing
               : kind < 0.85 ? Stance::stepping
               : kind < 0.93 ? Stance::crouching
                             : Stance::bending;
    }
    Stance stance_;
    std::vector<Key> keys_;
};

}  // namespace

std::vector<std::string> actor_motions() {
    std::vector<std::string> names = {"arms", "wander", "sit", "crouch", "bend"};
    for (const Motion motion : all_motions()) names.emplace_back(motion_name(motion));
    names.insert(names.end(), gesture_motions().begin(), gesture_motions().end());
    names.insert(names.end(), scripted_motions().begin(), scripted_motions().end());
    for (const BuiltInRecording& recording : built_in_recordings()) {
        names.emplace_back(recording.name);
    }
    return names;
}

Result<std::shared_ptr<const ActorMotion>> make_actor_motion(const std::string& name,
                                                             std::uint64_t seed) {
    ActorRandom random{seed, 0x307};
    if (name == "arms")
        return std::make_shared<WanderMotion>(Stance::standing, true, random.bits());
    if (name == "wander")
        return std::make_shared<WanderMotion>(Stance::standing, false, random.bits());
    if (name == "sit") return std::make_shared<WanderMotion>(Stance::sitting, true, random.bits());
    if (name == "crouch")
        return std::make_shared<WanderMotion>(Stance::crouching, true, random.bits());
    if (name == "bend")
        return std::make_shared<WanderMotion>(Stance::bending, false, random.bits());
    if (const auto motion = motion_from_name(name)) {
        // The first plays from its beginning, others anywhere, so that two do not move alike.
        return std::make_shared<LoopMotion>(*motion,
                                            seed % 2 == 0 ? 0 : random.in(0, kMotionPeriodS));
    }
    if (auto gesture = gesture_motion(name)) return gesture;
    if (auto scripted = scripted_motion(name, random.bits())) return scripted;
    if (auto recorded = built_in_motion(name)) return recorded;
    if (name.starts_with("log:")) {
        KINO_ASSIGN(const JointRecording recording, read_joint_recording(name.substr(4)));
        return recorded_motion(recording, false);
    }
    std::string known;
    for (const std::string& n : actor_motions()) known += (known.empty() ? "" : ", ") + n;
    return fail("there is no such motion", name, "known are " + known + ", log:FILE");
}

}  // namespace kino
