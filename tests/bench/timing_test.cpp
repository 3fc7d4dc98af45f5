#include "apps/bench/timing.h"

#include <gmock/gmock.h>

#include <chrono>
#include <cmath>
#include <string>
#include <thread>

#include "tests/support/random.h"

namespace kino::bench {
namespace {

using testing::StartsWith;

TEST(Quantile, Type7ReferenceValues) {
    // R: quantile(c(1, 2, 4, 8), c(0, .25, .5, .95, 1)).
    const std::vector<double> samples{8, 1, 4, 2};
    EXPECT_DOUBLE_EQ(quantile(samples, 0), 1);
    EXPECT_DOUBLE_EQ(quantile(samples, 0.25), 1.75);
    EXPECT_DOUBLE_EQ(quantile(samples, 0.5), 3);
    EXPECT_DOUBLE_EQ(quantile(samples, 0.95), 7.4);
    EXPECT_DOUBLE_EQ(quantile(samples, 1), 8);
    EXPECT_EQ(quantile(std::vector<double>{5}, 0.95), 5);
    EXPECT_TRUE(std::isnan(quantile({}, 0.5)));
}

TEST(Quantile, RisesWithItsRankAndStaysInRange) {
    test::Random random(1);
    std::vector<double> samples(37);
    for (double& sample : samples) sample = random.real(-3, 9);
    double before = -3;
    for (double q = 0; q <= 1; q += 1.0 / 64) {
        EXPECT_GE(quantile(samples, q), before);
        before = quantile(samples, q);
    }
    EXPECT_LE(before, 9);
}

TEST(Compare, RunsInterleavedForthAndBackAfterTheWarmUp) {
    std::string order;
    const std::vector<Candidate> candidates{
        {.name = "a", .run = [&] { order += 'A'; }, .prepare = [&] { order += 'p'; }},
        {.name = "b", .run = [&] { order += 'B'; }, .prepare = {}}};
    const auto comparison = compare(candidates, {.repeats = 3, .warm_up = 1});
    EXPECT_EQ(order,
              "pAB"
              "pAB"
              "BpA"
              "pAB");
    EXPECT_EQ(comparison["a"].ms.size(), 3u);
    EXPECT_EQ(comparison["b"].ms.size(), 3u);
}

TEST(Compare, PrepareIsNotTimed) {
    using namespace std::chrono_literals;
    const std::vector<Candidate> candidates{
        {.name = "a", .run = [] {}, .prepare = [] { std::this_thread::sleep_for(2ms); }},
        {.name = "b", .run = [] { std::this_thread::sleep_for(2ms); }, .prepare = {}}};
    const auto comparison = compare(candidates, {.repeats = 9, .warm_up = 1});
    EXPECT_LT(comparison["a"].median_ms(), comparison["b"].median_ms());
    EXPECT_GE(comparison["b"].median_ms(), 2.0);
    EXPECT_GT(comparison.speedup("a", "b"), 1);
}

TEST(Compare, StopsAtItsTimeButNotBeforeFiveRounds) {
    const std::vector<Candidate> candidates{{.name = "a", .run = [] {}, .prepare = {}}};
    EXPECT_EQ(compare(candidates, {.repeats = 50, .warm_up = 0, .max_seconds = 0})["a"].ms.size(),
              5u);
}

TEST(Comparison, SpeedupIsTheMedianOfPairedRatios) {
    // Medians alone would say 20 / 10; pair by pair the ratios are 4, 2, 0.5.
    const Comparison comparison(
        {{.name = "new", .ms = {10, 10, 40}}, {.name = "old", .ms = {40, 20, 20}}});
    EXPECT_DOUBLE_EQ(comparison.speedup("new", "old"), 2);
    EXPECT_DOUBLE_EQ(comparison.speedup("old", "new"), 0.5);
    EXPECT_DOUBLE_EQ(comparison.speedup("new", "new"), 1);
    const Comparison skewed(
        {{.name = "new", .ms = {1, 10, 100}}, {.name = "old", .ms = {30, 30, 30}}});
    EXPECT_DOUBLE_EQ(skewed.speedup("new", "old"), 3);
}

TEST(Comparison, ATimeOfZeroGivesNoInfinity) {
    const Comparison comparison({{.name = "a", .ms = {0}}, {.name = "b", .ms = {0}}});
    EXPECT_EQ(comparison.speedup("a", "b"), 1);
}

TEST(ComparisonDeathTest, AnUnknownNameIsAProgrammersError) {
    const Comparison comparison({{.name = "a", .ms = {1}}});
    EXPECT_DEATH(static_cast<void>(comparison["b"]), "check");
}

}  // namespace
}  // namespace kino::bench
