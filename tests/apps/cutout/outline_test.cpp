#include "apps/stage/outline.h"

#include <gtest/gtest.h>

#include <cmath>
#include <tuple>

#include "tests/support/random.h"

namespace kino {
namespace {

DepthSurface surface_of(Image<float> depth_m) {
    DepthSurface surface;
    surface.color.resize(depth_m.width(), depth_m.height());
    for (Rgba8& c : surface.color.pixels()) c = {10, 20, 30, 255};
    surface.depth_m = std::move(depth_m);
    return surface;
}

/// Whether a pixel of the majority filter's result has a reading, by the definition.
bool majority_at(const Image<float>& depth_m, int x, int y, int radius) {
    int there = 0;
    for (int v = y - radius; v <= y + radius; ++v) {
        for (int u = x - radius; u <= x + radius; ++u) {
            if (u < 0 || v < 0 || u >= depth_m.width() || v >= depth_m.height()) continue;
            there += depth_m.at(u, v) > 0;
        }
    }
    return 2 * there >= (2 * radius + 1) * (2 * radius + 1);
}

TEST(OutlineTest, IsTheMajorityOfTheSquareForRandomPictures) {
    test::Random random(5);
    for (const auto& [width, height] : {std::pair{1, 1}, {3, 40}, {31, 17}, {64, 48}}) {
        for (const int radius : {1, 2, 5}) {
            Image<float> depth_m(width, height);
            for (float& z : depth_m.pixels()) {
                z = random.chance(0.5) ? static_cast<float>(random.real(0.5, 4)) : 0.0f;
            }
            DepthSurface smooth = surface_of(depth_m);
            smooth_outline(smooth, radius);
            for (int y = 0; y < height; ++y) {
                for (int x = 0; x < width; ++x) {
                    const float z = smooth.depth_m.at(x, y);
                    ASSERT_EQ(z > 0, majority_at(depth_m, x, y, radius)) << x << ", " << y;
                    ASSERT_TRUE(z == 0 || (z >= 0.5f && z < 4)) << z;
                    if (depth_m.at(x, y) > 0 && z > 0) {
                        ASSERT_EQ(z, depth_m.at(x, y));
                    }
                }
            }
        }
    }
}

TEST(OutlineTest, RadiusZeroAndWhatHasNoOutlineStayTheBitsTheyAre) {
    test::Random random(6);
    Image<float> depth_m(40, 30);
    for (float& z : depth_m.pixels()) z = static_cast<float>(random.real(1, 3));
    DepthSurface full = surface_of(depth_m);
    smooth_outline(full, 0);
    EXPECT_TRUE(std::equal(full.depth_m.pixels().begin(), full.depth_m.pixels().end(),
                           depth_m.pixels().begin()));
    for (float& z : depth_m.pixels()) z = 0;
    DepthSurface empty = surface_of(depth_m);
    smooth_outline(empty, 3);
    for (const float z : empty.depth_m.pixels()) EXPECT_EQ(z, 0.0f);
}

/// A disc whose edge is off by as much as a sensor's: mean distance of its outline from the truth.
double outline_error_px(const Image<float>& depth_m, double middle, double radius) {
    double sum = 0;
    int count = 0;
    for (int y = 0; y < depth_m.height(); ++y) {
        for (int x = 0; x < depth_m.width(); ++x) {
            const double off = std::hypot(x - middle, y - middle) - radius;
            const bool wrong = (off < 0) != (depth_m.at(x, y) > 0);
            sum += wrong ? std::abs(off) : 0;
            count += std::abs(off) < 0.5;
        }
    }
    return sum / count;
}

TEST(OutlineTest, RaggedEdgesComeCloserToTheTruth) {
    test::Random random(7);
    constexpr double kMiddle = 50.2, kRadius = 38;
    double before = 0, after = 0;
    for (int round = 0; round < 8; ++round) {
        Image<float> depth_m(100, 100);
        for (int y = 0; y < 100; ++y) {
            // As a structured-light sensor's: rows differ, neighbours in a row do not.
            const double left = random.real(-2.5, 2.5), right = random.real(-2.5, 2.5);
            for (int x = 0; x < 100; ++x) {
                const double ragged = kRadius + (x < kMiddle ? left : right);
                depth_m.at(x, y) = std::hypot(x - kMiddle, y - kMiddle) < ragged ? 2.0f : 0.0f;
            }
        }
        DepthSurface smooth = surface_of(depth_m);
        smooth_outline(smooth, 2);
        before += outline_error_px(depth_m, kMiddle, kRadius);
        after += outline_error_px(smooth.depth_m, kMiddle, kRadius);
    }
    EXPECT_LT(after, 0.6 * before);
}

TEST(OutlineTest, KeepsLimbsAndFillsGapsWithWhatIsBehindThem) {
    Image<float> depth_m(60, 40);
    for (int y = 0; y < 40; ++y) {
        // A forearm of 3 px, and a trunk with a shadow of 2 px beside an arm before it.
        for (int x = 4; x < 7; ++x) depth_m.at(x, y) = 1.5f;
        for (int x = 20; x < 50; ++x) depth_m.at(x, y) = x < 30 ? 1.6f : 2.0f;
        depth_m.at(30, y) = depth_m.at(31, y) = 0;
    }
    DepthSurface smooth = surface_of(depth_m);
    for (int y = 0; y < 40; ++y) {
        for (int x = 32; x < 50; ++x) smooth.color.at(x, y) = {200, 100, 50, 255};
        smooth.color.at(30, y) = smooth.color.at(31, y) = {0, 0, 0, 0};
    }
    smooth_outline(smooth, 2);
    for (int y = 5; y < 35; ++y) {
        for (int x = 4; x < 7; ++x) EXPECT_EQ(smooth.depth_m.at(x, y), 1.5f);
        for (int x = 30; x < 32; ++x) {
            EXPECT_NEAR(smooth.depth_m.at(x, y), 2.0f, 1e-6) << x;
            EXPECT_EQ(smooth.color.at(x, y), (Rgba8{200, 100, 50, 255}));
        }
        EXPECT_EQ(smooth.depth_m.at(29, y), 1.6f);
    }
}

}  // namespace
}  // namespace kino
