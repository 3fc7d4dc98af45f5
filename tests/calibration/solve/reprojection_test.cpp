#include "calibration/solve/reprojection.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include "calibration/projection.h"
#include "tests/calibration/solve/synthetic_boards.h"

namespace kino {
namespace {

struct Case {
    Lens lens;
    TurnedPose camera;
    TurnedPose board;
    glm::dvec2 corner;
};

Case random_case(test::Random& random) {
    Case out;
    out.lens = {random.real(300, 900), random.real(300, 900), random.real(200, 400),
                random.real(200, 300)};
    for (std::size_t i = 4; i < 12; ++i) {
        out.lens[i] = (i == 6 || i == 7 ? 0.01 : 0.2) * random.real(-1, 1);
    }
    const double size = random.chance(0.2) ? 1e-6 : 1;
    for (std::size_t i = 0; i < 3; ++i) {
        out.camera[i] = size * random.real(-0.2, 0.2);
        out.camera[i + 3] = random.real(-0.1, 0.1);
        out.board[i] = size * random.real(-0.8, 0.8);
        out.board[i + 3] = random.real(-0.2, 0.2) + (i == 2 ? 0.9 : 0);
    }
    out.corner = {random.real(-0.2, 0.2), random.real(-0.2, 0.2)};
    return out;
}

bool seen(const Case& c, glm::dvec2& px, ReprojectionJacobian* jacobian = nullptr) {
    const PreparedPose camera = prepare(c.camera);
    return reproject(c.lens.data(), &camera, prepare(c.board), c.corner, px, jacobian);
}

TEST(Reprojection, AgreesWithProjection) {
    test::Random random(3);
    int compared = 0;
    for (int i = 0; i < 300; ++i) {
        const Case c = random_case(random);
        const Projection projection(camera_of(c.lens, 640, 480));
        const glm::dvec3 p = pose_of(c.camera) * (pose_of(c.board) * glm::dvec3(c.corner, 0));
        const auto expected = projection.project(p);
        glm::dvec2 px;
        if (!expected) continue;
        ASSERT_TRUE(seen(c, px));
        EXPECT_LT(glm::distance(px, *expected), 1e-9);
        ++compared;
    }
    EXPECT_GT(compared, 200);
}

TEST(Reprojection, DerivativesAgreeWithDifferences) {
    test::Random random(4);
    for (int i = 0; i < 200; ++i) {
        Case c = random_case(random);
        glm::dvec2 px;
        ReprojectionJacobian j;
        ASSERT_TRUE(seen(c, px, &j));
        const auto check = [&](auto& numbers, const auto& rows, std::size_t at) {
            const double step = 1e-6 * std::max(1.0, std::abs(numbers[at]));
            const double kept = numbers[at];
            glm::dvec2 above;
            glm::dvec2 below;
            numbers[at] = kept + step;
            ASSERT_TRUE(seen(c, above));
            numbers[at] = kept - step;
            ASSERT_TRUE(seen(c, below));
            numbers[at] = kept;
            const glm::dvec2 slope = (above - below) / (2 * step);
            const std::size_t columns = numbers.size();
            EXPECT_NEAR(rows[at], slope.x, 1e-5 * (1 + std::abs(slope.x))) << at;
            EXPECT_NEAR(rows[columns + at], slope.y, 1e-5 * (1 + std::abs(slope.y))) << at;
        };
        for (std::size_t k = 0; k < 12; ++k) check(c.lens, j.lens, k);
        for (std::size_t k = 0; k < 6; ++k) check(c.camera, j.camera, k);
        for (std::size_t k = 0; k < 6; ++k) check(c.board, j.board, k);
    }
}

TEST(Reprojection, BehindTheCameraIsNoPixel) {
    const Lens lens = {500, 500, 320, 240};
    const TurnedPose board = {0, 0, 0, 0, 0, -1};
    glm::dvec2 px;
    EXPECT_FALSE(reproject(lens.data(), nullptr, prepare(board), {0, 0}, px, nullptr));
}

TEST(TurnedPose, RoundTripsAlsoNearNothingAndHalfATurn) {
    for (const double angle : {0.0, 1e-12, 1e-5, 0.3, 3.14159, 3.2}) {
        const glm::dvec3 axis = glm::normalize(glm::dvec3(1, -2, 0.5));
        const Pose pose{glm::angleAxis(angle, axis), {0.1, -0.2, 3}};
        const Pose again = pose_of(turned(pose));
        EXPECT_NEAR(std::abs(glm::dot(again.rotation, pose.rotation)), 1, 1e-12) << angle;
        const glm::dvec3 p(0.3, 0.4, 0.5);
        EXPECT_LT(glm::distance(again * p, pose * p), 1e-12) << angle;
        const TurnedPose t = turned(pose);
        const glm::dvec3 by_matrix =
            rotation_of({t[0], t[1], t[2]}) * p + glm::dvec3(t[3], t[4], t[5]);
        EXPECT_LT(glm::distance(by_matrix, pose * p), 1e-12) << angle;
    }
}

}  // namespace
}  // namespace kino
