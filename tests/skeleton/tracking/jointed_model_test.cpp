#include "skeleton/tracking/jointed_model.h"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>

#include "skeleton/tracking/body_limits.h"
#include "skeleton/tracking/pose_guess.h"
#include "tests/support/random.h"

namespace kino {
namespace {

using glm::vec3;
using test::Random;

vec3 random_vector(Random& random) {
    return {static_cast<float>(random.real(-1, 1)), static_cast<float>(random.real(-1, 1)),
            static_cast<float>(random.real(-1, 1))};
}

JointedModel random_model(std::uint64_t seed) {
    Random random(seed);
    JointedModel model;
    model.pose.hips_m = random_vector(random) + vec3(0, 0, 2.5f);
    model.pose.pelvis = rotation_of(random_vector(random) * 2.0f);
    model.pose.chest = rotation_of(random_vector(random) * 0.3f) * model.pose.pelvis;
    for (vec3& d : model.pose.direction) d = unit_or(random_vector(random), vec3(0, 1, 0));
    for (float& f : model.shape.factor) f = static_cast<float>(random.real(0.8, 1.2));
    model.linearize();
    return model;
}

TEST(JointedModel, BonesKeepTheirLengthInAnyPose) {
    JointedModel a = random_model(1);
    for (std::uint64_t seed = 2; seed < 12; ++seed) {
        JointedModel b = random_model(seed);
        b.shape = a.shape;
        b.place();
        for (std::size_t j = 0; j < kJointCount; ++j) {
            const auto parent = static_cast<std::size_t>(kJointParent[j]);
            EXPECT_NEAR(glm::length(a.node[j] - a.node[parent]),
                        glm::length(b.node[j] - b.node[parent]), 2e-6)
                << joint_name(static_cast<Joint>(j));
        }
    }
}

TEST(JointedModel, JacobianIsTheDerivativeOfEveryNodeByEveryUnknown) {
    constexpr float kStep = 1e-3f;
    for (std::uint64_t seed = 1; seed < 5; ++seed) {
        const JointedModel model = random_model(seed);
        for (int u = 0; u < kUnknowns; ++u) {
            std::array<float, kUnknowns> step{};
            step[static_cast<std::size_t>(u)] = kStep;
            JointedModel ahead = model, back = model;
            ahead.move(step);
            step[static_cast<std::size_t>(u)] = -kStep;
            back.move(step);
            for (std::size_t n = 0; n < kNodeCount; ++n) {
                const vec3 numeric = (ahead.node[n] - back.node[n]) / (2 * kStep);
                vec3 analytic(0);
                const NodeJacobian& j = model.jacobian[n];
                for (std::size_t e = 0; e < static_cast<std::size_t>(j.count); ++e) {
                    if (j.unknown[e] == u) analytic += j.derivative[e];
                }
                EXPECT_LT(glm::length(numeric - analytic), 1.5e-3f)
                    << "node " << n << " unknown " << u << " seed " << seed;
            }
        }
    }
}

TEST(JointedModel, TwoMirroredPosesAreOnePose) {
    const JointedPose pose = random_model(3).pose;
    const JointedPose twice = mirrored(mirrored(pose));
    EXPECT_EQ(pose.direction, twice.direction);
    EXPECT_EQ(pose.pelvis, twice.pelvis);
    EXPECT_EQ(pose.chest, twice.chest);
    // A frame stays right-handed.
    EXPECT_GT(glm::dot(glm::cross(mirrored(pose).chest[0], mirrored(pose).chest[1]),
                       mirrored(pose).chest[2]),
              0.999f);
}

TEST(JointedModel, TurnsAndTheirVectorsAreInverse) {
    Random random(7);
    for (int i = 0; i < 200; ++i) {
        const vec3 turn = random_vector(random) * 1.7f;
        EXPECT_LT(glm::length(turn_of(rotation_of(turn)) - turn), 2e-5f) << i;
    }
}

TEST(JointedModel, OppositeDirectionsHaveAShortestArc) {
    const vec3 down(0, 1, 0);
    const glm::mat3 half = shortest_arc(down, -down, vec3(1, 0, 0));
    EXPECT_LT(glm::length(half * down + down), 1e-5f);
    EXPECT_LT(glm::length(half * vec3(1, 0, 0) - vec3(1, 0, 0)), 1e-5f);
}

TEST(JointedModel, AStandingPersonOffendsNoLimit) {
    const JointedPose pose = resting_pose({0, 0, 2}, {0, -1, 0}, {0, 0, -1});
    for (const DirectionLimit& limit : direction_limits(pose)) {
        EXPECT_LE(glm::dot(limit.outward, pose[limit.segment]), limit.most)
            << static_cast<int>(limit.segment);
    }
}

TEST(JointedModel, AKneeBentForwardOffendsALimit) {
    JointedPose pose = resting_pose({0, 0, 2}, {0, -1, 0}, {0, 0, -1});
    pose[Segment::shin_left] = glm::normalize(vec3(0, 1, -0.6f));
    bool offended = false;
    for (const DirectionLimit& limit : direction_limits(pose)) {
        offended |= limit.segment == Segment::shin_left &&
                    glm::dot(limit.outward, pose[limit.segment]) > limit.most;
    }
    EXPECT_TRUE(offended);
}

}  // namespace
}  // namespace kino
