#include "skeleton/actors/actor_pose.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "skeleton/actors/pose_draw.h"
#include "skeleton/actors/recorded_motion.h"
#include "skeleton/synthetic/motion.h"

namespace kino {
namespace {

using glm::dvec3;

double turn_of(const dvec3& a, const dvec3& b) {
    return std::acos(std::min(1.0, glm::dot(glm::normalize(a), glm::normalize(b))));
}

// The point of a pose without a body: every build shows the directions that were asked for.
TEST(ActorPose, DirectionsOfLimbsAreThoseAskedForOnAnyBody) {
    ActorRandom random{11};
    for (int i = 0; i < 30; ++i) {
        const ActorBody body = make_actor_body(random_look(random.bits()));
        const ActorPose pose = draw_pose(random).pose;
        const PosedBones bones = pose_bones(body, pose);
        const auto at = [&](Joint j, int side) {
            return bones.joint_m[static_cast<std::size_t>(j) + 4 * static_cast<std::size_t>(side)];
        };
        for (int side = 0; side < 2; ++side) {
            const auto s = static_cast<std::size_t>(side);
            // Unequal girths move a bone's end by a little in its own frame.
            EXPECT_LT(turn_of(at(Joint::elbow_left, side) - at(Joint::shoulder_left, side),
                              pose.upper_arm[s]),
                      0.06);
            EXPECT_LT(
                turn_of(at(Joint::wrist_left, side) - at(Joint::elbow_left, side), pose.forearm[s]),
                0.06);
            EXPECT_LT(
                turn_of(at(Joint::knee_left, side) - at(Joint::hip_left, side), pose.thigh[s]),
                0.06);
            EXPECT_LT(
                turn_of(at(Joint::ankle_left, side) - at(Joint::knee_left, side), pose.shin[s]),
                0.06);
        }
        for (const glm::dmat3& turn : bones.turn) {
            EXPECT_NEAR(glm::determinant(turn), 1, 1e-6);
            EXPECT_NEAR(glm::length(turn[0]), 1, 1e-6);
        }
    }
}

TEST(ActorPose, ComesBackFromItsOwnJoints) {
    const ActorBody body = make_actor_body({});
    for (const Motion motion : all_motions()) {
        const ActorPose pose = actor_pose(pose_body(pose_at(motion, 3.1)));
        const PosedBones bones = pose_bones(body, pose);
        const ActorPose again = actor_pose(bones.joint_m, -10);  // far from any floor
        for (std::size_t s = 0; s < 2; ++s) {
            EXPECT_LT(turn_of(again.upper_arm[s], pose.upper_arm[s]), 0.03);
            EXPECT_LT(turn_of(again.forearm[s], pose.forearm[s]), 0.03);
            EXPECT_LT(turn_of(again.thigh[s], pose.thigh[s]), 0.03);
            EXPECT_LT(turn_of(again.shin[s], pose.shin[s]), 0.03);
        }
        EXPECT_LT(turn_of(again.chest[2], pose.chest[2]), 0.25) << motion_name(motion);
        EXPECT_LT(turn_of(again.pelvis[2], pose.pelvis[2]), 0.25) << motion_name(motion);
    }
}

TEST(ActorPose, MirrorsToTheMirroredBody) {
    const ActorBody body = make_actor_body({});
    ActorRandom random{12};
    for (int i = 0; i < 20; ++i) {
        const ActorPose pose = draw_pose(random).pose;
        const PosedBones a = pose_bones(body, pose), b = pose_bones(body, mirrored(pose));
        for (int j = 0; j < static_cast<int>(kJointCount); ++j) {
            const int limb = (j - 4) / 4;
            const int other = j < 4 ? j : j + (limb % 2 == 0 ? 4 : -4);
            const dvec3 p = a.joint_m[static_cast<std::size_t>(j)];
            EXPECT_LT(
                glm::distance(dvec3(-p.x, p.y, p.z), b.joint_m[static_cast<std::size_t>(other)]),
                1e-5)
                << joint_name(static_cast<Joint>(j));
        }
    }
}

TEST(ActorPose, TurningMovesNothingWithinTheBody) {
    const ActorBody body = make_actor_body({});
    ActorRandom random{13};
    const ActorPose pose = draw_pose(random).pose;
    std::vector<glm::vec3> still, round;
    pose_actor(body, pose, still);
    pose_actor(body, turned(pose, 2.2), round);
    for (std::size_t i = 0; i + 700 < still.size(); i += 50) {
        EXPECT_NEAR(glm::distance(still[i], still[i + 700]),
                    glm::distance(round[i], round[i + 700]), 1e-4);
        EXPECT_NEAR(still[i].y, round[i].y, 1e-4);
    }
    EXPECT_NEAR(turned(ActorPose{}, M_PI / 2).pelvis[2].x, 1, 1e-9);
}

// Joints that coincide say nothing about any direction.
TEST(ActorPose, OfDegenerateJointsIsFinite) {
    const ActorBody body = make_actor_body({});
    std::array<dvec3, kJointCount> joints{};
    const PosedBones bones = pose_bones(body, actor_pose(joints, 0));
    for (const dvec3& p : bones.joint_m) EXPECT_TRUE(std::isfinite(p.x + p.y + p.z));
}

TEST(RecordedMotion, StartsAtTheOriginFacingForward) {
    for (const BuiltInRecording& recording : built_in_recordings()) {
        const auto motion = built_in_motion(recording.name);
        ASSERT_TRUE(motion);
        for (int i = 0; i < motion->frames(); i += 7) {
            const ActorPose pose = motion->pose(i);
            EXPECT_LT(glm::length(pose.place_m), 1.2) << recording.name;
            EXPECT_GT(glm::determinant(pose.pelvis), 0.99);
        }
        EXPECT_GT(motion->pose(0).chest[2].z, 0.8) << recording.name;
        // Toes point where the person faces: left and right are not exchanged.
        EXPECT_GT(glm::dot(motion->pose(0).foot[0][2], motion->pose(0).pelvis[2]), 0.2)
            << recording.name;
    }
    EXPECT_GT(built_in_motion("cmu_01_01")->frames(), 600);
    EXPECT_FALSE(built_in_motion("nobody"));
}

}  // namespace
}  // namespace kino
