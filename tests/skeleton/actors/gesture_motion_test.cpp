#include "skeleton/actors/gesture_motion.h"

#include <gtest/gtest.h>

#include <map>

#include "skeleton/actors/actor_sequence.h"
#include "skeleton/actors/actor_stage.h"
#include "skeleton/gestures/gesture_recognizer.h"

namespace kino {
namespace {

// True joints of somebody who plays it 2.5 m before the camera.
std::map<GestureKind, int> seen_in(const ActorMotion& motion, const ActorBody& body) {
    const Pose view_from_world = inverse(camera_pose(0.2, 0));
    GestureRecognizer recognizer;
    std::map<GestureKind, int> count;
    for (int i = 0; i < motion.frames(); ++i) {
        ActorPose pose = motion.pose(i);
        pose.place_m += glm::dvec2(0, -2.5);
        const PosedBones bones = pose_bones(body, pose);
        BodyFrame frame;
        frame.time = from_seconds(100 + i / kActorRateHz);
        Body& seen = frame.bodies.emplace_back();
        seen.id = 1;
        for (std::size_t j = 0; j < kJointCount; ++j) {
            seen.joints[j] = {glm::vec3(view_from_world * bones.joint_m[j]), JointState::tracked,
                              1};
        }
        for (const GestureEvent& e : recognizer.update(frame)) {
            if (e.phase == GesturePhase::once || e.phase == GesturePhase::begin) ++count[e.kind];
        }
    }
    return count;
}

TEST(GestureMotions, AreTheGesturesTheyAreNamedFor) {
    const std::map<std::string, std::map<GestureKind, int>> expected = {
        {"gesture-swipe-left", {{GestureKind::swipe_left, 3}}},
        {"gesture-swipe-right", {{GestureKind::swipe_right, 3}}},
        {"gesture-swipe-up", {{GestureKind::swipe_up, 3}}},
        {"gesture-swipe-down", {{GestureKind::swipe_down, 3}}},
        {"gesture-push", {{GestureKind::push, 3}}},
        {"gesture-zoom", {{GestureKind::zoom, 2}}},
        {"gesture-rotate", {{GestureKind::rotate, 2}}},
        {"gesture-dwell", {{GestureKind::dwell, 2}}},
        {"gesture-raise", {{GestureKind::raise, 2}}},
    };
    ASSERT_EQ(expected.size(), gesture_motions().size());
    for (const std::uint64_t seed : {1, 2, 3}) {
        const ActorBody body = make_actor_body(random_look(seed));
        for (const auto& [name, gestures] : expected) {
            const auto motion = gesture_motion(name);
            ASSERT_TRUE(motion);
            EXPECT_EQ(seen_in(*motion, body), gestures) << name << " by person " << seed;
        }
    }
    EXPECT_FALSE(gesture_motion("gesture-none"));
}

TEST(GestureMotions, ScriptsOfOthersArePlayed) {
    ActorTake take{.seed = 3, .furniture = false};
    take.script = posed_motion([](double) { return standing_pose(); }, 2.0);
    const auto sequence = ActorSequence::create(take);
    ASSERT_TRUE(sequence);
    EXPECT_EQ((*sequence)->frames(), 60);
    ActorFrame frame;
    (*sequence)->render(59, frame);
    ASSERT_EQ(frame.truth.bodies.size(), 1u);
    EXPECT_EQ(frame.truth.bodies[0][Joint::spine].state, JointState::tracked);
}

}  // namespace
}  // namespace kino
