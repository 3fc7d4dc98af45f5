#include "viz/quality/lod_plan.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/random.h"
#include "viz/quality/lod_learning.h"

namespace kino {
namespace {

using test::Random;

std::vector<LodComponent> random_table(Random& random, int count) {
    std::vector<LodComponent> table;
    for (int i = 0; i < count; ++i) {
        table.push_back({.name = "c",
                         .cost_ns = std::pow(10, random.real(0.5, 2.7)),
                         .error = std::pow(10, random.real(-5, -2)),
                         .exponent = random.real(0.5, 3)});
    }
    return table;
}

double total(const std::vector<LodComponent>& table) {
    double sum = 0;
    for (const LodComponent& c : table) sum += c.cost_ns;
    return sum;
}

/// Every combination of levels.
LodPlan exhaustive(const std::vector<LodComponent>& table, std::span<const double> levels,
                   double budget, double reconstruction, LodChain chain = LodChain::at_once) {
    std::size_t combinations = 1;
    for (std::size_t i = 0; i < table.size(); ++i) combinations *= levels.size();
    LodPlan best;
    for (std::size_t k = 0; k < combinations; ++k) {
        std::vector<double> r;
        std::size_t rest = k;
        for (std::size_t i = 0; i < table.size(); ++i, rest /= levels.size()) {
            r.push_back(levels[rest % levels.size()]);
        }
        const LodPlan plan = price_lod_plan(table, r, budget, reconstruction, chain);
        if (plan.within_budget && (!best.within_budget || plan.error < best.error)) best = plan;
    }
    return best;
}

TEST(LodPlan, PicksTheSplitOfExhaustiveSearch) {
    Random random(3);
    int same = 0;
    int solvable = 0;
    for (int round = 0; round < 60; ++round) {
        const auto table = random_table(random, random.integer(2, 4));
        const double budget = random.real(0.1, 0.9) * total(table);
        const double reconstruction = random.real(2, 20);
        const LodPlan plan = plan_lod(table, budget, reconstruction);
        const LodPlan best = exhaustive(table, lod_plan_levels(), budget, reconstruction);
        ASSERT_EQ(plan.within_budget, best.within_budget) << round;
        if (!best.within_budget) continue;
        ++solvable;
        bool split = true;
        for (std::size_t i = 0; i < table.size(); ++i) {
            split = split && (plan.r[i] > 1) == (best.r[i] > 1);
        }
        same += split;
        EXPECT_LE(plan.error, 1.1 * best.error + 1e-15) << round;
    }
    EXPECT_GT(solvable, 30);
    EXPECT_GE(same, 0.9 * solvable);
}

// Factors r0 2^m: never far from the best of all such tables, and usually its split.
TEST(LodPlan, NestedFactorsAreNearTheBestOfTheirKind) {
    Random random(13);
    int same = 0;
    int solvable = 0;
    for (int round = 0; round < 40; ++round) {
        const auto table = random_table(random, random.integer(2, 3));
        const double budget = random.real(0.1, 0.9) * total(table);
        const double reconstruction = random.real(2, 20);
        const LodPlan plan = plan_nested_lod(table, budget, reconstruction);
        LodPlan best;
        for (double first = 1.25; first <= 4; first += 0.25) {
            std::vector<double> levels = {1, first, 2 * first};
            if (4 * first <= 8) levels.push_back(4 * first);
            const LodPlan other =
                exhaustive(table, levels, budget, reconstruction, LodChain::nested);
            if (!other.within_budget) continue;
            if (!best.within_budget || other.error < best.error) best = other;
        }
        ASSERT_EQ(plan.within_budget, best.within_budget) << round;
        if (!best.within_budget) continue;
        ++solvable;
        EXPECT_LE(plan.error, 1.1 * best.error + 1e-15) << round;
        bool split = true;
        double least = 1e9;
        for (std::size_t i = 0; i < table.size(); ++i) {
            split = split && (plan.r[i] > 1) == (best.r[i] > 1);
            if (plan.r[i] > 1) least = std::min(least, plan.r[i]);
        }
        same += split;
        for (const double r : plan.r) {
            const double octaves = std::log2(r / least);
            EXPECT_TRUE(r == 1 || std::abs(octaves - std::round(octaves)) < 1e-9) << r;
        }
    }
    EXPECT_GT(solvable, 20);
    EXPECT_GE(same, 0.9 * solvable);
}

TEST(LodPlan, ResizesNothingThatFits) {
    Random random(4);
    const auto table = random_table(random, 3);
    EXPECT_FALSE(plan_lod(table, total(table), 20).resizes());
    // Resizing that costs more than it saves is no way into the budget.
    const std::vector<LodComponent> cheap = {{.name = "c", .cost_ns = 10, .error = 1e-3}};
    EXPECT_FALSE(plan_lod(cheap, 9, 20).resizes());
    EXPECT_FALSE(plan_lod(cheap, 9, 20).within_budget);
    EXPECT_TRUE(plan_lod(cheap, 9, 2).resizes());
    EXPECT_TRUE(plan_lod({}, 1, 1).within_budget);
}

TEST(LodPlan, MoreBudgetNeverLosesMore) {
    Random random(5);
    const auto table = random_table(random, 3);
    double before = 1e9;
    for (double share = 0.2; share <= 1; share += 0.1) {
        const LodPlan plan = plan_lod(table, share * total(table), 5);
        if (!plan.within_budget) continue;
        EXPECT_LE(plan.error, before * (1 + 1e-9));
        before = plan.error;
    }
    EXPECT_LT(before, 1e9);
}

// A chain of 2, 4 and 8 is brought up three times: to full size, to a quarter and to a sixteenth of
// its pixels.
TEST(LodPlan, ChainsCostOneReconstructionALevel) {
    const std::vector<LodComponent> table = {{.name = "a"}, {.name = "b"}, {.name = "c"}};
    const auto cost = [&](std::vector<double> r, LodChain chain) {
        return price_lod_plan(table, std::move(r), 100, 16, chain).cost_ns;
    };
    EXPECT_DOUBLE_EQ(cost({8, 2, 4}, LodChain::nested), 16 + 4 + 1);
    EXPECT_DOUBLE_EQ(cost({1, 4, 4}, LodChain::nested), 16);
    EXPECT_DOUBLE_EQ(cost({1, 2, 8}, LodChain::nested), 16 + 4);
    EXPECT_DOUBLE_EQ(cost({1, 1, 1}, LodChain::nested), 0);
    EXPECT_DOUBLE_EQ(cost({8, 2, 4}, LodChain::at_once), 16);
}

TEST(LodTimeFit, FindsItsOwnModel) {
    const std::vector<double> r = {1.25, 2, 4, 8};
    std::vector<double> ms;
    for (const double f : r) ms.push_back(80 / (f * f) + 9);
    const LodTimeFit fit = fit_lod_time(r, ms);
    EXPECT_NEAR(fit.k_ms, 80, 1e-9);
    EXPECT_NEAR(fit.c_ms, 9, 1e-9);
}

// Measured tables with noise lead to plans as good as the true table's.
TEST(LodLearning, PlansFromNoisySamplesAreNearTheTruth) {
    Random random(21);
    const std::vector<double> r = {2, 4, 8};
    int near = 0;
    constexpr int kRounds = 40;
    for (int round = 0; round < kRounds; ++round) {
        const auto table = random_table(random, 3);
        std::vector<LodComponent> learned;
        for (const LodComponent& c : table) {
            std::vector<double> with;
            std::vector<double> without;
            for (int k = 0; k < 5; ++k) {
                const double base = random.real(5, 9);  // what the moment costs besides
                without.push_back(base);
                const double jump = k == 2 ? 4.0 : 0.0;  // one frame hitches
                with.push_back(base + 230400 * c.cost_ns * 1e-6 * random.real(0.97, 1.03) + jump);
            }
            std::vector<double> mse;
            for (const double f : r) {
                mse.push_back(c.error * std::pow(f, c.exponent) * random.real(0.9, 1.1));
            }
            learned.push_back(learn_lod_component({.name = c.name,
                                                   .ms_with = with,
                                                   .ms_without = without,
                                                   .pixels = 230400,
                                                   .r = r,
                                                   .mse = mse}));
            EXPECT_NEAR(learned.back().cost_ns / c.cost_ns, 1, 0.031);
            EXPECT_NEAR(learned.back().exponent, c.exponent, 0.2);
        }
        const double budget = random.real(0.3, 0.7) * total(table);
        const LodPlan chosen = plan_lod(learned, 0.97 * budget, 5);
        const LodPlan truth = plan_lod(table, budget, 5);
        const LodPlan priced = price_lod_plan(table, chosen.r, budget, 5);
        if (!truth.within_budget) {
            ++near;
            continue;
        }
        near += priced.within_budget && priced.error <= 1.35 * truth.error + 1e-15;
    }
    EXPECT_GE(near, kRounds * 9 / 10);
}

TEST(LodLearning, HardSamples) {
    const std::vector<double> ms = {5, 5, 5};
    const std::vector<double> r = {2, 4};
    const std::vector<double> none = {0, 0};
    // Costs nothing, changes nothing.
    const LodComponent still = learn_lod_component(
        {.name = "a", .ms_with = ms, .ms_without = ms, .pixels = 100, .r = r, .mse = none});
    EXPECT_EQ(still.cost_ns, 0);
    EXPECT_EQ(still.error, 0);
    // One factor only: the curve goes through it.
    const std::vector<double> one = {4};
    const std::vector<double> seen = {0.02};
    const LodComponent point = learn_lod_component(
        {.name = "b", .ms_with = ms, .ms_without = ms, .pixels = 100, .r = one, .mse = seen});
    EXPECT_NEAR(point.error * std::pow(4, point.exponent), 0.02, 1e-12);
    // An error that falls with r is noise; the exponent stays above 0.
    const std::vector<double> falling = {0.02, 0.01};
    EXPECT_GT(
        learn_lod_component(
            {.name = "c", .ms_with = ms, .ms_without = ms, .pixels = 100, .r = r, .mse = falling})
            .exponent,
        0);
}

TEST(LodLearning, DriftIsNoticedAtTwice) {
    const LodComponent learned{.name = "a", .cost_ns = 10, .error = 1e-3, .exponent = 1.5};
    LodDrift drift(learned);
    Random random(2);
    for (int i = 0; i < 100; ++i) {
        drift.add(2, 1e-3 * std::pow(2, 1.5) * random.real(0.7, 1.3));
        ASSERT_FALSE(drift.drifted());
    }
    for (int i = 0; i < 60; ++i) drift.add(3, 2.6e-3 * std::pow(3, 1.5));
    EXPECT_TRUE(drift.drifted());
    EXPECT_NEAR(drift.current().error, 2.6e-3, 1e-4);
    drift.add(2, 0);  // no error seen says nothing of its logarithm
    EXPECT_TRUE(drift.drifted());
}

}  // namespace
}  // namespace kino
