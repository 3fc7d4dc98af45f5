#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "sensor/filters/decimation_filter.h"
#include "sensor/filters/flying_pixel_filter.h"
#include "sensor/filters/hole_filter.h"
#include "sensor/filters/spatial_filter.h"
#include "sensor/filters/temporal_filter.h"
#include "tests/sensor/filters/depth_samples.h"

namespace kino {
namespace {

using test::filtered;
using test::make_filter;

constexpr float kRounding = 1e-6f;  // relative

std::vector<std::unique_ptr<DepthFilter>> all_filters(bool simd = true) {
    std::vector<std::unique_ptr<DepthFilter>> all;
    all.push_back(make_filter<FlyingPixelFilter>(FlyingPixelParameters{}, simd));
    all.push_back(make_filter<SpatialFilter>(SpatialParameters{}, simd));
    all.push_back(make_filter<TemporalFilter>(TemporalParameters{}, simd));
    all.push_back(make_filter<HoleFilter>(HoleParameters{}, simd));
    all.push_back(make_filter<DecimationFilter>(DecimationParameters{}, simd));
    return all;
}

Image<float> step_edge(float left, float right, int at = 20) {
    Image<float> in(40, 20, left);
    for (int y = 0; y < 20; ++y) std::fill(in.row(y) + at, in.row(y) + 40, right);
    return in;
}

TEST(FilterLaws, ConstantDepthStaysBitForBit) {
    for (const float z :
         {kNearestReadingM, 0.3f, 0.777f, 1.0f, 3.1415927f, 9.99f, 300.0f, kFarthestReadingM}) {
        for (const auto& filter : all_filters()) {
            const Image<float> in(50, 30, z);
            for (int frame = 0; frame < 5; ++frame) {
                const Image<float> out = filtered(*filter, in);
                const int reduction = filter->reduction();
                EXPECT_EQ(out, Image<float>(50 / reduction, 30 / reduction, z))
                    << filter->name() << " " << z;
            }
        }
    }
}

TEST(FilterLaws, WhatIsNoReadingBecomesZero) {
    for (const auto& filter : all_filters()) {
        for (int frame = 0; frame < 3; ++frame) {
            const Image<float> out = filtered(*filter, test::hostile_room(90, 50, 7));
            for (const float z : out.pixels()) {
                ASSERT_TRUE(z == 0 || is_reading(z)) << filter->name() << " " << z;
                ASSERT_FALSE(std::signbit(z)) << filter->name();
            }
        }
        constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
        filter->reset();
        EXPECT_EQ(filtered(*filter, Image<float>(16, 8, kNaN)),
                  Image<float>(16 / filter->reduction(), 8 / filter->reduction(), 0.0f))
            << filter->name();
    }
}

TEST(FilterLaws, OutputLiesWithinTheInputs) {
    for (const auto& filter : all_filters()) {
        const Image<float> in = test::noisy_room(120, 90, 3, 0.004);
        float low = 1e9f;
        float high = 0;
        for (const float z : in.pixels()) {
            if (z > 0) low = std::min(low, z);
            high = std::max(high, z);
        }
        for (int frame = 0; frame < 2; ++frame) {
            const Image<float> out = filtered(*filter, in);
            for (const float z : out.pixels()) {
                if (z == 0) continue;
                ASSERT_GE(z, low * (1 - kRounding)) << filter->name();
                ASSERT_LE(z, high * (1 + kRounding)) << filter->name();
            }
        }
    }
}

TEST(FilterLaws, SpatialStaysWithinItsWindow) {
    const Image<float> in = test::noisy_room(120, 90, 4, 0.004);
    const Image<float> out = filtered(*make_filter<SpatialFilter>(SpatialParameters{}), in);
    for (int y = 2; y < 88; ++y) {
        for (int x = 2; x < 118; ++x) {
            ASSERT_EQ(out.at(x, y) > 0, in.at(x, y) > 0);
            float low = in.at(x, y);
            float high = low;
            for (int v = y - 2; v <= y + 2; ++v) {
                for (int u = x - 2; u <= x + 2; ++u) {
                    if (in.at(u, v) > 0) low = std::min(low, in.at(u, v));
                    high = std::max(high, in.at(u, v));
                }
            }
            ASSERT_GE(out.at(x, y), low * (1 - kRounding));
            ASSERT_LE(out.at(x, y), high * (1 + kRounding));
        }
    }
}

TEST(FilterLaws, AStepBeyondTheThresholdIsUntouchedAndOneBelowIsNot) {
    const SpatialParameters p;
    const double threshold = p.sigmas * p.noise_per_m;
    const auto step = [&](double share) {
        return step_edge(2.0f, static_cast<float>(1 / (0.5 - share * threshold)));
    };
    const auto filter = make_filter<SpatialFilter>(p);
    for (const double share : {1.001, 1.5, 30.0}) {
        EXPECT_EQ(filtered(*filter, step(share)), step(share)) << share;
    }
    // Exactly at the threshold rounding decides, and the weight is next to nothing either way.
    const Image<float> at = filtered(*filter, step(1));
    for (int x = 0; x < 40; ++x) EXPECT_NEAR(at.at(x, 10), step(1).at(x, 10), 1e-6);
    EXPECT_GT(filtered(*filter, step(0.5)).at(19, 10), 2.001f);
}

TEST(FilterLaws, PlanesStayPlanesAndNoiseFalls) {
    Image<float> plane(80, 60);
    for (int y = 0; y < 60; ++y) {
        for (int x = 0; x < 80; ++x) {
            plane.at(x, y) = static_cast<float>(1 / (0.3 + 0.001 * x - 0.0007 * y));
        }
    }
    const auto filter = make_filter<SpatialFilter>(SpatialParameters{});
    const Image<float> out = filtered(*filter, plane);
    for (int y = 2; y < 58; ++y) {
        for (int x = 2; x < 78; ++x) ASSERT_NEAR(out.at(x, y) / plane.at(x, y), 1, 2e-6);
    }
    test::Random random(5);
    Image<float> noisy = plane;
    for (float& z : noisy.pixels()) {
        double inverse = 1 / double{z};
        for (int i = 0; i < 3; ++i) inverse += 0.0017 * random.real(-1, 1);
        z = static_cast<float>(1 / inverse);
    }
    const Image<float> smooth = filtered(*filter, noisy);
    double before = 0;
    double after = 0;
    for (std::size_t i = 0; i < plane.size(); ++i) {
        before += std::pow(noisy.pixels()[i] - plane.pixels()[i], 2);
        after += std::pow(smooth.pixels()[i] - plane.pixels()[i], 2);
    }
    EXPECT_LT(std::sqrt(after / before), 0.45);
}

TEST(FilterLaws, FlyingPixelsGoAndTheRestIsUnchanged) {
    Image<float> in = step_edge(1.0f, 2.0f);
    const Image<float> clean = in;
    const auto filter = make_filter<FlyingPixelFilter>(FlyingPixelParameters{});
    EXPECT_EQ(filtered(*filter, clean), clean);
    // A whole seam of them, as time-of-flight sensors draw it, and single ones.
    for (int y = 0; y < 20; ++y) in.at(20, y) = 1.4f;
    in.at(5, 5) = 1.3f;
    const Image<float> out = filtered(*filter, in);
    for (int y = 0; y < 20; ++y) EXPECT_EQ(out.at(20, y), 0) << y;
    EXPECT_EQ(out.at(5, 5), 0);
    EXPECT_EQ(out.at(6, 5), 1.0f);
    EXPECT_EQ(out.at(22, 3), 2.0f);
    EXPECT_EQ(filtered(*filter, out), out) << "idempotent here";
}

TEST(FilterLaws, AnObjectOnePixelWideStays) {
    Image<float> in(40, 20, 3.0f);
    for (int y = 0; y < 20; ++y) in.at(11, y) = 1.0f;
    EXPECT_EQ(filtered(*make_filter<FlyingPixelFilter>(FlyingPixelParameters{.support = 1}), in),
              in);
    EXPECT_EQ(filtered(*make_filter<SpatialFilter>(SpatialParameters{}), in), in);
    EXPECT_EQ(filtered(*make_filter<HoleFilter>(HoleParameters{}), in), in);
    const Image<float> half =
        filtered(*make_filter<DecimationFilter>(DecimationParameters{.factor = 2}), in);
    for (int y = 0; y < 10; ++y) EXPECT_EQ(half.at(5, y), 1.0f);
    const Image<float> kept =
        filtered(*make_filter<FlyingPixelFilter>(FlyingPixelParameters{}), in);
    for (int y = 1; y < 19; ++y) EXPECT_EQ(kept.at(11, y), 1.0f) << y;
}

TEST(FilterLaws, HolesOnAPlaneAreFilledExactlyAndReadingsStay) {
    Image<float> plane(60, 40);
    for (int y = 0; y < 40; ++y) {
        for (int x = 0; x < 60; ++x) {
            plane.at(x, y) = static_cast<float>(1 / (0.4 + 0.0005 * x + 0.0003 * y));
        }
    }
    Image<float> in = plane;
    test::Random random(6);
    for (int i = 0; i < 60; ++i) in.at(random.integer(1, 58), random.integer(20, 38)) = 0;
    for (int y = 5; y < 13; ++y) std::fill(in.row(y) + 20, in.row(y) + 29, 0.0f);
    const auto filter = make_filter<HoleFilter>(HoleParameters{.gap = 8});
    const Image<float> out = filtered(*filter, in);
    for (int y = 0; y < 40; ++y) {
        for (int x = 0; x < 60; ++x) {
            ASSERT_NEAR(out.at(x, y) / plane.at(x, y), 1, 2e-6) << x << "," << y;
            ASSERT_TRUE(in.at(x, y) == 0 || out.at(x, y) == in.at(x, y));
        }
    }
    EXPECT_EQ(filtered(*filter, out), out) << "idempotent once nothing is open";
}

TEST(FilterLaws, AShadowGetsTheBackgroundOrNothing) {
    Image<float> in = step_edge(1.0f, 3.0f);
    for (int y = 0; y < 20; ++y) std::fill(in.row(y) + 20, in.row(y) + 26, 0.0f);
    EXPECT_EQ(filtered(*make_filter<HoleFilter>(HoleParameters{.gap = 6}), in),
              step_edge(1.0f, 3.0f));
    EXPECT_EQ(filtered(*make_filter<HoleFilter>(HoleParameters{.background = false}), in), in);
    EXPECT_EQ(filtered(*make_filter<HoleFilter>(HoleParameters{.gap = 5}), in), in) << "too wide";
}

TEST(FilterLaws, BothSidesShareWhatIsLostAtAnEdge) {
    const auto filter = make_filter<HoleFilter>(HoleParameters{.edge = 4});
    for (const int lost : {1, 2, 3, 4}) {
        Image<float> in = step_edge(1.0f, 3.0f, 20 + lost);
        for (int y = 0; y < 20; ++y) std::fill(in.row(y) + 20, in.row(y) + 20 + lost, 0.0f);
        EXPECT_EQ(filtered(*filter, in), step_edge(1.0f, 3.0f, 20 + lost / 2)) << lost;
    }
}

TEST(FilterLaws, NothingOfAnEarlierFramesHolesIsLeft) {
    const auto filter = make_filter<HoleFilter>(HoleParameters{.gap = 8});
    Image<float> narrow(20, 40, 2.0f);
    narrow.at(10, 10) = 0;
    EXPECT_EQ(filtered(*filter, narrow), Image<float>(20, 40, 2.0f));
    Image<float> tall(20, 40, 2.0f);
    for (int y = 5; y < 21; ++y) std::fill(tall.row(y) + 8, tall.row(y) + 13, 0.0f);
    EXPECT_EQ(filtered(*filter, tall), Image<float>(20, 40, 2.0f));
}

TEST(FilterLaws, HolesAtTheBorderStay) {
    Image<float> in(20, 20, 2.0f);
    for (int y = 0; y < 20; ++y) {
        for (int x = 0; x < 20; ++x) {
            if (x < 2 || y > 17) in.at(x, y) = 0;
        }
    }
    EXPECT_EQ(filtered(*make_filter<HoleFilter>(HoleParameters{}), in), in);
}

TEST(FilterLaws, DecimationNeverAnswersBetweenSurfaces) {
    for (const int factor : {2, 3, 4, 5, 8}) {
        const auto filter = make_filter<DecimationFilter>(DecimationParameters{.factor = factor});
        for (int at = 10; at < 18; ++at) {
            const Image<float> out = filtered(*filter, step_edge(1.0f, 2.0f, at));
            for (const float z : out.pixels()) EXPECT_TRUE(z == 1.0f || z == 2.0f) << z;
        }
    }
}

TEST(FilterLaws, DecimatedCameraSeesTheSamePoints) {
    const CameraModel camera{
        .width = 641, .height = 480, .fx = 571, .fy = 570, .cx = 321, .cy = 239, .k1 = 0.1};
    for (const int factor : {1, 2, 3, 8}) {
        const CameraModel small = decimated(camera, factor);
        EXPECT_EQ(small.width, (641 + factor - 1) / factor);
        // The ray through a block's middle.
        for (const int block : {0, 7, 50}) {
            const double middle = block * factor + (factor - 1) / 2.0;
            EXPECT_NEAR((block - small.cx) / small.fx, (middle - camera.cx) / camera.fx, 1e-12);
            EXPECT_NEAR((block - small.cy) / small.fy, (middle - camera.cy) / camera.fy, 1e-12);
        }
    }
}

TEST(FilterLaws, SameInputSameOutput) {
    for (const auto& filter : all_filters()) {
        const auto in = test::hostile_room(130, 70, 9);
        const auto once = filtered(*filter, in);
        filter->reset();
        (void)filtered(*filter, test::noisy_room(30, 20, 1));
        filter->reset();
        EXPECT_TRUE(test::same_bits(once, filtered(*filter, in))) << filter->name();
    }
}

}  // namespace
}  // namespace kino
