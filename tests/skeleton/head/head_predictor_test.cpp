#include "skeleton/head/head_predictor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <random>
#include <vector>

#include "skeleton/head/window_eye.h"

namespace kino {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

TimeNs ms(double t) {
    return from_seconds(t / 1000);
}

/// The textbook's filter with full 2x2 matrices, one axis: x = F x, P = F P F' + Q, then the update
/// by K = P H' / (H P H' + r).
struct MatrixFilter {
    double x[2] = {0, 0};
    double p[2][2] = {};
    void predict(double dt, double q) {
        const double f[2][2] = {{1, dt}, {0, 1}};
        const double noise[2][2] = {{q * std::pow(dt, 3) / 3, q * dt * dt / 2},
                                    {q * dt * dt / 2, q * dt}};
        const double moved[2] = {f[0][0] * x[0] + f[0][1] * x[1], f[1][0] * x[0] + f[1][1] * x[1]};
        double fp[2][2] = {}, fpf[2][2] = {};
        for (int i = 0; i < 2; ++i) {
            for (int j = 0; j < 2; ++j) {
                for (int k = 0; k < 2; ++k) fp[i][j] += f[i][k] * p[k][j];
            }
        }
        for (int i = 0; i < 2; ++i) {
            for (int j = 0; j < 2; ++j) {
                for (int k = 0; k < 2; ++k) fpf[i][j] += fp[i][k] * f[j][k];
                fpf[i][j] += noise[i][j];
            }
        }
        std::copy(moved, moved + 2, x);
        std::copy(&fpf[0][0], &fpf[0][0] + 4, &p[0][0]);
    }
    void update(double z, double r) {
        const double k[2] = {p[0][0] / (p[0][0] + r), p[1][0] / (p[0][0] + r)};
        const double innovation = z - x[0];
        const double top[2] = {p[0][0], p[0][1]};
        for (int i = 0; i < 2; ++i) {
            x[i] += k[i] * innovation;
            for (int j = 0; j < 2; ++j) p[i][j] -= k[i] * top[j];
        }
    }
};

TEST(HeadPredictor, EqualsTheMatrixFilterAtIrregularTimes) {
    std::mt19937 random(3);
    std::normal_distribution<double> noise(0, 0.01);
    std::uniform_real_distribution<double> gap(0.004, 0.11);
    const HeadPredictorOptions options;
    HeadPredictor head(options);
    MatrixFilter axis;
    double worst = 0;
    TimeNs time = from_seconds(7);
    for (int i = 0; i < 400; ++i) {
        const TimeNs step = from_seconds(gap(random));
        time += step;
        const double t = to_seconds(time);
        const glm::dvec3 truth{0.2 * std::sin(2 * t), 0.05 * std::cos(3 * t), 1.4};
        const glm::dvec3 seen = truth + glm::dvec3(noise(random), noise(random), noise(random));
        const double sigma = options.near_sigma_m + options.depth_sigma * seen.z * seen.z;
        if (i == 0) {
            axis.x[0] = seen.x;
            axis.p[0][0] = sigma * sigma;
            axis.p[1][1] = 1;
        } else {
            axis.predict(to_seconds(step), options.noise_m2_s3);
            axis.update(seen.x, sigma * sigma);
        }
        ASSERT_EQ(head.measure(time, seen, seen.z),
                  i == 0 ? HeadMeasurement::seeded : HeadMeasurement::taken);
        worst = std::max({worst, std::abs(head.at(time)->x - axis.x[0]),
                          std::abs(head.velocity_m_s().x - axis.x[1])});
    }
    EXPECT_LT(worst, 1e-6);
}

/// Largest error of predictions by tau for a head that moves as a sine, without noise.
double worst_error(double amplitude, double omega, double tau_s) {
    HeadPredictor head({.near_sigma_m = 1e-5, .depth_sigma = 0});
    double worst = 0;
    for (int i = 0; i < 600; ++i) {
        const double t = i / 120.0;
        const auto truth = [&](double at) { return amplitude * std::sin(omega * at); };
        head.measure(from_seconds(t), {truth(t), 0, 1}, 1);
        if (i < 60) continue;
        worst = std::max(worst, std::abs(head.at(from_seconds(t + tau_s))->x - truth(t + tau_s)));
    }
    return worst;
}

TEST(HeadPredictor, ErrorIsHalfTheAccelerationTimesTauSquared) {
    const double amplitude = 0.2, omega = 2.5;
    const double acceleration = amplitude * omega * omega;
    const double far = worst_error(amplitude, omega, 0.1);
    const double near = worst_error(amplitude, omega, 0.05);
    EXPECT_NEAR(far, acceleration * 0.1 * 0.1 / 2, 0.2 * acceleration * 0.1 * 0.1 / 2);
    EXPECT_NEAR(near, acceleration * 0.05 * 0.05 / 2, 0.2 * acceleration * 0.05 * 0.05 / 2);
    EXPECT_GE(far / near, 3.5);
}

TEST(HeadPredictor, TimestampsThatDoNotAdvanceAreSkipped) {
    HeadPredictor head;
    EXPECT_EQ(head.measure(ms(0), {0, 0, 1}, 1), HeadMeasurement::seeded);  // a timestamp of 0
    EXPECT_EQ(head.measure(ms(33), {0.01, 0, 1}, 1), HeadMeasurement::taken);
    const glm::dvec3 before = *head.at(ms(50));
    EXPECT_EQ(head.measure(ms(33), {0.5, 0, 1}, 1), HeadMeasurement::skipped);
    EXPECT_EQ(head.measure(ms(20), {0.5, 0, 1}, 1), HeadMeasurement::skipped);
    EXPECT_EQ(*head.at(ms(50)), before);
}

TEST(HeadPredictor, BeginsAnewAfterHalfASecond) {
    HeadPredictor head;
    for (int i = 0; i < 10; ++i) head.measure(ms(33 * i), {0.03 * i, 0, 1}, 1);
    EXPECT_FALSE(head.lost(ms(33 * 9 + 400)));
    EXPECT_TRUE(head.lost(ms(33 * 9 + 600)));
    EXPECT_EQ(head.measure(ms(33 * 9 + 600), {0.9, 0, 1}, 1), HeadMeasurement::seeded);
    EXPECT_EQ(head.velocity_m_s(), glm::dvec3(0));
    EXPECT_EQ(*head.at(ms(33 * 9 + 600)), glm::dvec3(0.9, 0, 1));
}

TEST(HeadPredictor, PredictsNoFartherThanItsLimitAndNoFasterThanHeadsMove) {
    HeadPredictor head({.gate_sigmas = 1e9});
    for (int i = 0; i < 30; ++i) head.measure(ms(33 * i), {0.3 * i, 0, 1}, 1);  // 9 m/s
    EXPECT_LE(glm::length(head.velocity_m_s()), 3 + 1e-9);
    const TimeNs last = ms(33 * 29);
    EXPECT_EQ(*head.at(last + ms(200)), *head.at(last + ms(5000)));
    EXPECT_LE(glm::distance(*head.at(last), *head.at(last + ms(5000))), 0.6 + 1e-9);
}

TEST(HeadPredictor, AJumpIsRefusedTwiceAndThenBelieved) {
    HeadPredictor head;
    for (int i = 0; i < 20; ++i) head.measure(ms(33 * i), {0, 0, 1}, 1);
    EXPECT_EQ(head.measure(ms(660), {1.5, 0, 1}, 1), HeadMeasurement::refused);
    EXPECT_EQ(head.measure(ms(693), {1.5, 0, 1}, 1), HeadMeasurement::refused);
    EXPECT_NEAR(head.at(ms(693))->x, 0, 0.02);
    EXPECT_EQ(head.measure(ms(726), {1.5, 0, 1}, 1), HeadMeasurement::seeded);
    EXPECT_EQ(head.at(ms(726))->x, 1.5);
    // One wrong reading among good ones changes nothing.
    head.measure(ms(759), {1.5, 0, 1}, 1);
    EXPECT_EQ(head.measure(ms(792), {0, 0, 1}, 1), HeadMeasurement::refused);
    EXPECT_EQ(head.measure(ms(825), {1.5, 0, 1}, 1), HeadMeasurement::taken);
}

TEST(HeadPredictor, WhatIsNoNumberKeepsTheLastPose) {
    HeadPredictor head;
    EXPECT_FALSE(head.at(0).has_value());
    EXPECT_EQ(head.measure(ms(1), {kNaN, 0, 1}, 1), HeadMeasurement::skipped);
    head.measure(ms(33), {0.1, 0.2, 1}, 1);
    EXPECT_EQ(head.measure(ms(66), {0.1, kNaN, 1}, 1), HeadMeasurement::skipped);
    EXPECT_EQ(head.measure(ms(66), {0.1, 0.2, 1}, kNaN), HeadMeasurement::skipped);
    EXPECT_EQ(*head.at(ms(66)), glm::dvec3(0.1, 0.2, 1));
}

Body person(std::uint32_t id, const glm::vec3& head_m) {
    Body body{.id = id};
    body[Joint::head] = {.position_m = head_m, .state = JointState::tracked, .confidence = 1};
    return body;
}

WindowEyeOptions facing() {
    // The sensor in the screen's centre: its right is the viewer's left, its down is down.
    return {.screen_from_sensor = {.rotation = glm::dquat(0, 0, 0, 1)}};
}

TEST(WindowEye, IsBeforeTheHeadOfWhoIsSeen) {
    WindowEye eye(facing());
    EXPECT_EQ(eye.at(0), facing().default_eye_m);
    for (int i = 0; i < 60; ++i) {
        const std::vector<Body> bodies{person(3, {0.2f, -0.1f, 1.0f})};
        eye.see(ms(33 * i), bodies);
    }
    EXPECT_EQ(eye.followed(), 3u);
    const glm::dvec3 at = eye.at(ms(33 * 59));
    EXPECT_NEAR(at.x, -0.2, 1e-3);
    EXPECT_NEAR(at.y, 0.1, 1e-3);
    EXPECT_NEAR(at.z, 0.92, 1e-3);
}

TEST(WindowEye, EasesToItsDefaultWithinASecondAndBackWithoutAJump) {
    WindowEye eye(facing());
    std::vector<Body> bodies{person(1, {0.3f, 0, 1.2f})};
    double largest_step = 0;
    glm::dvec3 last = eye.at(0);
    for (int t = 0; t < 8000; t += 10) {
        const bool there = t < 2500 || t > 5000;
        if (there && t % 30 == 0) eye.see(ms(t), bodies);
        const glm::dvec3 now = eye.at(ms(t));
        largest_step = std::max(largest_step, glm::distance(now, last));
        last = now;
        if (t == 2500 + 1600) {
            EXPECT_LT(glm::distance(now, facing().default_eye_m), 1e-9);
        }
    }
    EXPECT_NEAR(last.z, 1.12, 1e-3);
    // Half a metre and more within a second, at most one and a half times the mean speed.
    EXPECT_LT(largest_step, 0.016);
}

TEST(WindowEye, FollowsTheNearestWithHysteresis) {
    WindowEye eye(facing());
    const auto see = [&](TimeNs t, float a, float b) {
        const std::vector<Body> bodies{person(1, {0, 0, a}), person(2, {0, 0, b})};
        eye.see(t, bodies);
        return eye.followed();
    };
    EXPECT_EQ(see(ms(0), 1.2f, 1.5f), 1u);
    EXPECT_EQ(see(ms(33), 1.2f, 1.0f), 1u);
    EXPECT_EQ(see(ms(66), 1.4f, 1.0f), 2u);
    EXPECT_EQ(see(ms(99), 0.9f, 1.0f), 2u);
    const std::vector<Body> none;
    eye.see(ms(132), none);
    EXPECT_EQ(eye.followed(), 2u);
}

TEST(WindowEye, StaysANumberWhateverIsSeen) {
    WindowEye eye(facing());
    const float bad = std::numeric_limits<float>::quiet_NaN();
    const std::vector<Body> bodies{person(1, {bad, 0, 1}), person(2, {0, bad, bad})};
    eye.see(ms(10), bodies);
    EXPECT_EQ(eye.at(ms(20)), facing().default_eye_m);
    const std::vector<Body> good{person(1, {0, 0, 1})};
    eye.see(ms(10), good);
    eye.see(ms(10), bodies);
    eye.see(ms(5), good);
    const glm::dvec3 at = eye.at(ms(100));
    EXPECT_TRUE(std::isfinite(at.x) && std::isfinite(at.y) && std::isfinite(at.z));
}

}  // namespace
}  // namespace kino
