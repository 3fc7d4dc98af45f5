#include "skeleton/tracking/free_space.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/support/random.h"

namespace kino {
namespace {

TEST(PinholeFit, FindsTheCameraOfItsRays) {
    Image<RayXy> rays(320, 240);
    for (int y = 0; y < 240; ++y) {
        for (int x = 0; x < 320; ++x) {
            rays.at(x, y) = {(static_cast<float>(x) - 158.0f) / 291.0f,
                             (static_cast<float>(y) - 122.0f) / 288.0f};
        }
    }
    rays.at(4, 4).x = std::numeric_limits<float>::quiet_NaN();
    const PinholeFit fit = PinholeFit::of(rays);
    EXPECT_NEAR(fit.fx, 291, 0.01);
    EXPECT_NEAR(fit.fy, 288, 0.01);
    EXPECT_NEAR(fit.cx, 158, 0.01);
    EXPECT_NEAR(fit.cy, 122, 0.01);
}

TEST(FreeSpace, PointsToTheNearestPixelOfThePerson) {
    test::Random random(2);
    const int w = 60, h = 50;
    Image<float> depth(w, h, 3.0f);
    Image<std::uint8_t> labels(w, h, 0);
    for (int i = 0; i < 25; ++i) {
        const int x = static_cast<int>(random.real(20, 40));
        const int y = static_cast<int>(random.real(15, 35));
        labels.at(x, y) = 2;
        depth.at(x, y) = 2;
    }
    FreeSpace space;
    space.set(depth, labels, 2, {20, 15, 40, 35}, 1, 2.0f);
    for (int y = 5; y < h - 5; ++y) {
        for (int x = 10; x < w - 10; ++x) {
            double least = 1e9;
            for (int v = 0; v < h; ++v) {
                for (int u = 0; u < w; ++u) {
                    if (labels.at(u, v) == 2) least = std::min(least, std::hypot(u - x, v - y));
                }
            }
            const SpaceView view = space.at({static_cast<float>(x), static_cast<float>(y)});
            if (least == 0) {
                EXPECT_EQ(view.kind, SpaceView::own);
                EXPECT_EQ(view.depth_m, 2);
            } else {
                ASSERT_EQ(view.kind, SpaceView::free);
                // Two sweeps may miss the nearest by a little, never by a pixel.
                EXPECT_NEAR(std::hypot(view.to_own_px.x, view.to_own_px.y), least, 0.5);
            }
        }
    }
}

TEST(FreeSpace, HolesAndNearerThingsAreNotFree) {
    Image<float> depth(40, 40, 3.0f);
    Image<std::uint8_t> labels(40, 40, 0);
    labels.at(20, 20) = 1;
    depth.at(20, 20) = 2;
    depth.at(10, 10) = 0;
    depth.at(11, 10) = std::numeric_limits<float>::quiet_NaN();
    depth.at(12, 10) = 1.2f;
    FreeSpace space;
    space.set(depth, labels, 1, {5, 5, 30, 30}, 1, 2.0f);
    EXPECT_EQ(space.at({10, 10}).kind, SpaceView::unknown);
    EXPECT_EQ(space.at({11, 10}).kind, SpaceView::unknown);
    EXPECT_EQ(space.at({12, 10}).kind, SpaceView::nearer);
    EXPECT_EQ(space.at({14, 10}).kind, SpaceView::free);
    EXPECT_EQ(space.at({-5, 10}).kind, SpaceView::unknown);
    EXPECT_EQ(space.at({std::numeric_limits<float>::quiet_NaN(), 10}).kind, SpaceView::unknown);
}

}  // namespace
}  // namespace kino
