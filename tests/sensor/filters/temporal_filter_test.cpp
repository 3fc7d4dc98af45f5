#include "sensor/filters/temporal_filter.h"

#include <gtest/gtest.h>

#include <cstring>

#include "tests/sensor/filters/depth_samples.h"

namespace kino {
namespace {

using test::filtered;
using test::make_filter;

/// One pixel through the filter, frame by frame; nine of them, for the vector and what it leaves.
std::vector<float> run(const TemporalParameters& p, const std::vector<float>& readings) {
    const auto filter = make_filter<TemporalFilter>(p);
    std::vector<float> out;
    for (const float z : readings) {
        const Image<float> frame = filtered(*filter, Image<float>(9, 1, z));
        out.push_back(frame.at(8, 0));
        EXPECT_EQ(frame, Image<float>(9, 1, frame.at(0, 0)));
    }
    return out;
}

TEST(Temporal, AMovingEdgeNeverSmears) {
    const auto filter = make_filter<TemporalFilter>(TemporalParameters{});
    for (int frame = 0; frame < 30; ++frame) {
        Image<float> in(64, 8, 3.0f);
        for (int y = 0; y < 8; ++y) {
            std::fill(in.row(y) + frame, in.row(y) + frame + 12, 1.2f);
        }
        EXPECT_EQ(filtered(*filter, in), in) << frame;
    }
}

TEST(Temporal, NeverFartherFromTheNewestReadingThanTheThreshold) {
    test::Random random(3);
    for (const double alpha : {0.0, 0.05, 0.5}) {
        const TemporalParameters p{.alpha = alpha};
        std::vector<float> readings;
        double inverse = 0.5;
        for (int i = 0; i < 2000; ++i) {
            inverse += random.real(-0.006, 0.0065);
            inverse = std::clamp(inverse, 0.1, 2.0);
            readings.push_back(static_cast<float>(1 / inverse));
        }
        const auto out = run(p, readings);
        for (std::size_t i = 0; i < out.size(); ++i) {
            ASSERT_LE(std::abs(1 / out[i] - 1 / readings[i]), p.sigmas * p.noise_per_m + 1e-6);
        }
    }
}

TEST(Temporal, AlphaOneIsNoFiltering) {
    for (const bool running : {false, true}) {
        for (const bool soft : {false, true}) {
            const TemporalParameters p{
                .alpha = 1, .persistence = 0, .running = running, .soft = soft};
            const std::vector<float> readings = {2.0f, 2.001f, 0.0f, 1.999f, 1.5f, 1.502f};
            EXPECT_EQ(run(p, readings), readings);
        }
    }
}

TEST(Temporal, AlphaZeroKeepsTheFirstOrTheMeanOfAll) {
    EXPECT_EQ(run({.alpha = 0, .running = false, .soft = false}, {2.0f, 2.01f, 1.99f, 2.02f}),
              std::vector<float>(4, 2.0f));
    const auto mean = run({.alpha = 0, .soft = false}, {2.0f, 2.01f, 1.99f, 2.02f});
    EXPECT_NEAR(1 / mean[3], (1 / 2.0 + 1 / 2.01 + 1 / 1.99 + 1 / 2.02) / 4, 1e-6);
}

TEST(Temporal, AStepExactlyAtTheThresholdIsAJump) {
    // Powers of two: the difference of the inverses is exactly sigmas * noise.
    const TemporalParameters p{.sigmas = 4, .noise_per_m = 1.0 / 16, .soft = false};
    EXPECT_EQ(run(p, {2.0f, 4.0f})[1], 4.0f);
    EXPECT_NE(run(p, {2.0f, 3.99f})[1], 3.99f);
    EXPECT_EQ(run(p, {2.0f, 4.01f})[1], 4.01f);
}

TEST(Temporal, ALostPixelStaysForPersistenceFramesAndIsThenForgotten) {
    for (const int persistence : {0, 1, 3}) {
        const TemporalParameters p{.persistence = persistence};
        const auto out = run(p, {2.0f, 2.0f, 0, 0, 0, 0, 0, 2.003f});
        for (int i = 2; i < 7; ++i) {
            EXPECT_EQ(out[static_cast<std::size_t>(i)], i - 2 < persistence ? 2.0f : 0.0f) << i;
        }
        EXPECT_EQ(out[7], 2.003f) << "nothing of before is left";
    }
    EXPECT_EQ(run({.persistence = 5}, {0, 0, 0})[2], 0) << "nothing was ever there";
    // Flicker starts the count anew each time.
    EXPECT_EQ(run({.persistence = 1}, {2.0f, 0, 2.0f, 0, 2.0f, 0, 0})[5], 2.0f);
}

TEST(Temporal, ResetAndAnotherSizeForgetEverything) {
    const auto filter = make_filter<TemporalFilter>(TemporalParameters{.persistence = 9});
    const Image<float> near(20, 10, 2.0f);
    const Image<float> moved(20, 10, 2.005f);
    (void)filtered(*filter, near);
    EXPECT_NE(filtered(*filter, moved), moved);
    filter->reset();
    EXPECT_EQ(filtered(*filter, moved), moved) << "after a seek";
    const Image<float> turned(10, 20, 2.001f);
    EXPECT_EQ(filtered(*filter, turned), turned) << "as many pixels, another shape";
    EXPECT_EQ(filtered(*filter, near), near);
    filter->reset();
    EXPECT_EQ(filtered(*filter, Image<float>(20, 10, 0.0f)), Image<float>(20, 10, 0.0f));
}

TEST(Temporal, NoiseOfAStillSceneFalls) {
    test::Random random(4);
    const auto filter = make_filter<TemporalFilter>(TemporalParameters{});
    double before = 0;
    double after = 0;
    for (int frame = 0; frame < 40; ++frame) {
        Image<float> in(100, 20);
        for (float& z : in.pixels()) {
            double inverse = 0.5;
            for (int i = 0; i < 3; ++i) inverse += kKinectNoisePerM * random.real(-1, 1);
            z = static_cast<float>(1 / inverse);
        }
        const Image<float> out = filtered(*filter, in);
        if (frame < 20) continue;
        for (std::size_t i = 0; i < in.size(); ++i) {
            before += std::pow(1 / in.pixels()[i] - 0.5, 2);
            after += std::pow(1 / out.pixels()[i] - 0.5, 2);
        }
    }
    EXPECT_LT(std::sqrt(after / before), 0.34);
}

}  // namespace
}  // namespace kino
