#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "sensor/decimal.h"
#include "sensor/file_bytes.h"
#include "sensor/pairing.h"
#include "sensor/trajectory.h"
#include "sensor/tum_list.h"

namespace kino {
namespace {

using ::testing::ElementsAre;

TEST(Decimal, TimesAreExactToTheNanosecond) {
    EXPECT_EQ(parse_time("1305031453.374112"), 1305031453374112000);
    EXPECT_EQ(parse_time("1305031453.3741124"), 1305031453374112400);
    EXPECT_EQ(parse_time("0.000000001"), 1);
    EXPECT_EQ(parse_time("0.0000000019"), 1);
    EXPECT_EQ(parse_time("7"), 7 * kNsPerSecond);
    EXPECT_EQ(parse_time("7."), 7 * kNsPerSecond);
    std::mt19937_64 random(4);
    for (int i = 0; i < 1000; ++i) {
        const auto t = static_cast<TimeNs>(random() % 9'000'000'000'000'000'000u);
        const std::string digits = std::to_string(t % kNsPerSecond);
        const std::string text =
            std::to_string(t / kNsPerSecond) + "." + std::string(9 - digits.size(), '0') + digits;
        EXPECT_EQ(parse_time(text), t) << text;
    }
}

TEST(Decimal, TimesRefuseEverythingElse) {
    for (const char* text : {"", ".", ".5", "-1", "+1", "1e9", "nan", "inf", "1.5x", "0x10", " 1",
                             "9300000000", "99999999999999999999999999"}) {
        EXPECT_FALSE(parse_time(text)) << text;
    }
}

TEST(Decimal, NumbersMustBeFiniteAndWhole) {
    EXPECT_EQ(parse_number("-0.3906"), -0.3906);
    for (const char* text : {"", "nan", "inf", "-inf", "1e999", "1,5", "1 ", "abc"}) {
        EXPECT_FALSE(parse_number(text)) << text;
    }
}

TEST(Pairing, LimitIsHalfAPeriodButAtLeast17Ms) {
    std::vector<TimeNs> times;
    for (int i = 0; i < 10; ++i) times.push_back(i * 100 * kNsPerMs);
    EXPECT_EQ(pairing_limit(times), 50 * kNsPerMs);
    for (TimeNs& t : times) t /= 10;
    EXPECT_EQ(pairing_limit(times), 17 * kNsPerMs);
    EXPECT_EQ(pairing_limit({}), 17 * kNsPerMs);
}

TEST(Pairing, NearestAgreesWithALinearSearch) {
    std::mt19937 random(11);
    for (int round = 0; round < 200; ++round) {
        std::vector<TimeNs> times;
        TimeNs t = 0;
        for (unsigned i = 0; i < 1 + random() % 12; ++i) times.push_back(t += 1 + random() % 50);
        for (TimeNs query = -5; query < t + 20; ++query) {
            std::size_t best = 0;
            for (std::size_t i = 1; i < times.size(); ++i) {
                if (std::abs(times[i] - query) < std::abs(times[best] - query)) best = i;
            }
            EXPECT_EQ(nearest_in_time(times, query), best);
        }
    }
    EXPECT_FALSE(nearest_in_time({}, 5));
}

TEST(Pairing, OutsideTheLimitTheLastOneBeforeIsKeptUnpaired) {
    const std::vector<TimeNs> times = {100, 200};
    const auto inside = pair_in_time(times, 205, 5);
    ASSERT_TRUE(inside);
    EXPECT_TRUE(inside->paired);
    EXPECT_EQ(inside->index, 1u);
    const auto between = pair_in_time(times, 190, 5);
    ASSERT_TRUE(between);
    EXPECT_FALSE(between->paired);
    EXPECT_EQ(between->index, 0u) << "the nearest lies in the future, the last before is kept";
    EXPECT_FALSE(pair_in_time(times, 50, 5)) << "nothing came before";
}

TEST(TumList, ReadsNamesWithBlanksAndSkipsWhatIsMalformed) {
    const auto list = parse_tum_list(
        "# depth\n1.5 depth/a.png\r\n\nx depth/b.png\n2.5\n1.5 depth/again.png\n"
        "0.5 depth/back.png\n3.5   depth/with blank.png  \n-4 depth/c.png\nnan d.png");
    ASSERT_EQ(list.files.size(), 2u);
    EXPECT_EQ(list.files[0].name, "depth/a.png");
    EXPECT_EQ(list.files[1].name, "depth/with blank.png");
    EXPECT_EQ(list.files[1].time, 3'500'000'000);
    EXPECT_EQ(list.skipped, 6u);
}

TEST(TumList, NamesThatAreTimesSortByTime) {
    const auto list =
        list_from_names({"rgb/10.5.png", "rgb/9.25.png", "rgb/x.png", "rgb/9.250.png"});
    ASSERT_EQ(list.files.size(), 2u);
    EXPECT_EQ(list.files[0].name, "rgb/9.25.png");
    EXPECT_EQ(list.files[1].time, 10'500'000'000);
    EXPECT_EQ(list.skipped, 2u);
}

TEST(PathInside, RefusesNamesThatLeadOut) {
    EXPECT_EQ(path_inside("a", "depth/b.png")->string(), "a/depth/b.png");
    for (const char* name : {"", "/etc/passwd", "../b.png", "depth/../../b.png"}) {
        EXPECT_FALSE(path_inside("a", name)) << name;
    }
    EXPECT_FALSE(path_inside("a", std::string("a\0b", 3)));
}

TEST(Trajectory, TurnsZUpToYUp) {
    // A camera level at 1.5 m whose optical axis points along the file's +y: its x axis is +x, its
    // y axis (down) is -z. As a rotation that is -90 degrees about x.
    const double h = std::sqrt(0.5);
    const auto parsed =
        parse_tum_trajectory("1 2 3 1.5 " + std::to_string(-h) + " 0 0 " + std::to_string(h));
    ASSERT_EQ(parsed.trajectory.poses.size(), 1u);
    const Pose& pose = parsed.trajectory.poses[0];
    EXPECT_NEAR(glm::length(pose.translation - glm::dvec3(2, 1.5, -3)), 0, 1e-12);
    // Up to the camera (its -y) is up in our world (+y); ahead is the file's +y, our -z.
    EXPECT_NEAR(glm::length(pose.rotation * glm::dvec3(0, -1, 0) - glm::dvec3(0, 1, 0)), 0, 1e-6);
    EXPECT_NEAR(glm::length(pose.rotation * glm::dvec3(0, 0, 1) - glm::dvec3(0, 0, -1)), 0, 1e-6);
    EXPECT_TRUE(is_valid(pose));
}

TEST(Trajectory, InterpolatesInsideAndNowhereElse) {
    const auto parsed =
        parse_tum_trajectory("1.0 0 0 0 0 0 0 1\n1.2 2 0 0 0 0 1 0\n9 0 0 0 0 0 0 1");
    const Trajectory& track = parsed.trajectory;
    ASSERT_EQ(track.times.size(), 3u);
    EXPECT_EQ(track.at(kNsPerSecond), track.poses[0]);
    EXPECT_EQ(track.at(1200 * kNsPerMs), track.poses[1]);
    const auto middle = track.at(1100 * kNsPerMs);
    ASSERT_TRUE(middle);
    EXPECT_NEAR(middle->translation.x, 1.0, 1e-12);
    // Half of a half turn: equally far from both ends.
    EXPECT_NEAR(std::abs(glm::dot(middle->rotation, track.poses[0].rotation)),
                std::abs(glm::dot(middle->rotation, track.poses[1].rotation)), 1e-12);
    EXPECT_FALSE(track.at(999 * kNsPerMs));
    EXPECT_FALSE(track.at(5 * kNsPerSecond)) << "a gap of 7.8 s";
    EXPECT_FALSE(track.at(10 * kNsPerSecond));
}

TEST(Trajectory, NanZeroQuaternionAndRepeatedTimesAreSkippedAndCounted) {
    const auto parsed = parse_tum_trajectory(
        "1 0 0 0 0 0 0 1\n2 nan 0 0 0 0 0 1\n3 0 0 0 0 0 0 0\n4 0 0 0 0 0 0 1.5\n"
        "1 0 0 0 0 0 0 1\n5 0 0 0 0 0 0\n6 inf 0 0 0 0 0 1\n7 1e300 0 0 0 0 0 1\n"
        "8 0 0 0 0 0 0 0.999");
    EXPECT_THAT(parsed.trajectory.times, ElementsAre(kNsPerSecond, 8 * kNsPerSecond));
    EXPECT_EQ(parsed.skipped, 7u);
    for (const Pose& pose : parsed.trajectory.poses) EXPECT_TRUE(is_valid(pose));
}

}  // namespace
}  // namespace kino
