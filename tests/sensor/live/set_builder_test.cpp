#include "sensor/live/set_builder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <thread>
#include <vector>

#include "fake_device.h"
#include "sensor/pairing.h"
#include "tests/support/random.h"

namespace kino {
namespace {

using test::fake_frame;

constexpr TimeNs kForEver = 3600 * kNsPerSecond;
constexpr TimeNs kPeriod = kNsPerSecond / 30;

SetBuilderOptions unhurried() {
    return {.waiting_sets = 100000, .history = 100000, .patience = kForEver, .foresee = false};
}

std::vector<TimeNs> stream_times(test::Random& random, TimeNs period, TimeNs jitter, double lost) {
    std::vector<TimeNs> times;
    const TimeNs start = from_seconds(random.real(0, 0.03));
    for (int i = 0; i < 200; ++i) {
        if (random.chance(lost)) continue;
        const auto offset = random.real(0, static_cast<double>(jitter) + 1);
        times.push_back(kNsPerSecond + start + i * period + static_cast<TimeNs>(offset));
    }
    return times;
}

void put(SetBuilder& sets, StreamKind kind, TimeNs time) {
    sets.put(kind, fake_frame(kind, time, time));
}

/// What pairing.h says about the colour of a depth frame, given everything there ever was.
void expect_as_pair_in_time(const FrameSet& set, const std::vector<TimeNs>& color) {
    const auto pairing = pair_in_time(color, set.time, pairing_limit(color));
    ASSERT_EQ(set.color != nullptr, pairing.has_value());
    EXPECT_EQ(set.depth->header.host_time, set.time);
    if (!pairing) return;
    EXPECT_EQ(set.color->header.host_time, color[pairing->index]);
    EXPECT_EQ(set.color_paired, pairing->paired);
}

TEST(SetBuilder, PairsAsPairInTimeDoesOverEverything) {
    test::Random random(1);
    for (int round = 0; round < 50; ++round) {
        const auto depth = stream_times(random, kPeriod, 5 * kNsPerMs, 0.1);
        const auto color =
            stream_times(random, kPeriod * random.integer(1, 2), 8 * kNsPerMs, random.real(0, 0.4));
        SetBuilder sets(unhurried());
        sets.turn(StreamKind::depth, true);
        sets.turn(StreamKind::color, true);
        for (const TimeNs time : depth) put(sets, StreamKind::depth, time);
        for (const TimeNs time : color) put(sets, StreamKind::color, time);
        std::size_t i = 0;
        while (const auto set = sets.next(0)) {
            ASSERT_EQ(set->index, static_cast<std::int64_t>(i));
            ASSERT_EQ(set->time, depth[i++]);
            expect_as_pair_in_time(*set, color);
            if (HasFailure()) return;
        }
        // All but those after the last colour frame, which might have got another one still.
        EXPECT_EQ(
            i, static_cast<std::size_t>(std::upper_bound(depth.begin(), depth.end(), color.back()) -
                                        depth.begin()));
        EXPECT_EQ(sets.overtaken(), 0);
    }
}

TEST(SetBuilder, PairsTheSameWithForesightOnFramesAsTheyCome) {
    test::Random random(2);
    int at_once = 0;
    for (int round = 0; round < 50; ++round) {
        const auto depth = stream_times(random, kPeriod, kNsPerMs / 10, 0);
        const auto color = stream_times(random, kPeriod, kNsPerMs / 10, 0);
        SetBuilderOptions options = unhurried();
        options.foresee = true;
        options.history = 16;
        SetBuilder sets(options);
        sets.turn(StreamKind::depth, true);
        sets.turn(StreamKind::color, true);
        std::size_t d = 0;
        std::size_t read = 0;
        for (const TimeNs time : color) {
            for (; d < depth.size() && depth[d] < time; ++d) {
                put(sets, StreamKind::depth, depth[d]);
                if (const auto set = sets.next(0)) {
                    ++at_once;
                    ++read;
                    expect_as_pair_in_time(*set, color);
                }
            }
            put(sets, StreamKind::color, time);
            while (const auto set = sets.next(0)) {
                ++read;
                // The first ones know of too few colour frames to have the same limit.
                if (set->index > 3) expect_as_pair_in_time(*set, color);
            }
            if (HasFailure()) return;
        }
        EXPECT_EQ(read, d);
    }
    // In half of all phases the nearest colour frame is there already.
    EXPECT_GT(at_once, 50 * 200 / 4);
}

TEST(SetBuilder, WaitsOnlyForAPartnerThatWouldBeNearer) {
    for (const TimeNs color_ahead : {5 * kNsPerMs, 28 * kNsPerMs}) {
        SetBuilder sets({.patience = kForEver});
        sets.turn(StreamKind::depth, true);
        sets.turn(StreamKind::color, true);
        const TimeNs depth = 10 * kPeriod;
        for (int i = 5; i >= 0; --i)
            put(sets, StreamKind::color, depth - color_ahead - i * kPeriod);
        put(sets, StreamKind::depth, depth);
        auto set = sets.next(0);
        EXPECT_EQ(set.has_value(), color_ahead < kPeriod / 2);
        if (!set) {
            put(sets, StreamKind::color, depth - color_ahead + kPeriod);
            set = sets.next(0);
        }
        ASSERT_TRUE(set);
        EXPECT_TRUE(set->color_paired);
        EXPECT_LT(std::abs(set->color->header.host_time - depth), 6 * kNsPerMs);
    }
}

TEST(SetBuilder, AStreamThatStandsStillHoldsNothingUp) {
    SetBuilder sets({.waiting_sets = 100, .patience = kForEver});
    sets.turn(StreamKind::depth, true);
    sets.turn(StreamKind::color, true);
    for (int i = 0; i < 4; ++i) put(sets, StreamKind::color, i * kPeriod);
    for (int i = 6; i < 20; ++i) {
        put(sets, StreamKind::depth, i * kPeriod);
        const auto set = sets.next(0);
        ASSERT_TRUE(set);
        EXPECT_EQ(set->color->header.host_time, 3 * kPeriod);
        EXPECT_FALSE(set->color_paired);
    }
}

TEST(SetBuilder, PatienceEndsForAPartnerThatNeverComes) {
    SetBuilder sets({.patience = kNsPerMs});
    sets.turn(StreamKind::depth, true);
    sets.turn(StreamKind::color, true);
    put(sets, StreamKind::depth, kPeriod);
    const auto set = sets.next(kForEver);
    ASSERT_TRUE(set);
    EXPECT_EQ(set->color, nullptr);
}

TEST(SetBuilder, TheNewestWinsAndTheOthersAreCounted) {
    SetBuilder sets({.waiting_sets = 1});
    sets.turn(StreamKind::depth, true);
    for (int i = 1; i <= 5; ++i) put(sets, StreamKind::depth, i * kPeriod);
    const auto set = sets.next(0);
    ASSERT_TRUE(set);
    EXPECT_EQ(set->time, 5 * kPeriod);
    EXPECT_EQ(set->index, 0);
    EXPECT_FALSE(sets.next(0));
    EXPECT_EQ(sets.overtaken(), 4);
}

TEST(SetBuilder, AFinishedSetIsNotOvertakenByOneThatStillWaits) {
    SetBuilder sets({.waiting_sets = 1, .patience = kForEver, .foresee = false});
    sets.turn(StreamKind::depth, true);
    sets.turn(StreamKind::color, true);
    put(sets, StreamKind::depth, kPeriod);
    put(sets, StreamKind::color, kPeriod);
    put(sets, StreamKind::depth, 2 * kPeriod);
    const auto set = sets.next(0);
    ASSERT_TRUE(set);
    EXPECT_EQ(set->time, kPeriod);
    EXPECT_FALSE(sets.next(0));
    EXPECT_EQ(sets.overtaken(), 0);
}

TEST(SetBuilder, EverySetIsReadOvertakenOrWaiting) {
    test::Random random(3);
    for (std::size_t waiting : {1u, 2u, 5u}) {
        SetBuilder sets({.waiting_sets = waiting});
        sets.turn(StreamKind::depth, true);
        std::int64_t read = 0;
        for (int i = 1; i <= 2000; ++i) {
            put(sets, StreamKind::depth, i * kPeriod);
            if (random.chance(0.4) && sets.next(0)) ++read;
        }
        while (sets.next(0)) ++read;
        EXPECT_EQ(read + sets.overtaken(), 2000);
    }
}

TEST(SetBuilder, ColorLeadsWithoutDepthAndInfraredWithoutEither) {
    SetBuilder sets({.waiting_sets = 10, .patience = kForEver});
    EXPECT_FALSE(sets.next(0));
    sets.turn(StreamKind::infrared, true);
    put(sets, StreamKind::infrared, 1);
    put(sets, StreamKind::depth, 1);
    auto set = sets.next(0);
    ASSERT_TRUE(set);
    EXPECT_TRUE(set->infrared && !set->depth && !set->color);
    sets.turn(StreamKind::infrared, false);
    sets.turn(StreamKind::color, true);
    put(sets, StreamKind::color, 2);
    set = sets.next(0);
    ASSERT_TRUE(set);
    EXPECT_TRUE(set->color && !set->infrared && set->color_paired);
    sets.turn(StreamKind::depth, true);
    put(sets, StreamKind::color, 3);
    EXPECT_FALSE(sets.next(0));
    put(sets, StreamKind::depth, 3);
    set = sets.next(0);
    ASSERT_TRUE(set);
    EXPECT_TRUE(set->color && set->depth && set->color_paired);
    EXPECT_EQ(set->index, 2);
}

TEST(SetBuilder, InfraredThatIsNotNearIsLeftOut) {
    SetBuilder sets({.waiting_sets = 10});
    sets.turn(StreamKind::depth, true);
    sets.turn(StreamKind::infrared, true);
    put(sets, StreamKind::infrared, kPeriod);
    put(sets, StreamKind::depth, kPeriod);
    put(sets, StreamKind::depth, 10 * kPeriod);
    EXPECT_NE(sets.next(kForEver)->infrared, nullptr);
    EXPECT_EQ(sets.next(kForEver)->infrared, nullptr);
}

TEST(SetBuilder, AWaitingReaderIsWokenByAFrame) {
    SetBuilder sets({});
    sets.turn(StreamKind::depth, true);
    std::thread writer([&] { put(sets, StreamKind::depth, 7); });
    const auto set = sets.next(kForEver);
    writer.join();
    ASSERT_TRUE(set);
    EXPECT_EQ(set->time, 7);
}

}  // namespace
}  // namespace kino
