#include "calibration/projection.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>

#include "tests/calibration/rig_samples.h"
#include "tests/reference/camera_reference.h"

namespace kino {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

glm::dvec2 polar(double r, double angle) {
    return {r * std::cos(angle), r * std::sin(angle)};
}

TEST(Projection, UnprojectUndoesProjectInTheWholeOneToOneDisc) {
    RigSamples samples(1);
    for (int i = 0; i < 200; ++i) {
        const CameraModel camera = samples.camera(640, 480);
        const Projection projection(camera);
        // Far outside any picture accuracy in pixels means nothing.
        const double widest = std::min(projection.max_radius(), 2.0);
        for (int k = 0; k < 100; ++k) {
            const glm::dvec2 ray =
                polar(0.999 * widest * std::sqrt(samples.uniform(0, 1)), samples.uniform(0, 7));
            const auto pixel = projection.project({ray * 2.5, 2.5});
            ASSERT_TRUE(pixel);
            const auto back = projection.unproject(*pixel);
            ASSERT_TRUE(back) << "camera " << i << " radius " << glm::length(ray);
            EXPECT_LT(glm::length(*back - ray) * camera.fx, 0.01);
        }
    }
}

TEST(Projection, AgreesWithTheReferenceBothWays) {
    RigSamples samples(2);
    for (int i = 0; i < 30; ++i) {
        const CameraModel camera = samples.camera(640, 480);
        const Projection projection(camera);
        const double fold = reference::fold_radius(camera);
        EXPECT_LE(projection.max_radius(), fold + 1e-4);
        EXPECT_GE(projection.max_radius(), 0.9 * fold);
        for (int k = 0; k < 50; ++k) {
            const glm::dvec2 pixel(samples.uniform(-0.5, 639.5), samples.uniform(-0.5, 479.5));
            const auto ray = projection.unproject(pixel);
            const auto expected = reference::unproject(camera, fold, pixel);
            if (!ray || !expected) continue;
            EXPECT_LT(glm::length(*ray - *expected) * camera.fx, 1e-4);
            const glm::dvec3 point(samples.uniform(0.3, 8) * glm::dvec3(*ray, 1));
            EXPECT_LT(glm::length(projection.project(point).value() -
                                  reference::project(camera, fold, point).value()),
                      1e-9);
        }
    }
}

TEST(Projection, KnownValuesOfAPlainCamera) {
    const Projection projection(
        {.width = 320, .height = 240, .fx = 285.63, .fy = 285.63, .cx = 159.5, .cy = 119.5});
    const auto ray = projection.unproject({160.5, 119.5});
    EXPECT_NEAR(ray->x, 0.003501, 1e-6);
    EXPECT_EQ(ray->y, 0);
    EXPECT_EQ(projection.project({0, 0, 2}), glm::dvec2(159.5, 119.5));
}

TEST(Projection, TermsMeanWhatOpenCvSaysTheyMean) {
    // Hand-evaluated at x = 0.5, y = 0.25: s = 0.3125.
    const auto distort = [](CameraModel c) {
        c.fx = c.fy = 1;
        return Projection(c).distort({0.5, 0.25}).value();
    };
    const double s = 0.3125;
    EXPECT_NEAR(distort({.k1 = 0.1}).x, 0.5 * (1 + 0.1 * s), 1e-15);
    EXPECT_NEAR(distort({.k2 = 0.1}).x, 0.5 * (1 + 0.1 * s * s), 1e-15);
    EXPECT_NEAR(distort({.k3 = 0.1}).y, 0.25 * (1 + 0.1 * s * s * s), 1e-15);
    EXPECT_NEAR(distort({.k4 = 0.1}).x, 0.5 / (1 + 0.1 * s), 1e-15);
    EXPECT_NEAR(distort({.k5 = 0.1}).x, 0.5 / (1 + 0.1 * s * s), 1e-15);
    EXPECT_NEAR(distort({.k6 = 0.1}).y, 0.25 / (1 + 0.1 * s * s * s), 1e-15);
    EXPECT_NEAR(distort({.p1 = 0.01}).x, 0.5 + 2 * 0.01 * 0.125, 1e-15);
    EXPECT_NEAR(distort({.p1 = 0.01}).y, 0.25 + 0.01 * (s + 2 * 0.0625), 1e-15);
    EXPECT_NEAR(distort({.p2 = 0.01}).x, 0.5 + 0.01 * (s + 2 * 0.25), 1e-15);
    EXPECT_NEAR(distort({.p2 = 0.01}).y, 0.25 + 2 * 0.01 * 0.125, 1e-15);
}

TEST(Projection, WhatCannotBeSeenIsInvalid) {
    RigSamples samples(3);
    for (const CameraModel& camera : {samples.plain_camera(640, 480), samples.camera(640, 480)}) {
        const Projection projection(camera);
        EXPECT_TRUE(projection.project({0.1, 0.1, 1}));
        EXPECT_FALSE(projection.project({0.1, 0.1, 0}));
        EXPECT_FALSE(projection.project({0.1, 0.1, -1}));
        EXPECT_FALSE(projection.project({kNaN, 0.1, 1}));
        EXPECT_FALSE(projection.project({0.1, kNaN, 1}));
        EXPECT_FALSE(projection.project({0.1, 0.1, kNaN}));
        EXPECT_FALSE(projection.project({0.1, 0.1, std::numeric_limits<double>::infinity()}));
        EXPECT_FALSE(projection.project({0.1, 0.1, std::numeric_limits<double>::denorm_min()}));
        EXPECT_FALSE(projection.unproject({kNaN, 3}));
        EXPECT_FALSE(projection.unproject({std::numeric_limits<double>::infinity(), 3}));
    }
}

TEST(Projection, DistortionFoldsBackAtTheBorder) {
    // r (1 - 0.65 r^2) turns round at r = sqrt(1 / 1.95).
    const CameraModel camera = RigSamples::folding_camera(640, 480);
    const Projection projection(camera);
    const double fold = std::sqrt(1 / (3 * 0.65));
    EXPECT_NEAR(projection.max_radius(), fold, 1e-9);
    // Without the limit this point far to the side would land in the middle of the picture.
    const double crossing = 1 / std::sqrt(0.65);
    EXPECT_NEAR(reference::distort(camera, {crossing, 0}).x, 0, 1e-12);
    EXPECT_FALSE(projection.project({crossing, 0, 1}));
    EXPECT_TRUE(projection.project({fold * 0.999, 0, 1}));
    EXPECT_FALSE(projection.project({fold * 1.001, 0, 1}));
    // The corner lies outside everything the lens can reach; the clamped ray is on the rim.
    EXPECT_FALSE(projection.unproject({0, 0}));
    const glm::dvec2 clamped = projection.unproject_clamped({0, 0});
    EXPECT_NEAR(glm::length(clamped), fold, 1e-9);
    EXPECT_LT(clamped.x, 0);
    EXPECT_LT(clamped.y, 0);
    // Whatever is given back lies inside the one-to-one disc, on a grid beyond the picture.
    for (int y = -200; y < 700; y += 7) {
        for (int x = -200; x < 900; x += 7) {
            const auto ray = projection.unproject({x, y});
            if (!ray) continue;
            EXPECT_LE(glm::length(*ray), projection.max_radius() * (1 + 1e-12));
            EXPECT_LT(glm::length(projection.project({*ray * 0.9999999, 0.9999999 + 1e-7}).value() -
                                  glm::dvec2(x, y)),
                      1e-3);
        }
    }
}

TEST(Projection, RationalDenominatorCrossesZero) {
    CameraModel camera = RigSamples::folding_camera(640, 480);
    camera.k1 = 0;
    camera.k4 = -1.5;  // 1 - 1.5 r^2 = 0 at r = 0.816
    const Projection projection(camera);
    EXPECT_NEAR(projection.max_radius(), std::sqrt(1 / 1.5), 1e-6);
    EXPECT_TRUE(projection.project({0.8, 0, 1}));
    EXPECT_FALSE(projection.project({0.82, 0, 1}));
    EXPECT_FALSE(projection.project({2, 0, 1}));
    for (int x = 0; x < 640; x += 3) {
        const auto ray = projection.unproject({x, 100});
        ASSERT_TRUE(ray);
        EXPECT_LT(glm::length(*ray), projection.max_radius());
    }
    // Numerator and denominator cross together: g is back at 1 right behind the pole.
    camera.k1 = -1.49999;
    EXPECT_NEAR(Projection(camera).max_radius(), std::sqrt(1 / 1.5), 1e-2);
}

TEST(Projection, StrongTangentialTermsStayOneToOne) {
    CameraModel camera = RigSamples::folding_camera(640, 480);
    camera.k1 = 0;
    camera.p1 = 0.1;
    camera.p2 = -0.15;
    const Projection projection(camera);
    // 1 - 6 |p| r = 0.
    EXPECT_NEAR(projection.max_radius(), 1 / (6 * std::hypot(0.1, 0.15)), 1e-9);
    RigSamples samples(4);
    for (int i = 0; i < 500; ++i) {
        const glm::dvec2 ray =
            polar(0.995 * projection.max_radius() * samples.uniform(0, 1), samples.uniform(0, 7));
        const auto back = projection.unproject(projection.project({ray, 1}).value());
        ASSERT_TRUE(back) << ray.x << " " << ray.y;
        EXPECT_LT(glm::length(*back - ray) * camera.fx, 0.01);
    }
    // The disc's image is no disc: just outside it there are pixels whose only ray is outside, too.
    int refused = 0;
    for (int y = 0; y < 480; y += 5) {
        for (int x = 0; x < 640; x += 5) {
            const auto ray = projection.unproject({x, y});
            if (ray) {
                EXPECT_LE(glm::length(*ray), projection.max_radius() * (1 + 1e-12));
            } else {
                ++refused;
            }
        }
    }
    EXPECT_GT(refused, 10);
}

TEST(ScaledCamera, TheSamePointFallsOnTheSamePlaceOfThePicture) {
    RigSamples samples(5);
    const CameraModel full = samples.camera(640, 480);
    const CameraModel half = scaled(full, 320, 240);
    EXPECT_NEAR(half.cx, (full.cx - 0.5) / 2, 1e-12);
    const Projection a(full);
    const Projection b(half);
    for (int i = 0; i < 50; ++i) {
        const glm::dvec3 point(samples.uniform(-0.3, 0.3), samples.uniform(-0.3, 0.3), 1);
        const glm::dvec2 p = a.project(point).value();
        const glm::dvec2 q = b.project(point).value();
        EXPECT_LT(glm::length((p + 0.5) / 2.0 - (q + 0.5)), 1e-9);
    }
    const CameraModel back = scaled(half, 640, 480);
    EXPECT_NEAR(back.cx, full.cx, 1e-9);
    EXPECT_NEAR(back.fy, full.fy, 1e-9);
    // The centre of a centred camera stays the centre.
    EXPECT_EQ(
        scaled({.width = 640, .height = 480, .fx = 1, .fy = 1, .cx = 319.5, .cy = 239.5}, 320, 240)
            .cx,
        159.5);
}

TEST(CroppedCamera, PixelsMoveByTheCorner) {
    RigSamples samples(6);
    const CameraModel full = samples.camera(640, 488);
    const CameraModel part = cropped(full, 10, 4, 600, 480);
    const glm::dvec3 point(0.1, -0.2, 1.5);
    const glm::dvec2 moved = Projection(full).project(point).value() - glm::dvec2(10, 4);
    EXPECT_LT(glm::length(Projection(part).project(point).value() - moved), 1e-12);
    EXPECT_EQ(part.width, 600);
}

}  // namespace
}  // namespace kino
