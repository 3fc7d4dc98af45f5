#include "viz/quality/governor/resize_controller.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>
#include <vector>

#include "tests/support/random.h"

namespace kino {
namespace {

constexpr double kTarget = 35;

/// A renderer whose frame takes K / r^2 + C, give or take, and says so `delay` frames late.
class Plant {
  public:
    double k_ms = 100;
    double c_ms = 5;
    double noise = 0;

    explicit Plant(int delay = 0) : delay_(delay) {}

    /// Draws a frame; returns its true time.
    double draw(ResizeController& controller) {
        const double r = controller.begin_frame();
        const double ms = (k_ms / (r * r) + c_ms) * (1 + random_.real(-noise, noise));
        times_.push(ms);
        if (static_cast<int>(times_.size()) > delay_) {
            controller.frame_took(times_.front());
            times_.pop();
        }
        return ms;
    }

  private:
    int delay_;
    std::queue<double> times_;
    test::Random random_{7};
};

/// The bare law: nothing that bends it, and limits of r too wide to be met.
ResizeOptions bare(double k_prime, int delay, double r_start) {
    ResizeOptions options;
    options.target_ms = kTarget;
    options.r_min = 0.1;
    options.r_max = 100;
    options.r_start = r_start;
    options.delay = delay;
    options.initial_cost_ms = k_prime;
    options.learn = false;
    options.dead_band = 0;
    options.max_step = options.emergency_step = 1e9;
    options.quantum = 0;
    options.reject_outliers = false;
    return options;
}

/// Misses of the target, ms, frame by frame, from a start 0.01 ms away from it.
std::vector<double> misses(double ratio, int delay, int frames) {
    Plant plant(delay);
    const double u = (kTarget - plant.c_ms - 0.01) / plant.k_ms;
    ResizeController controller(bare(plant.k_ms / ratio, delay, 1 / std::sqrt(u)));
    std::vector<double> result;
    for (int i = 0; i < frames; ++i) result.push_back(kTarget - plant.draw(controller));
    return result;
}

double largest(const std::vector<double>& values, std::size_t from, std::size_t to) {
    double most = 0;
    for (std::size_t i = from; i < to; ++i) most = std::max(most, std::abs(values[i]));
    return most;
}

class Delay : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(ZeroToThree, Delay, ::testing::Values(0, 1, 2, 3));

TEST_P(Delay, IsStableBelowTheBoundAndNotAboveIt) {
    const double bound = stability_bound(GetParam());
    const auto below = misses(0.97 * bound, GetParam(), 400);
    EXPECT_LT(largest(below, 300, 400), 0.5 * largest(below, 0, 100));
    const auto above = misses(1.03 * bound, GetParam(), 400);
    EXPECT_GT(largest(above, 200, 300), 2 * largest(above, 0, 100));
}

TEST_P(Delay, DoesNotOvershootUpToTheBoundAndDoesBeyondIt) {
    const double bound = no_overshoot_bound(GetParam());
    // Started below the target, an overshoot is a frame above it.
    const auto within = misses(0.999 * bound, GetParam(), 300);
    EXPECT_GE(*std::min_element(within.begin(), within.end()), -1e-9);
    const auto beyond = misses(1.3 * bound, GetParam(), 300);
    EXPECT_LT(*std::min_element(beyond.begin(), beyond.end()), -1e-6);
}

TEST(ResizeBounds, AreThoseOfTheCard) {
    EXPECT_NEAR(stability_bound(0), 2.0, 1e-12);
    EXPECT_NEAR(stability_bound(1), 1.0, 1e-12);
    EXPECT_NEAR(stability_bound(2), 0.618, 5e-4);
    EXPECT_NEAR(stability_bound(3), 0.445, 5e-4);
    EXPECT_NEAR(no_overshoot_bound(0), 1.0, 1e-12);
    EXPECT_NEAR(no_overshoot_bound(1), 0.25, 1e-12);
    EXPECT_NEAR(no_overshoot_bound(2), 0.148, 5e-4);
    EXPECT_NEAR(no_overshoot_bound(3), 0.105, 5e-4);
}

/// Frames after which all of 40 frames stay within 10 % of the target.
int frames_to_settle(ResizeController& controller, Plant& plant) {
    std::vector<double> times;
    for (int i = 0; i < 100; ++i) times.push_back(plant.draw(controller));
    for (int i = 0; i < 60; ++i) {
        const bool held = std::all_of(times.begin() + i, times.begin() + i + 40, [](double ms) {
            return std::abs(ms - kTarget) <= 0.1 * kTarget;
        });
        if (held) return i;
    }
    return 60;
}

TEST(ResizeController, SettlesWithinFifteenFramesFromAnyStepOfTheLoad) {
    test::Random random(11);
    for (int round = 0; round < 300; ++round) {
        Plant plant;
        plant.noise = 0.03;
        plant.c_ms = random.real(1, 12);
        // The target is within reach before and after: r between 1.05 and 7.5.
        const auto reachable = [&] {
            const double r = random.real(1.05, 7.5);
            return (kTarget - plant.c_ms) * r * r;
        };
        plant.k_ms = reachable();
        ResizeOptions options;
        options.target_ms = kTarget;
        ResizeController controller(options);
        for (int i = 0; i < 120; ++i) (void)plant.draw(controller);
        const double before = plant.k_ms;
        plant.k_ms = reachable();
        EXPECT_LE(frames_to_settle(controller, plant), 15)
            << "round " << round << ": K from " << before << " to " << plant.k_ms << ", C "
            << plant.c_ms;
    }
}

TEST(ResizeController, LearnsThePlant) {
    Plant plant;
    plant.noise = 0.01;
    ResizeOptions options;
    options.target_ms = kTarget;
    ResizeController controller(options);
    for (int i = 0; i < 200; ++i) {
        plant.k_ms = 90 + 20 * ((i / 20) % 2);
        (void)plant.draw(controller);
    }
    plant.k_ms = 100;
    for (int i = 0; i < 40; ++i) (void)plant.draw(controller);
    const double r = controller.r();
    EXPECT_NEAR(controller.cost_ms() / (r * r) + controller.rest_ms(), kTarget, 0.1 * kTarget);
}

TEST(ResizeController, OneSlowFrameChangesNothing) {
    Plant plant;
    plant.k_ms = 10;
    plant.c_ms = 5;
    ResizeOptions options;
    options.target_ms = kTarget;
    ResizeController controller(options);
    for (int i = 0; i < 60; ++i) (void)plant.draw(controller);
    ASSERT_EQ(controller.r(), 1);
    (void)controller.begin_frame();
    controller.frame_took(60);  // four times the usual, not yet twice the target
    EXPECT_EQ(controller.r(), 1);
    (void)controller.begin_frame();
    controller.frame_took(5000, true);  // a pipeline was made
    EXPECT_EQ(controller.r(), 1);
    (void)controller.begin_frame();
    controller.frame_took(5000);  // an emergency
    EXPECT_GT(controller.r(), 1.5);
}

TEST(CostModel, FindsTheLineAndForgetsTheOneBefore) {
    CostModel model(1, 0);
    for (int i = 0; i < 40; ++i) model.add(0.1 * (i % 7), 80 * 0.1 * (i % 7) + 6);
    EXPECT_NEAR(model.slope(), 80, 1e-6);
    EXPECT_NEAR(model.offset(), 6, 1e-6);
    for (int i = 0; i < 200; ++i) model.add(0.1 * (i % 7), 20 * 0.1 * (i % 7) + 3);
    EXPECT_NEAR(model.slope(), 20, 0.05);
    EXPECT_NEAR(model.offset(), 3, 0.05);
    model.add(std::numeric_limits<double>::quiet_NaN(), 1);
    model.add(1, std::numeric_limits<double>::infinity());
    EXPECT_NEAR(model.slope(), 20, 0.05);
}

TEST(CostModel, KeepsItsSlopeWhereNothingMoves) {
    CostModel model(50, 0);
    for (int i = 0; i < 50; ++i) model.add(0.5, 30);
    EXPECT_EQ(model.slope(), 50);
    EXPECT_NEAR(model.offset(), 5, 1e-9);
}

TEST(ResizeController, StaysInItsLimitsWhateverItIsTold) {
    ResizeOptions options;
    ResizeController controller(options);
    const double hostile[] = {0,
                              1e9,
                              -1,
                              std::numeric_limits<double>::quiet_NaN(),
                              1e-9,
                              1e300,
                              std::numeric_limits<double>::infinity()};
    test::Random random(3);
    for (int i = 0; i < 2000; ++i) {
        const double r = controller.begin_frame();
        ASSERT_GE(r, options.r_min);
        ASSERT_LE(r, options.r_max);
        ASSERT_NEAR(r / options.quantum, std::round(r / options.quantum), 1e-9);
        controller.frame_took(hostile[random.integer(0, 6)], random.chance(0.1));
    }
}

TEST(ResizeController, DrawsInFullWhereThereIsTime) {
    Plant plant;
    plant.k_ms = 10;
    ResizeOptions options;
    options.target_ms = kTarget;
    options.r_start = 4;
    ResizeController controller(options);
    for (int i = 0; i < 40; ++i) (void)plant.draw(controller);
    EXPECT_EQ(controller.r(), 1);
}

}  // namespace
}  // namespace kino
