#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <glm/geometric.hpp>
#include <limits>

#include "skeleton/filters/filter_bank.h"
#include "skeleton/filters/holt_filter.h"
#include "skeleton/filters/kalman_filter.h"
#include "skeleton/filters/one_euro_filter.h"
#include "tests/skeleton/filters/tracks.h"

namespace kino {
namespace {

using glm::dvec3;
using test::body_at;
using test::run;
using test::sampled;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

class EveryFilter : public testing::TestWithParam<const char*> {
  protected:
    std::unique_ptr<BodyFilter> filter = std::move(*make_body_filter(GetParam()));
};

TEST_P(EveryFilter, ConstantInIsConstantOut) {
    const dvec3 at(0.25, -0.5, 2.0);
    for (const dvec3& p : run(*filter, std::vector<dvec3>(60, at), 1 / 30.0)) EXPECT_EQ(p, at);
    EXPECT_EQ(dvec3(filter->predict(from_seconds(100))[Joint::head].position_m), at);
}

TEST_P(EveryFilter, ShiftingTheWorldShiftsTheResult) {
    const auto track = test::with_noise(test::waving_hand(3, 30), 0.01, 3);
    const dvec3 shift(0.5, -0.25, 1.0);
    auto moved = track;
    for (dvec3& p : moved) p += shift;
    const auto a = run(*filter, track, 1 / 30.0);
    filter->reset();
    const auto b = run(*filter, moved, 1 / 30.0);
    for (std::size_t i = 0; i < a.size(); ++i) EXPECT_LT(glm::distance(a[i] + shift, b[i]), 1e-5);
}

TEST_P(EveryFilter, SameInputsGiveTheSameBits) {
    const auto track = test::with_noise(test::waving_hand(3, 30), 0.01, 4);
    const auto a = run(*filter, track, 1 / 30.0);
    auto again = std::move(*make_body_filter(GetParam()));
    EXPECT_EQ(a, run(*again, track, 1 / 30.0));
    filter->reset();
    EXPECT_EQ(a, run(*filter, track, 1 / 30.0));
}

TEST_P(EveryFilter, LinearMotionIsPredictedWithoutLag) {
    // Long enough for the slowest trend to settle.
    const dvec3 from(-0.5, 0.2, 2.5), speed(1.5, 0.5, -0.6);
    const auto track = sampled([&](double t) { return from + speed * t; }, 3, 30);
    run(*filter, track, 1 / 30.0);
    const TimeNs last = from_seconds(4);
    const dvec3 near(filter->predict(last)[Joint::head].position_m);
    const dvec3 far(filter->predict(last + 100 * kNsPerMs)[Joint::head].position_m);
    EXPECT_LT(glm::distance((far - near) / 0.1, speed), 0.05 * glm::length(speed));
}

TEST_P(EveryFilter, JumpsOfTimeAndOtherPeopleStartAnew) {
    run(*filter, test::waving_hand(1, 30), 1 / 30.0);
    const dvec3 there(1, 1, 3);
    const auto head = [&](Body body, TimeNs time) {
        return dvec3(filter->update(body, time)[Joint::head].position_m);
    };
    EXPECT_EQ(head(body_at(there), from_seconds(0.5)), there) << "earlier";
    EXPECT_EQ(head(body_at({0, 0, 1}), from_seconds(0.5)), there) << "the same time again";
    Body other = body_at({0, 0, 1});
    other.id = 2;
    EXPECT_EQ(head(other, from_seconds(0.53)), dvec3(0, 0, 1)) << "another id";
}

TEST_P(EveryFilter, ReappearanceAfterAGapStartsAnew) {
    run(*filter, test::waving_hand(1, 30), 1 / 30.0);  // the last one at 2.0 s
    const dvec3 there(1, 1, 3);
    for (int i = 1; i <= 12; ++i) {
        const Body out =
            filter->update(body_at(there, JointState::lost), from_seconds(2 + i / 30.0));
        EXPECT_EQ(out[Joint::head].state, JointState::lost);
        EXPECT_EQ(out[Joint::head].confidence, 0);
        EXPECT_GT(glm::distance(dvec3(out[Joint::head].position_m), there), 0.3)
            << "a lost reading leaked in";
    }
    const Body back = filter->update(body_at(there), from_seconds(2.5));
    EXPECT_EQ(dvec3(back[Joint::head].position_m), there);
    EXPECT_EQ(back[Joint::head].state, JointState::tracked);
}

TEST_P(EveryFilter, AShortGapIsBridged) {
    // Against where the filter itself was: "very smooth" is behind the joint on purpose.
    const auto track = sampled([](double t) { return dvec3(1.2 * t, 0, 2); }, 3, 30);
    const double was = run(*filter, track, 1 / 30.0).back().x;
    const auto x_after = [&](int frames, JointState state) {
        const dvec3 at =
            state == JointState::lost ? dvec3(9, 9, 9) : dvec3(1.2 * (3 + frames / 30.0), 0, 2);
        return filter->update(body_at(at, state), from_seconds(4 + frames / 30.0))[Joint::head]
            .position_m.x;
    };
    for (int i = 1; i <= 3; ++i)
        EXPECT_NEAR(x_after(i, JointState::lost), was + 1.2 * i / 30.0, 0.045) << i;
    const double back = x_after(4, JointState::tracked);
    EXPECT_GT(back, was - 0.01) << "started anew, or fell back";
    EXPECT_LT(back, 1.2 * (3 + 4 / 30.0) + 0.05);
}

TEST_P(EveryFilter, NotANumberNeverEnters) {
    test::Random random(7);
    const float bad[] = {kNan, std::numeric_limits<float>::infinity(),
                         -std::numeric_limits<float>::infinity(), 3e38f, -1e30f};
    TimeNs time = 0;
    for (int i = 0; i < 2000; ++i) {
        time += random.chance(0.1) ? random.integer(-2, 1) : random.integer(1, 90'000'000);
        Body body = body_at({random.real(-2, 2), random.real(-2, 2), random.real(0.5, 4)});
        for (JointPosition& joint : body.joints) {
            joint.state = static_cast<JointState>(random.integer(0, 2));
            if (random.chance(0.2))
                joint.position_m[random.integer(0, 2)] = bad[random.integer(0, 4)];
            if (random.chance(0.1)) joint.confidence = kNan;
        }
        const Body out = filter->update(body, time);
        const Body ahead = filter->predict(time + random.integer(-100, 1'000'000'000));
        for (std::size_t j = 0; j < kJointCount; ++j) {
            const glm::vec3 p = out.joints[j].position_m, q = ahead.joints[j].position_m;
            ASSERT_TRUE(std::isfinite(p.x + p.y + p.z) && std::isfinite(q.x + q.y + q.z)) << i;
            ASSERT_TRUE(out.joints[j].confidence >= 0 && out.joints[j].confidence <= 1);
        }
    }
    // Whatever happened, one second of good readings later all is well.
    const dvec3 at(0.3, 0.2, 2);
    for (int i = 1; i <= 30; ++i) filter->update(body_at(at), time + kNsPerSecond + i * 33'000'000);
    EXPECT_LT(glm::distance(dvec3(filter->predict(0)[Joint::head].position_m), at), 1e-3);
}

TEST_P(EveryFilter, PredictionStopsAtItsHorizon) {
    run(*filter, sampled([](double t) { return dvec3(t, 0, 2); }, 1, 30), 1 / 30.0);
    const auto x = [&](double s) {
        return filter->predict(from_seconds(2 + s))[Joint::head].position_m.x;
    };
    EXPECT_LT(x(0.1), x(0.2));
    EXPECT_EQ(x(0.2), x(30));
    EXPECT_EQ(x(0), x(-5)) << "the past is not predicted";
}

INSTANTIATE_TEST_SUITE_P(Filters, EveryFilter, testing::ValuesIn(test::filter_names()),
                         [](const auto& of) {
                             std::string name = of.param;
                             for (char& c : name)
                                 if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
                             return name;
                         });

TEST(Holt, PlainSmoothingFollowsALineWithoutLag) {
    HoltParameters parameters{0.5, 0.5, 0, 0, 1};
    HoltFilter filter(parameters);
    const auto track = sampled([](double t) { return dvec3(0.8 * t, -0.3 * t, 2); }, 3, 30);
    EXPECT_LT(glm::distance(run(filter, track, 1 / 30.0).back(), track.back()), 1e-5);
}

TEST(Holt, StaysWithinTheMaximumDeviation) {
    HoltFilter filter;
    const auto track = test::with_noise(test::waving_hand(8, 30), 0.02, 5);
    const auto out = run(filter, track, 1 / 30.0);
    double most = 0;
    for (std::size_t i = 0; i < out.size(); ++i)
        most = std::max(most, glm::distance(out[i], dvec3(glm::vec3(track[i]))));
    EXPECT_LE(most, 0.04 + 1e-6);
    EXPECT_GT(most, 0.039) << "the clamp was never needed: the motion is too slow for this test";
}

TEST(OneEuro, StaysInTheHullOfTheReadings) {
    for (const char* preset : {"default", "calm", "quick"}) {
        OneEuroFilter filter(*one_euro_preset(preset));
        const auto track = test::with_noise(test::waving_hand(8, 30), 0.02, 6);
        dvec3 low = track[0], high = track[0];
        const auto out = run(filter, track, 1 / 30.0);
        for (std::size_t i = 0; i < out.size(); ++i) {
            low = glm::min(low, track[i]);
            high = glm::max(high, track[i]);
            const dvec3 room(1e-6);
            ASSERT_TRUE(glm::all(glm::greaterThanEqual(out[i], low - room)) &&
                        glm::all(glm::lessThanEqual(out[i], high + room)))
                << i;
        }
    }
}

TEST(OneEuro, AStepIsFollowedAlikeAtEveryFrameRate) {
    OneEuroParameters parameters;
    parameters.beta_hz_per_mps = 0;  // the speed of a step depends on the frame rate; its decay not
    std::vector<double> at_half_second;
    for (const double rate_hz : {15.0, 30.0, 60.0, 240.0}) {
        OneEuroFilter filter(parameters);
        auto track = sampled([](double) { return dvec3(1, 0, 2); }, 0.4, rate_hz);
        track.front() = dvec3(0, 0, 2);
        at_half_second.push_back(run(filter, track, 1 / rate_hz).back().x);
    }
    const double expected = 1 - std::exp(-2 * std::numbers::pi * 1.2 * 0.4);
    for (const double x : at_half_second) EXPECT_NEAR(x, expected, 1e-6);
}

TEST(OneEuro, SteadyLagOnALineIsTheLowPassTimeConstant) {
    OneEuroParameters parameters;
    for (const double rate_hz : {15.0, 30.0, 60.0}) {
        OneEuroFilter filter(parameters);
        const auto track = sampled([](double t) { return dvec3(0.5 * t, 0, 2); }, 6, rate_hz);
        const double cutoff_hz = parameters.min_cutoff_hz + parameters.beta_hz_per_mps * 0.5;
        // Steps of a low-pass that holds each reading: dt / (exp(dt / tau) - 1) behind.
        const double lag_s = 1 / rate_hz / std::expm1(2 * std::numbers::pi * cutoff_hz / rate_hz);
        EXPECT_NEAR((track.back() - run(filter, track, 1 / rate_hz).back()).x, 0.5 * lag_s, 1e-5);
    }
}

TEST(Kalman, FollowsALineWithoutLagAtEveryFrameRate) {
    for (const char* preset : {"default", "calm", "quick"}) {
        for (const double rate_hz : {10.0, 15.0, 30.0, 60.0}) {
            KalmanFilter filter(*kalman_preset(preset));
            const auto track = sampled([](double t) { return dvec3(0.5 * t, -t, 2); }, 6, rate_hz);
            EXPECT_LT(glm::distance(run(filter, track, 1 / rate_hz).back(), track.back()), 1e-4)
                << preset << " " << rate_hz;
        }
    }
}

TEST(Kalman, OnePredictionIsAsGoodAsTwoHalves) {
    KalmanFilter filter;
    run(filter, test::waving_hand(2, 30), 1 / 30.0);
    const double whole = filter.sigma_m(Joint::head, 0.1);
    EXPECT_GT(whole, filter.sigma_m(Joint::head, 0.05));
    // Constant velocity: the mean moves in proportion.
    const TimeNs now = from_seconds(3);
    const auto at = [&](TimeNs t) { return dvec3(filter.predict(t)[Joint::head].position_m); };
    EXPECT_LT(glm::distance(at(now + 100 * kNsPerMs) - at(now + 50 * kNsPerMs),
                            at(now + 50 * kNsPerMs) - at(now)),
              1e-6);
}

TEST(FrameRate, TimeAwareFiltersGiveTheSameArmAt15And30And60) {
    for (const char* name :
         {"one-euro:default", "one-euro:quick", "kalman:default", "kalman:quick"}) {
        std::vector<std::vector<dvec3>> results;
        for (const int rate : {15, 30, 60}) {
            auto filter = std::move(*make_body_filter(name));
            const auto out = run(*filter, test::waving_hand(8, rate), 1.0 / rate);
            std::vector<dvec3> common;
            for (std::size_t i = 0; i < out.size(); i += static_cast<std::size_t>(rate / 15))
                common.push_back(out[i]);
            results.push_back(common);
        }
        double sum15 = 0, sum30 = 0;
        for (std::size_t i = 0; i < results[0].size(); ++i) {
            sum15 += glm::dot(results[0][i] - results[2][i], results[0][i] - results[2][i]);
            sum30 += glm::dot(results[1][i] - results[2][i], results[1][i] - results[2][i]);
        }
        const auto count = static_cast<double>(results[0].size());
        EXPECT_LT(std::sqrt(sum30 / count), 0.012) << name;
        EXPECT_LT(std::sqrt(sum15 / count), 0.036) << name;
    }
}

TEST(FrameRate, UnevenFrameTimesDoNotShakeAStraightMove) {
    KalmanFilter filter;
    test::Random random(11);
    double t = 1, worst = 0;
    for (int i = 0; i < 300; ++i) {
        t += random.real(0.012, 0.09);
        const dvec3 p = glm::dvec3(0.4 * t, 0, 2);
        const dvec3 out(filter.update(body_at(p), from_seconds(t))[Joint::head].position_m);
        if (i > 60) worst = std::max(worst, glm::distance(out, p));
    }
    EXPECT_LT(worst, 1e-4);
}

TEST(Inferred, JointsAreSmoothedMore) {
    for (const char* name : {"holt:default", "one-euro:default", "kalman:default"}) {
        double moved[2];
        for (const bool inferred : {false, true}) {
            auto filter = std::move(*make_body_filter(name));
            for (int i = 0; i < 60; ++i) filter->update(body_at({0, 0, 2}), from_seconds(i / 30.0));
            const Body out = filter->update(
                body_at({0.03, 0, 2}, inferred ? JointState::inferred : JointState::tracked),
                from_seconds(2));
            EXPECT_EQ(out[Joint::head].state,
                      inferred ? JointState::inferred : JointState::tracked);
            moved[inferred ? 1 : 0] = out[Joint::head].position_m.x;
        }
        EXPECT_LT(moved[1], 0.8 * moved[0]) << name;
        EXPECT_GT(moved[1], 0) << name;
    }
}

TEST(FilterBank, KeepsPeopleApartAndForgetsThem) {
    auto bank = FilterBank::create("one-euro");
    ASSERT_TRUE(bank.has_value());
    BodyFrame frame;
    for (int i = 0; i < 30; ++i) {
        frame.time = from_seconds(i / 30.0);
        Body a = body_at({-1, 0, 2}), b = body_at({1, 0, 2});
        b.id = 2;
        frame.bodies = i % 2 ? std::vector{a, b} : std::vector{b, a};
        const BodyFrame out = bank->update(frame);
        ASSERT_EQ(out.bodies.size(), 2u);
        EXPECT_EQ(out.time, frame.time);
        for (const Body& body : out.bodies)
            EXPECT_EQ(body[Joint::head].position_m.x, body.id == 1 ? -1.f : 1.f);
    }
    frame.time += kNsPerSecond * 3;
    frame.bodies = {body_at({2, 0, 2})};
    EXPECT_EQ(bank->update(frame).bodies[0][Joint::head].position_m.x, 2.f);
    EXPECT_EQ(bank->predict(frame.time + 1).bodies[0][Joint::head].position_m.x, 2.f);
}

TEST(FilterNames, UnknownOnesListWhatThereIs) {
    for (const char* name : {"", "holt:", "holt:fast", "euro", "kalman:default:x", "NONE"}) {
        const auto made = make_body_filter(name);
        ASSERT_FALSE(made.has_value()) << name;
        EXPECT_THAT(made.error().hint, testing::HasSubstr("one-euro:default"));
    }
    EXPECT_EQ(*make_body_filter("none"), nullptr);
    EXPECT_NE(*make_body_filter("kalman"), nullptr);
}

}  // namespace
}  // namespace kino
