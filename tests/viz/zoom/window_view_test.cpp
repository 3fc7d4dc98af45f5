#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <random>

#include "viz/scene/view.h"

namespace kino {
namespace {

constexpr int kViewW = 1280;
constexpr int kViewH = 720;

/// Normalised device coordinates of a world point, y down.
glm::dvec2 device_of(const View& view, const glm::dvec3& world) {
    const glm::dvec3 p = inverse(view.world_from_view) * world;
    const glm::dvec4 clip = clip_from_view(view) * glm::dvec4(p, 1);
    return {clip.x / clip.w, clip.y / clip.w};
}

WindowScreen somewhere(std::mt19937& random) {
    std::uniform_real_distribution<double> any(-1, 1);
    return {.size_m = {0.5 + 0.3 * any(random), 0.4 + 0.2 * any(random)},
            .world_from_window = {
                glm::normalize(glm::dquat(any(random), any(random), any(random), any(random))),
                {10 * any(random), 10 * any(random), 10 * any(random)}}};
}

TEST(WindowView, CornersFallOnThePicturesCornersForAThousandEyes) {
    std::mt19937 random(34);
    std::uniform_real_distribution<double> aside(-0.8, 0.8), away(kNearestEyeM, 4);
    double worst = 0;
    for (int i = 0; i < 1000; ++i) {
        const WindowScreen screen = somewhere(random);
        const View view =
            window_view(screen, {aside(random), aside(random), away(random)}, kViewW, kViewH);
        for (const double x : {-0.5, 0.5}) {
            for (const double y : {-0.5, 0.5}) {
                const glm::dvec3 corner = screen.world_from_window *
                                          glm::dvec3(x * screen.size_m.x, y * screen.size_m.y, 0);
                const glm::dvec2 at = device_of(view, corner);
                worst = std::max({worst, std::abs(at.x - 2 * x), std::abs(at.y + 2 * y)});
            }
        }
    }
    EXPECT_LT(worst, 1e-6);
}

// The card's numbers: a screen of 0.52 x 0.32 m, the eye at (0.2, 0.05, 0.6), n = 0.1.
TEST(WindowView, GivesTheFrustumOfTheCheckValues) {
    const double n = 0.1;
    const View view = window_view({.size_m = {0.52, 0.32}}, {0.2, 0.05, 0.6}, kViewW, kViewH, n);
    const Projection& k = view.projection;
    EXPECT_NEAR(n * (-0.5 - k.cx) / k.fx, -0.076667, 1e-6);           // l
    EXPECT_NEAR(n * (kViewW - 0.5 - k.cx) / k.fx, 0.010000, 1e-6);    // r
    EXPECT_NEAR(-n * (kViewH - 0.5 - k.cy) / k.fy, -0.035000, 1e-6);  // b
    EXPECT_NEAR(-n * (-0.5 - k.cy) / k.fy, 0.018333, 1e-6);           // t
    const glm::dvec3 eye{0.2, 0.05, 0.6};
    EXPECT_LT(glm::distance(view.world_from_view.translation, eye), 1e-12);
}

TEST(WindowView, APointOnTheScreenStaysWhereItIs) {
    std::mt19937 random(35);
    const WindowScreen screen = somewhere(random);
    const glm::dvec3 point =
        screen.world_from_window * glm::dvec3(0.3 * screen.size_m.x, -0.2 * screen.size_m.y, 0);
    std::uniform_real_distribution<double> aside(-0.6, 0.6), away(0.2, 2);
    const auto first = project_to_pixel(window_view(screen, {0, 0, 0.6}, kViewW, kViewH), point);
    ASSERT_TRUE(first);
    for (int i = 0; i < 200; ++i) {
        const auto at = project_to_pixel(
            window_view(screen, {aside(random), aside(random), away(random)}, kViewW, kViewH),
            point);
        ASSERT_TRUE(at);
        EXPECT_LT(glm::distance(*at, *first), 1e-6);
    }
}

TEST(WindowView, AnEyeInOrBehindTheScreenIsMovedOut) {
    for (const double z : {0.1, 0.0, -2.0}) {
        const View view = window_view({}, {0.1, 0.1, z}, kViewW, kViewH);
        EXPECT_EQ(view.world_from_view.translation, glm::dvec3(0.1, 0.1, kNearestEyeM));
        EXPECT_GT(view.projection.fx, 0);
    }
}

TEST(WindowView, IsMadeFromItsCornersOrSaysWhichIsWrong) {
    std::mt19937 random(36);
    for (int i = 0; i < 100; ++i) {
        const WindowScreen screen = somewhere(random);
        const auto corner = [&](double x, double y) {
            return screen.world_from_window *
                   glm::dvec3(x * screen.size_m.x, y * screen.size_m.y, 0);
        };
        const glm::dvec3 viewer = screen.world_from_window * glm::dvec3(0.1, 0, 0.7);
        const glm::dvec3 a = corner(-0.5, -0.5), b = corner(0.5, -0.5), c = corner(-0.5, 0.5);
        const auto made = window_from_corners({a, b, c}, viewer);
        ASSERT_TRUE(made) << made.error().to_string();
        EXPECT_LT(glm::distance(made->size_m, screen.size_m), 1e-9);
        EXPECT_LT(glm::distance(made->world_from_window * glm::dvec3(0.1, 0.2, 0.3),
                                screen.world_from_window * glm::dvec3(0.1, 0.2, 0.3)),
                  1e-9);
        const auto what = [&](const glm::dvec3& p, const glm::dvec3& q, const glm::dvec3& r) {
            const auto wrong = window_from_corners({p, q, r}, viewer);
            return wrong ? std::string() : wrong.error().to_string();
        };
        EXPECT_NE(what(b, a, corner(0.5, 0.5)).find("behind"), std::string::npos);
        EXPECT_NE(what(a, a, c).find("lower right"), std::string::npos);
        EXPECT_NE(what(a, b, b).find("upper left"), std::string::npos);
        EXPECT_NE(what(a, b, a + 1e-4 * (c - a)).find("upper left"), std::string::npos);
    }
}

}  // namespace
}  // namespace kino
