#include "skeleton/tracking/part_modes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "tests/support/random.h"

namespace kino {
namespace {

using glm::dvec3;
using glm::vec3;
using test::Random;

constexpr auto kHand = static_cast<std::size_t>(BodyPart::hand_left);

struct Sample {
    dvec3 at;
    double share;
};

std::vector<Sample> cluster(Random& random, const dvec3& middle, int count, double spread) {
    std::vector<Sample> samples;
    for (int i = 0; i < count; ++i) {
        const dvec3 d(random.real(-1, 1), random.real(-1, 1), random.real(-1, 1));
        samples.push_back({middle + d * spread, random.real(0.3, 1)});
    }
    return samples;
}

PartPoints points_of(const std::vector<Sample>& samples) {
    PartPoints points;
    std::array<float, kBodyPartCount> share{};
    for (const Sample& s : samples) {
        share.fill(0);
        share[kHand] = static_cast<float>(s.share);
        points.add(vec3(s.at), share);
    }
    return points;
}

// Mean shift as the paper has it, in doubles, to the end.
dvec3 reference_mode(const std::vector<Sample>& samples, dvec3 at, double bandwidth) {
    for (int round = 0; round < 2000; ++round) {
        dvec3 sum(0);
        double weight = 0;
        for (const Sample& s : samples) {
            const dvec3 d = s.at - at;
            const double w = s.share * s.at.z * s.at.z *
                             std::exp(-0.5 * glm::dot(d, d) / (bandwidth * bandwidth));
            sum += w * s.at;
            weight += w;
        }
        const dvec3 next = sum / weight;
        const double moved = glm::length(next - at);
        at = next;
        if (moved < 1e-10) break;
    }
    return at;
}

TEST(PartModes, AreTheReferencesFixedPoints) {
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
        Random random(seed);
        const dvec3 middle(random.real(-0.5, 0.5), random.real(-0.5, 0.5), random.real(1, 3));
        const std::vector<Sample> samples = cluster(random, middle, 60, 0.06);
        PartModes modes;
        ModeOptions options;
        options.rounds = 100;
        options.stop_m = 1e-6f;
        modes.find(points_of(samples), 0.01f, options);
        ASSERT_FALSE(modes.of(BodyPart::hand_left).empty());
        const PartMode& mode = modes.of(BodyPart::hand_left)[0];
        const dvec3 exact = reference_mode(samples, dvec3(mode.surface_m), 0.065);
        EXPECT_LT(glm::length(exact - dvec3(mode.surface_m)), 2e-4) << seed;
        EXPECT_TRUE(modes.of(BodyPart::hand_right).empty());
    }
}

TEST(PartModes, FewRoundsComeWithinTwoMillimetres) {
    Random random(3);
    const std::vector<Sample> samples = cluster(random, {0.2, 0.1, 2}, 80, 0.07);
    PartModes modes;
    modes.find(points_of(samples), 0.01f);
    ASSERT_FALSE(modes.of(BodyPart::hand_left).empty());
    const dvec3 at(modes.of(BodyPart::hand_left)[0].surface_m);
    EXPECT_LT(glm::length(reference_mode(samples, at, 0.065) - at), 2e-3);
}

TEST(PartModes, TwoHeapsAreTwoModesAndTheHeavierIsFirst) {
    Random random(5);
    std::vector<Sample> samples = cluster(random, {-0.3, 0, 2}, 25, 0.03);
    const std::vector<Sample> more = cluster(random, {0.3, 0, 2}, 60, 0.03);
    samples.insert(samples.end(), more.begin(), more.end());
    PartModes modes;
    modes.find(points_of(samples), 0.01f);
    const auto& found = modes.of(BodyPart::hand_left);
    ASSERT_EQ(found.size(), 2u);
    EXPECT_GT(found[0].surface_m.x, 0.25f);
    EXPECT_LT(found[1].surface_m.x, -0.25f);
    EXPECT_GT(found[0].weight_m2, found[1].weight_m2);
}

TEST(PartModes, ArePushedInwardsAwayFromTheCamera) {
    Random random(6);
    PartModes modes;
    modes.find(points_of(cluster(random, {0.4, -0.2, 2}, 50, 0.02)), 0.01f);
    ASSERT_FALSE(modes.of(BodyPart::hand_left).empty());
    const PartMode& mode = modes.of(BodyPart::hand_left)[0];
    EXPECT_NEAR(glm::length(mode.center_m) - glm::length(mode.surface_m),
                part_place(BodyPart::hand_left).inward_m, 1e-5f);
    EXPECT_LT(glm::length(glm::normalize(mode.center_m) - glm::normalize(mode.surface_m)), 1e-5f);
}

TEST(PartModes, NothingUnlikelyStartsAMode) {
    Random random(7);
    std::vector<Sample> samples = cluster(random, {0, 0, 2}, 50, 0.02);
    for (Sample& s : samples) s.share = 0.1;
    PartModes modes;
    modes.find(points_of(samples), 0.01f);
    EXPECT_TRUE(modes.of(BodyPart::hand_left).empty());
}

TEST(PartPoints, WhatIsNoPlaceIsNoPoint) {
    PartPoints points;
    std::array<float, kBodyPartCount> share{};
    share[0] = 1;
    const float nan = std::nanf("");
    points.add({nan, 0, 2}, share);
    points.add({0, 0, nan}, share);
    points.add({0, 0, 0}, share);
    points.add({0, 0, -1}, share);
    EXPECT_EQ(points.size(), 0u);
    points.add({0, 0, 1}, share);
    EXPECT_EQ(points.size(), 1u);
}

TEST(PartPoints, ThinningKeepsSmallPartsWhole) {
    PartPoints points;
    std::array<float, kBodyPartCount> share{};
    for (int i = 0; i < 1000; ++i) {
        share.fill(0);
        share[i % 100 == 0 ? kHand : static_cast<std::size_t>(BodyPart::chest_left)] = 1;
        points.add({0.001f * static_cast<float>(i), 0, 2}, share);
    }
    std::vector<PartPoint> chosen;
    points.choose(40, chosen);
    int hands = 0, chests = 0;
    for (const PartPoint& p : chosen) {
        hands += p.candidate[0].part == kHand ? 1 : 0;
        chests += p.candidate[0].part == static_cast<int>(BodyPart::chest_left) ? 1 : 0;
        // Its mirror image is always possible, and less likely.
        ASSERT_GE(p.count, 2);
        EXPECT_EQ(p.candidate[1].part,
                  static_cast<int>(mirrored(static_cast<BodyPart>(p.candidate[0].part))));
        EXPECT_GT(p.candidate[1].cost, p.candidate[0].cost);
    }
    EXPECT_EQ(hands, 10);
    EXPECT_NEAR(chests, 40, 1);
}

}  // namespace
}  // namespace kino
