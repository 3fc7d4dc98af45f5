#include "skeleton/synthetic/motion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <string>
#include <vector>

#include "skeleton/synthetic/body_flesh.h"

namespace kino {
namespace {

using glm::dvec3;

class EveryMotion : public testing::TestWithParam<Motion> {};
INSTANTIATE_TEST_SUITE_P(Motions, EveryMotion, testing::ValuesIn(all_motions()),
                         [](const auto& test) { return std::string(motion_name(test.param)); });

PosedBody body_at(Motion motion, double t) {
    return pose_body(pose_at(motion, t));
}

double bone(const PosedBody& body, std::size_t joint) {
    const auto parent = static_cast<std::size_t>(kJointParent[joint]);
    return glm::length(body.joint_m[joint] - body.joint_m[parent]);
}

TEST_P(EveryMotion, KeepsEveryBoneItsLength) {
    const PosedBody first = pose_body(standing_pose());
    for (int frame = 0; frame < 300; ++frame) {
        const PosedBody body = body_at(GetParam(), frame / 30.0);
        for (std::size_t j = 1; j < kJointCount; ++j) {
            ASSERT_NEAR(bone(body, j), bone(first, j), 1e-9)
                << joint_name(static_cast<Joint>(j)) << " frame " << frame;
        }
    }
}

TEST_P(EveryMotion, IsASeamlessLoopWithoutJumps) {
    // Hands move fastest; nobody here throws: 5 m/s, the wrap-around included.
    for (int frame = 0; frame < 300; ++frame) {
        const PosedBody now = body_at(GetParam(), frame / 30.0);
        const PosedBody next = body_at(GetParam(), (frame + 1) / 30.0);
        for (std::size_t j = 0; j < kJointCount; ++j) {
            ASSERT_LT(glm::length(next.joint_m[j] - now.joint_m[j]), 5.0 / 30)
                << joint_name(static_cast<Joint>(j)) << " frame " << frame;
        }
    }
    const PosedBody start = body_at(GetParam(), 0), end = body_at(GetParam(), kMotionPeriodS);
    const PosedBody late = body_at(GetParam(), kMotionPeriodS - 1e-7);
    for (std::size_t j = 0; j < kJointCount; ++j) {
        EXPECT_EQ(start.joint_m[j], end.joint_m[j]);
        EXPECT_LT(glm::length(start.joint_m[j] - late.joint_m[j]), 1e-5);
    }
}

bool inside(const Primitive& p, const dvec3& point) {
    const dvec3 local = glm::inverse(p.axes) * (point - p.origin_m);
    // Round cone as its balls, sampled along the axis.
    for (int i = 0; i <= 200; ++i) {
        const double s = i / 200.0;
        const double r = p.radius_a + s * (p.radius_b - p.radius_a);
        if (glm::length(local - dvec3(0, s * p.height, 0)) <= r) return true;
    }
    return false;
}

TEST_P(EveryMotion, HasFleshRoundEveryJointAndFeetAboveTheFloor) {
    for (const double t : {0.0, 1.3, 2.9, 4.4, 5.5, 7.1, 8.6}) {
        const PosedBody body = body_at(GetParam(), t);
        std::vector<Primitive> flesh;
        append_flesh(body, flesh);
        for (std::size_t j = 0; j < kJointCount; ++j) {
            bool covered = false;
            for (const Primitive& p : flesh) covered = covered || inside(p, body.joint_m[j]);
            EXPECT_TRUE(covered) << joint_name(static_cast<Joint>(j)) << " at " << t;
            EXPECT_GT(body.joint_m[j].y, 0.015);
        }
    }
}

TEST(Motion, NamesRoundTripAndUnknownOnesAreNone) {
    for (const Motion motion : all_motions()) {
        EXPECT_EQ(motion_from_name(motion_name(motion)), motion);
    }
    EXPECT_FALSE(motion_from_name("moonwalk"));
    EXPECT_FALSE(motion_from_name(""));
}

TEST(Motion, WalkingFeetDoNotSlide) {
    // While an ankle is at its lowest it stands still in the world.
    int standing = 0;
    for (int frame = 0; frame < 300; ++frame) {
        const PosedBody now = body_at(Motion::walk, frame / 30.0);
        const PosedBody next = body_at(Motion::walk, (frame + 1) / 30.0);
        for (const Joint ankle : {Joint::ankle_left, Joint::ankle_right}) {
            if (now[ankle].y > 0.0881 || next[ankle].y > 0.0881) continue;
            ++standing;
            EXPECT_LT(glm::length(next[ankle] - now[ankle]), 0.004) << "frame " << frame;
        }
    }
    EXPECT_GT(standing, 250);
}

TEST(BodyModel, StandsAsTallAsAPersonOf175cm) {
    std::vector<Primitive> flesh;
    append_flesh(pose_body(standing_pose()), flesh);
    double top = 0, bottom = 1;
    for (const Primitive& p : flesh) {
        for (const double s : {0.0, 1.0}) {
            const double r = s == 0.0 ? p.radius_a : p.radius_b;
            const dvec3 center = p.origin_m + p.axes * dvec3(0, s * p.height, 0);
            const glm::dmat3 rows = glm::transpose(p.axes);
            const double reach = r * glm::length(rows * dvec3(0, 1, 0));
            top = std::max(top, center.y + reach);
            bottom = std::min(bottom, center.y - reach);
        }
    }
    EXPECT_NEAR(top - bottom, 1.75, 0.03);
    EXPECT_NEAR(bottom, 0, 0.012);
}

TEST(BodyModel, ATargetOutOfReachStretchesTheLegAndKeepsItsLength) {
    BodyPose pose = standing_pose();
    pose.leg[0].ankle_m = {0.1, -5, 0};
    pose.leg[1].ankle_m = pose.pelvis_m + dvec3(-0.092, -0.05, 0);  // in the hip itself
    const PosedBody body = pose_body(pose), first = pose_body(standing_pose());
    for (std::size_t j = 12; j < kJointCount; ++j) {
        EXPECT_NEAR(bone(body, j), bone(first, j), 1e-9) << joint_name(static_cast<Joint>(j));
    }
}

}  // namespace
}  // namespace kino
