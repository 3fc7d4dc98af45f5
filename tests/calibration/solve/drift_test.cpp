#include "calibration/solve/drift.h"

#include <gmock/gmock.h>

#include <cmath>

#include "calibration/solve/depth_fit.h"
#include "calibration/solve/depth_samples.h"
#include "calibration/solve/mutual_alignment.h"
#include "tests/calibration/solve/synthetic_boards.h"

namespace kino {
namespace {

// A still scene of walls at two distances, seen through a scale that changes with time.
Image<float> still_scene(double scale, test::Random& random) {
    Image<float> depth(128, 96);
    for (int y = 0; y < 96; ++y) {
        for (int x = 0; x < 128; ++x) {
            const double z = x < 64 ? 1.2 : 2.1;
            depth.at(x, y) = static_cast<float>(scale * (z + 0.002 * z * test::normal(random)));
        }
    }
    return depth;
}

TEST(Drift, FollowsASensorThatWarmsUp) {
    test::Random random(3);
    DriftWatch watch;
    for (int i = 0; i <= 300; ++i) {
        const double t = 4.0 * i;
        Image<float> depth = still_scene(1.01 * (1 - 0.008 * std::exp(-t / 300)), random);
        // Somebody walks by, for a while.
        if (i > 100 && i < 130) {
            for (int y = 0; y < 96; ++y) {
                for (int x = 20; x < 50; ++x) depth.at(x, y) = 0.7f;
            }
        }
        watch.add(50 + t, depth, 30 + 10 * (1 - std::exp(-t / 300)));
    }
    const DriftSeries series = watch.series(100);
    ASSERT_EQ(series.points.size(), 100u);
    EXPECT_NEAR(series.points[0].scale, 1, 2e-4);
    EXPECT_NEAR(series.points[0].time_s, 4, 3);
    EXPECT_NEAR(series.points[99].scale, 1 + 0.008 * 0.98, 4e-4);
    ASSERT_TRUE(series.warm_up);
    EXPECT_NEAR(series.warm_up->change, 0.008, 0.0006);
    EXPECT_NEAR(series.warm_up->tau_s, 300, 45);
    ASSERT_TRUE(series.per_kelvin);
    EXPECT_NEAR(*series.per_kelvin, 0.0008, 0.00008);
    for (const DriftPoint& p : series.points) {
        EXPECT_LT(p.sigma, 1e-3);
        EXPECT_GT(p.distance_m, 1.1);
    }
}

TEST(Drift, NoiseIsNoDrift) {
    test::Random random(5);
    DriftWatch watch;
    for (int i = 0; i < 60; ++i) watch.add(i, still_scene(1, random));
    const DriftSeries series = watch.series(30);
    EXPECT_FALSE(series.warm_up);
    EXPECT_FALSE(series.per_kelvin);
    for (const DriftPoint& p : series.points) EXPECT_NEAR(p.scale, 1, 4e-4);
    EXPECT_TRUE(DriftWatch().series().points.empty());
}

Image<RayXy> wall_rays() {
    RigParameters rig = default_kinect1_rig(160, 120);
    rig.color.reset();
    return Rig::create(rig)->depth_rays();
}

// What a plane could not have made is found; what it could stays with the plane.
TEST(WallBias, FindsWhatNoPlaneExplains) {
    const Image<RayXy> rays = wall_rays();
    const auto bias = [&](int x, int y) {
        const double u = (x - 80) / 80.0;
        const double v = (y - 60) / 60.0;
        return 0.02 * (u * u - 1 / 3.0) - 0.01 * (v * v - 1 / 3.0);
    };
    test::Random random(7);
    Image<float> depth(160, 120);
    for (int y = 0; y < 120; ++y) {
        for (int x = 0; x < 160; ++x) {
            // Slanted, so that its place must be found.
            const double inverse = 0.6 + 0.1 * rays.at(x, y).x - 0.05 * rays.at(x, y).y;
            depth.at(x, y) =
                static_cast<float>(1 / (inverse + bias(x, y) + 0.001 * test::normal(random)));
        }
    }
    // A lamp in front of it.
    for (int y = 70; y < 100; ++y) {
        for (int x = 30; x < 50; ++x) depth.at(x, y) = 0.9f;
    }
    const auto samples = samples_on_wall(depth, rays);
    ASSERT_TRUE(samples) << samples.error().to_string();
    EXPECT_GT(samples->size(), 160u * 120 * 9 / 10);
    const auto fit = fit_bias(*samples, 160, 120, 16, 12);
    ASSERT_TRUE(fit);
    double worst = 0;
    for (int y = 8; y < 112; ++y) {
        for (int x = 8; x < 152; ++x) {
            if (x > 15 && x < 65 && y > 55 && y < 115) continue;
            worst = std::max(worst, std::abs(fit->bias.at(x, y) - bias(x, y)));
        }
    }
    EXPECT_LT(worst, 0.0025);
    EXPECT_LT(fit->rms_after_mm, 0.3 * fit->rms_before_mm);
}

TEST(WallBias, NoWallIsNamed) {
    const Image<RayXy> rays = wall_rays();
    Image<float> depth(160, 120, 0);
    EXPECT_FALSE(samples_on_wall(depth, rays));
    test::Random random(9);
    for (float& z : depth.pixels()) z = static_cast<float>(random.real(0.5, 6));
    const auto found = samples_on_wall(depth, rays);
    ASSERT_FALSE(found);
    EXPECT_THAT(found.error().to_string(), testing::HasSubstr("no flat wall"));
}

// Five boxes of different depth and brightness; the colour picture is moved by some pixels.
TEST(MutualAlignment, FindsHowFarColourHasSlid) {
    for (const auto& [dx, dy] : {std::pair(0, 0), std::pair(4, -3), std::pair(-7, 2)}) {
        test::Random random(11);
        Image<float> depth(160, 120);
        Image<ColorUv> uv(160, 120);
        Image<std::uint8_t> grey(160, 120);
        const auto box = [](int x, int y) { return (x / 32 + 2 * (y / 40)) % 5; };
        constexpr int kLevels[] = {60, 200, 110, 160, 30};  // not in the order of depth
        for (int y = 0; y < 120; ++y) {
            for (int x = 0; x < 160; ++x) {
                uv.at(x, y) = {static_cast<std::uint16_t>(x << kUvFractionBits),
                               static_cast<std::uint16_t>(y << kUvFractionBits)};
                depth.at(x, y) = static_cast<float>(1 + 0.3 * box(x, y) + random.real(0, 0.02));
                const int level =
                    kLevels[box(std::clamp(x - dx, 0, 159), std::clamp(y - dy, 0, 119))];
                grey.at(x, y) = static_cast<std::uint8_t>(level + random.integer(-12, 12));
            }
        }
        const auto found = mutual_alignment(depth, uv, grey);
        ASSERT_TRUE(found);
        EXPECT_NEAR(found->dx_px, dx, 0.6);
        EXPECT_NEAR(found->dy_px, dy, 0.6);
        EXPECT_GT(found->best_bits, 1.5);
        EXPECT_GE(found->best_bits, found->bits);
        EXPECT_EQ(found->best_bits > found->bits + 0.05, dx != 0 || dy != 0);
        EXPECT_GT(found->sharpness, 2);
    }
    // Nothing to compare.
    const Image<ColorUv> places(160, 120, ColorUv{0, 0});
    EXPECT_FALSE(
        mutual_alignment(Image<float>(160, 120, 0), places, Image<std::uint8_t>(160, 120)));
    EXPECT_FALSE(
        mutual_alignment(Image<float>(160, 120, 2), places, Image<std::uint8_t>(160, 120, 9)));
}

}  // namespace
}  // namespace kino
