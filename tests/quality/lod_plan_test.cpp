#include "viz/quality/lod_plan.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/random.h"

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
LodPlan exhaustive(const std::vector<LodComponent>& table, double budget, double reconstruction) {
    const auto levels = lod_plan_levels();
    std::size_t combinations = 1;
    for (std::size_t i = 0; i < table.size(); ++i) combinations *= levels.size();
    LodPlan best;
    for (std::size_t k = 0; k < combinations; ++k) {
        std::vector<double> r;
        std::size_t rest = k;
        for (std::size_t i = 0; i < table.size(); ++i, rest /= levels.size()) {
            r.push_back(levels[rest % levels.size()]);
        }
        const LodPlan plan = price_lod_plan(table, r, budget, reconstruction);
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
        const LodPlan best = exhaustive(table, budget, reconstruction);
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

TEST(LodTimeFit, FindsItsOwnModel) {
    const std::vector<double> r = {1.25, 2, 4, 8};
    std::vector<double> ms;
    for (const double f : r) ms.push_back(80 / (f * f) + 9);
    const LodTimeFit fit = fit_lod_time(r, ms);
    EXPECT_NEAR(fit.k_ms, 80, 1e-9);
    EXPECT_NEAR(fit.c_ms, 9, 1e-9);
}

}  // namespace
}  // namespace kino
