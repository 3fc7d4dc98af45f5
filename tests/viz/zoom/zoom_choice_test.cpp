#include "viz/quality/zoom/zoom_choice.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "viz/quality/zoom/cost_model.h"

namespace kino {
namespace {

constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();

/// A machine: t(z) = rest + pixels / z^2 + copy, in ms.
struct Plant {
    double rest = 5, pixels = 30, copy = 1;
    [[nodiscard]] double pixel_ms(int z) const { return pixels / (z * z); }
    [[nodiscard]] double frame_ms(int z) const { return rest + pixel_ms(z) + (z > 1 ? copy : 0); }
};

TEST(ZoomChoice, ReactiveTakesTheSmallestZoomInTime) {
    for (const double target : {12.0, 16.0, 20.0, 40.0}) {
        for (const double pixels : {1.0, 30.0, 80.0, 120.0}) {
            const Plant plant{.pixels = pixels};
            ReactiveZoom zoom({.target_ms = target, .most = 8});
            for (int i = 0; i < 100; ++i) {
                const int z = zoom.choice().z;
                zoom.frame_took(plant.frame_ms(z), plant.pixel_ms(z));
            }
            const int z = zoom.choice().z;
            EXPECT_LE(plant.frame_ms(z), target + (z == 8 ? 100 : 1e-9));
            if (z > 1) {
                // One less would not be in time, or only just.
                EXPECT_GE(plant.frame_ms(z - 1), 0.85 * target);
            }
        }
    }
}

TEST(ZoomChoice, UnreachableTargetsGetTheLargestZoomAndAFlag) {
    for (const double rest : {33.0, 40.0, 1e6}) {
        ReactiveZoom zoom({.target_ms = 33, .most = 4});
        const ZoomChoice choice = zoom.frame_took(rest + 10, 10);
        EXPECT_EQ(choice.z, 4);
        EXPECT_TRUE(choice.unreachable);
    }
    ReactiveZoom zoom({.target_ms = 33, .most = 4});
    EXPECT_TRUE(zoom.frame_took(33 * 17, 33 * 17).unreachable);
    EXPECT_FALSE(zoom.frame_took(20, 10).unreachable);
    // Nothing is left for pixels, and there are none.
    EXPECT_TRUE(zoom.frame_took(33, 0).unreachable);
}

TEST(ZoomChoice, TimesOfNothingAndNoNumbers) {
    ReactiveZoom zoom({.target_ms = 33});
    EXPECT_EQ(zoom.frame_took(0, 0).z, 1);
    EXPECT_EQ(zoom.frame_took(kNoNumber, 1).z, 1);
    EXPECT_EQ(zoom.frame_took(10, kNoNumber).z, 1);
    EXPECT_EQ(zoom.frame_took(std::numeric_limits<double>::infinity(), 1).z, 1);
    EXPECT_EQ(zoom.frame_took(-3, -1).z, 1);
    EXPECT_EQ(zoom.frame_took(10, 50).z, 1);  // more pixels than frame
}

// A load just above the target at z = 1 is a quarter of that at z = 2: the naive rule swings.
TEST(ZoomChoice, ConstantLoadChangesTheZoomOnce) {
    std::mt19937 random(2);
    std::normal_distribution<double> noise(1, 0.03);
    for (const double load : {1.2, 1.02, 1.5, 3.0}) {
        ReactiveZoom zoom({.target_ms = 33});
        const Plant plant{.rest = 3, .pixels = load * 33 - 3};
        int changes = 0;
        int last_change = -100;
        for (int i = 0; i < 200; ++i) {
            const int z = zoom.choice().z;
            const double factor = noise(random);
            zoom.frame_took(plant.frame_ms(z) * factor, plant.pixel_ms(z) * factor);
            if (zoom.choice().z == z) continue;
            ++changes;
            EXPECT_GE(i - last_change, 8);
            last_change = i;
        }
        EXPECT_LE(changes, 1) << load;
    }
}

TEST(ZoomChoice, GoesUpAtOnceAndDownAfterEightCalmFrames) {
    ReactiveZoom zoom({.target_ms = 33});
    const Plant heavy{.rest = 3, .pixels = 200}, light{.rest = 3, .pixels = 10};
    zoom.frame_took(heavy.frame_ms(1), heavy.pixel_ms(1));
    EXPECT_EQ(zoom.choice().z, 3);
    int frames = 0;
    for (; zoom.choice().z == 3; ++frames) {
        zoom.frame_took(light.frame_ms(3), light.pixel_ms(3));
        ASSERT_LT(frames, 100);
    }
    EXPECT_EQ(frames, 8);
    EXPECT_EQ(zoom.choice().z, 2);
}

TEST(ZoomChoice, HeadSpeedRaisesAtOnceAndForgetsSlowly) {
    HeadSpeedZoom zoom;
    EXPECT_EQ(zoom.step(0.033, {0.1, 0, 0}), 1);
    EXPECT_EQ(zoom.step(0.033, {0.5, 0, 0}), 2);
    EXPECT_EQ(zoom.step(0.033, {0.5, 0, 0}, 60), 3);
    EXPECT_EQ(zoom.step(0.033, {30, 0, 0}), 4);
    HeadSpeedZoom brief;
    brief.step(0, {0.8, 0, 0});
    EXPECT_EQ(brief.step(0.05, {}), 2);  // 2 exp(-1/3) = 1.43
    EXPECT_EQ(brief.step(0.15, {}), 1);
    EXPECT_EQ(brief.step(0.033, {kNoNumber, 0, 0}, kNoNumber), 1);
}

TEST(ZoomChoice, FifoWaitsForTheRetrace) {
    // The card's scene: 50.5 ms at 60 Hz are shown every 66.7 ms, a third later than finished.
    EXPECT_NEAR(frame_interval_ms(50.5, 60, FrameSync::fifo), 66.6667, 1e-3);
    EXPECT_EQ(frame_interval_ms(50.5, 60, FrameSync::free_running), 50.5);
    double gain = 0;
    int count = 0;
    for (double t = 5; t <= 60; t += 0.05, ++count) {
        const double wait = frame_interval_ms(t, 60, FrameSync::fifo) - t;
        EXPECT_GE(wait, -1e-6);
        EXPECT_LT(wait, 1000.0 / 60);
        gain += wait;
    }
    EXPECT_NEAR(gain / count, 500.0 / 60, 1.5);  // half a retrace
    EXPECT_NEAR(frame_interval_ms(100 / 3.0, 60, FrameSync::fifo), 100 / 3.0, 1e-6);
}

/// Work and its true cost.
struct Machine {
    double frame = 2, vertex = 3e-4, triangle = 2e-4, draw = 0.005, copy = 0.9;
    std::vector<double> pixel{3e-5, 2e-4};
    [[nodiscard]] double ms(const ZoomWork& work, int z) const {
        double sum = frame + vertex * work.vertices + triangle * work.triangles +
                     draw * work.draws + (z > 1 ? copy : 0);
        for (std::size_t m = 0; m < pixel.size(); ++m) sum += pixel[m] * work.pixels[m] / (z * z);
        return sum;
    }
};

ZoomWork some_work(std::mt19937& random) {
    std::uniform_real_distribution<double> part(0.2, 1);
    return {.vertices = 20000 * part(random),
            .triangles = 30000 * part(random),
            .draws = 200 * part(random),
            .pixels = {200000 * part(random), 50000 * part(random)}};
}

TEST(ZoomChoice, CostsAreFoundByLeastSquares) {
    const Machine machine;
    std::mt19937 random(4);
    std::normal_distribution<double> noise(0, 0.05);
    PredictiveZoom zoom({}, {.pixel = {1e-4, 1e-4}}, {.forgetting = 0.998});
    for (int i = 0; i < 3000; ++i) {
        const ZoomWork work = some_work(random);
        const int z = 1 + i % 4;
        zoom.learn(work, z, machine.ms(work, z) + noise(random));
    }
    double worst = 0;
    for (int i = 0; i < 200; ++i) {
        const ZoomWork work = some_work(random);
        const int z = 1 + i % 4;
        worst = std::max(worst, std::abs(zoom.predict_ms(work, z) / machine.ms(work, z) - 1));
    }
    EXPECT_LT(worst, 0.03);
    EXPECT_NEAR(zoom.model().costs_ms()[6], 2e-4, 1e-5);
}

// Without excitation, and with features that go together, costs stay finite and not negative, and
// what is seen again and again is predicted.
TEST(ZoomChoice, CollinearWorkBlowsNothingUp) {
    const Machine machine;
    std::mt19937 random(5);
    std::normal_distribution<double> noise(0, 0.3);
    PredictiveZoom zoom({}, {.pixel = {1e-4, 1e-4}});
    const ZoomWork work{.vertices = 15000, .triangles = 15000, .draws = 100, .pixels = {1e5, 1e4}};
    for (int i = 0; i < 20000; ++i) zoom.learn(work, 1, machine.ms(work, 1) + noise(random));
    for (const double cost : zoom.model().costs_ms()) {
        EXPECT_TRUE(std::isfinite(cost));
        EXPECT_GE(cost, 0);
    }
    EXPECT_NEAR(zoom.predict_ms(work, 1), machine.ms(work, 1), 0.5);
    zoom.learn(work, 1, kNoNumber);
    EXPECT_NEAR(zoom.predict_ms(work, 1), machine.ms(work, 1), 0.5);
    // New work is believed within few frames again.
    const ZoomWork other{.vertices = 30000, .triangles = 9000, .draws = 10, .pixels = {3e4, 8e4}};
    for (int i = 0; i < 30; ++i) zoom.learn(other, 1, machine.ms(other, 1) + noise(random));
    EXPECT_NEAR(zoom.predict_ms(other, 1), machine.ms(other, 1), 1.0);
}

TEST(ZoomChoice, CostsAreNeverNegative) {
    const Machine free_vertices{.vertex = 0, .draw = 0};
    std::mt19937 random(7);
    std::normal_distribution<double> noise(0, 2);
    PredictiveZoom zoom({}, {.pixel = {1e-4, 1e-4}});
    for (int i = 0; i < 300; ++i) {
        const ZoomWork work = some_work(random);
        zoom.learn(work, 1 + i % 4, free_vertices.ms(work, 1 + i % 4) + noise(random));
        for (const double cost : zoom.model().costs_ms()) ASSERT_GE(cost, 0);
    }
}

// A heavy object, four times the load, comes into view at frame 100.
TEST(ZoomChoice, PredictionMeetsWhatReactionMisses) {
    const Machine machine;
    std::mt19937 random(6);
    std::normal_distribution<double> noise(1, 0.02);
    const ZoomRules rules{.target_ms = 25, .most = 4};
    const ZoomWork light{.vertices = 8000, .triangles = 9000, .draws = 50, .pixels = {2e5, 3e4}};
    const ZoomWork heavy{.vertices = 9000, .triangles = 10000, .draws = 51, .pixels = {8e5, 1.2e5}};
    PredictiveZoom predictive(rules, {.pixel = {1e-4, 1e-4}});
    for (int i = 0; i < 200; ++i) {  // a calibration run
        const ZoomWork work = some_work(random);
        predictive.learn(work, 1 + i % 4, machine.ms(work, 1 + i % 4));
    }
    ReactiveZoom reactive(rules);
    double predictive_worst = 0, reactive_worst = 0;
    for (int i = 0; i < 200; ++i) {
        const ZoomWork& work = i < 100 ? light : heavy;
        const double factor = noise(random);
        const int zp = predictive.choose(work).z;
        const double tp = machine.ms(work, zp) * factor;
        predictive.frame_took(tp);
        predictive_worst = std::max(predictive_worst, tp / rules.target_ms - 1);
        const int zr = reactive.choice().z;
        const double tr = machine.ms(work, zr) * factor;
        double pixels = 0;
        for (std::size_t m = 0; m < 2; ++m) pixels += machine.pixel[m] * work.pixels[m];
        reactive.frame_took(tr, pixels / (zr * zr) * factor);
        reactive_worst = std::max(reactive_worst, tr / rules.target_ms - 1);
    }
    EXPECT_GT(reactive_worst, 0.5);
    EXPECT_LE(predictive_worst, 0.15);
}

TEST(ZoomChoice, DoesNotZoomWhereItDoesNotPay) {
    std::mt19937 random(8);
    std::normal_distribution<double> noise(1, 0.03);
    struct Case {
        Plant plant;
        int wanted;
    };
    for (const Case& c : {Case{{.rest = 40, .pixels = 2, .copy = 1}, 1},      // polygons
                          Case{{.rest = 2, .pixels = 33, .copy = 60}, 1},     // the copy
                          Case{{.rest = 31, .pixels = 2.5, .copy = 1}, 1},    // hardly late
                          Case{{.rest = 40, .pixels = 30, .copy = 1}, 2},     // some of both
                          Case{{.rest = 10, .pixels = 60, .copy = 1}, 2}}) {  // in time
        ReactiveZoom zoom({.target_ms = 33, .most = 8, .least_saving = 0.1});
        int changes = 0;
        for (int i = 0; i < 200; ++i) {
            const int z = zoom.choice().z;
            const double factor = noise(random);
            zoom.frame_took(c.plant.frame_ms(z) * factor, c.plant.pixel_ms(z) * factor,
                            c.plant.copy);
            changes += zoom.choice().z != z ? 1 : 0;
        }
        EXPECT_EQ(zoom.choice().z, c.wanted) << c.plant.rest << " " << c.plant.copy;
        EXPECT_LE(changes, 1) << c.plant.rest << " " << c.plant.copy;
    }
}

// A load that was pixels becomes polygons: the zoom pays no longer and is let go.
TEST(ZoomChoice, LetsGoOfAZoomThatPaysNoLonger) {
    ReactiveZoom zoom({.target_ms = 33, .least_saving = 0.1});
    const Plant pixels{.rest = 3, .pixels = 100}, polygons{.rest = 60, .pixels = 5};
    zoom.frame_took(pixels.frame_ms(1), pixels.pixel_ms(1), 1);
    EXPECT_EQ(zoom.choice().z, 2);
    for (int i = 0; i < 8; ++i) {
        EXPECT_EQ(zoom.choice().z, 2);
        zoom.frame_took(polygons.frame_ms(2), polygons.pixel_ms(2), 1);
    }
    EXPECT_EQ(zoom.choice().z, 1);
    EXPECT_TRUE(zoom.choice().unreachable);
}

// Passes that were measured on their own tell costs apart that whole frames only know together.
TEST(ZoomChoice, PartsTellCostsApart) {
    const Machine machine;
    const ZoomWork work{.vertices = 9000, .triangles = 9000, .draws = 40, .pixels = {4e5, 5e4}};
    PredictiveZoom zoom({}, {.pixel = {1e-4, 1e-4}});
    for (int i = 0; i < 60; ++i) {
        ZoomWork part{.pixels = {work.pixels[0], 0}};
        zoom.part_took(part, 1, machine.pixel[0] * work.pixels[0]);
        part.pixels = {0, work.pixels[1]};
        zoom.part_took(part, 2, machine.pixel[1] * work.pixels[1] / 4);
        zoom.part_took({.pixels = {0, 0}}, 1, 7);  // nothing was done
    }
    EXPECT_NEAR(zoom.model().costs_ms()[5], machine.pixel[0], 1e-7);
    EXPECT_NEAR(zoom.model().costs_ms()[6], machine.pixel[1], 1e-6);
    EXPECT_EQ(zoom.model().costs_ms()[0], ZoomWorkCosts{}.frame);
}

TEST(ZoomChoice, DoesNotZoomWherePixelsAreNotTheCost) {
    // Polygons: nothing helps, but what helps little is not taken below the target either.
    PredictiveZoom zoom({.target_ms = 33}, {.pixel = {1e-5}});
    const ZoomWork polygons{.vertices = 1e5, .triangles = 1e5, .draws = 10, .pixels = {1e5}};
    for (int i = 0; i < 100; ++i) zoom.learn(polygons, 1 + i % 3, 30 + 0.5 / (1 + i % 3));
    EXPECT_EQ(zoom.choose(polygons).z, 1);
}

}  // namespace
}  // namespace kino
