#include "apps/bench/body_score.h"

#include <gtest/gtest.h>

#include <cmath>

namespace kino {
namespace {

TEST(Wilson, BoundsAreWhereTheShareIsJustTwoDeviationsAway) {
    // Each bound b solves (share - b)^2 = z^2 b (1 - b) / n.
    constexpr double z = 1.959964;
    for (const std::size_t n : {1u, 2u, 10u, 51u, 77u, 5000u}) {
        for (std::size_t hits = 0; hits <= n; hits += std::max<std::size_t>(1, n / 7)) {
            const ShareInterval i = wilson(hits, n);
            const double size = static_cast<double>(n);
            EXPECT_DOUBLE_EQ(i.share, static_cast<double>(hits) / size);
            EXPECT_LE(i.low, i.share + 1e-12);
            EXPECT_GE(i.high, i.share - 1e-12);
            EXPECT_GE(i.low, -1e-12);
            EXPECT_LE(i.high, 1 + 1e-12);
            for (const double b : {i.low, i.high}) {
                EXPECT_NEAR((i.share - b) * (i.share - b), z * z * b * (1 - b) / size, 1e-12)
                    << hits << " of " << n;
            }
        }
    }
}

TEST(Wilson, NothingCountedSaysNothingAndTextbookValuesHold) {
    EXPECT_EQ(wilson(0, 0).low, 0);
    EXPECT_EQ(wilson(0, 0).high, 1);
    EXPECT_NEAR(wilson(5, 10).low, 0.2366, 1e-4);
    EXPECT_NEAR(wilson(5, 10).high, 0.7634, 1e-4);
    EXPECT_NEAR(wilson(0, 10).high, 0.2775, 1e-4);
}

TEST(BodyScore, ALostJointAndAMissedPersonCountAsTheStatedError) {
    BodyFrame truth, found;
    Body body;
    for (JointPosition& joint : body.joints) joint = {{0, 0, 2}, JointState::tracked, 1};
    truth.bodies.push_back(body);
    body.joints[3].state = JointState::lost;
    body.joints[5].position_m.x += 0.12f;
    found.bodies.push_back(body);
    BodyScore score;
    score.add(truth, found);
    const ErrorFigures f = score.figures();
    EXPECT_EQ(f.n, kJointCount);
    EXPECT_NEAR(f.mean_mm, (300 + 120) / 20.0, 1e-3);
    EXPECT_NEAR(f.within_100, 18 / 20.0, 1e-9);
    EXPECT_NEAR(f.within_150, 19 / 20.0, 1e-9);
    EXPECT_NEAR(f.lost, 1 / 20.0, 1e-9);

    BodyScore missed;
    missed.add(truth, BodyFrame{});
    EXPECT_NEAR(missed.figures().mean_mm, 300, 1e-9);
    // Somebody a metre away is somebody else.
    found.bodies[0][Joint::hip_center].position_m.x += 1.1f;
    BodyScore other;
    other.add(truth, found);
    EXPECT_NEAR(other.figures().lost, 1, 1e-9);
}

}  // namespace
}  // namespace kino
