#include "sensor/live/device_clock.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "tests/support/random.h"

namespace kino {
namespace {

constexpr double kRate = 60e6;
constexpr TimeNs kLeastDelay = 2 * kNsPerMs;

/// A device whose counter runs `drift` too fast and whose frames reach the host late.
struct SimulatedDevice {
    double drift = 0;
    double rate = kRate;
    int bits = 32;
    TimeNs counter_zero = 0;  ///< true time at which the counter stood at 0
    test::Random random{1};

    std::uint64_t ticks(TimeNs now) const {
        const long double elapsed = static_cast<long double>(now - counter_zero) * 1e-9L;
        const auto whole = static_cast<std::uint64_t>(std::floor(elapsed * rate * (1 + drift)));
        return bits == 64 ? whole : whole & ((std::uint64_t{1} << bits) - 1);
    }
    /// Mostly a little late, one time in twenty much.
    TimeNs arrival(TimeNs now) {
        const double jitter_ms = -std::log(random.real(1e-6, 1)) * 1.5;
        const double spike_ms = random.chance(0.05) ? random.real(5, 60) : 0;
        return now + kLeastDelay + from_seconds((jitter_ms + spike_ms) * 1e-3);
    }
};

constexpr TimeNs kClockPeriod = kNsPerSecond / 30;

struct Law {
    bool any = false;
    DeviceClock::Moment last;
    void rises(const DeviceClock::Moment& moment, TimeNs arrival) {
        if (any) {
            ASSERT_GT(moment.device_time, last.device_time);
            ASSERT_GT(moment.host_time, last.host_time);
        }
        ASSERT_LE(moment.host_time, std::max(arrival, last.host_time + 1));
        last = moment;
        any = true;
    }
};

TEST(DeviceClock, FollowsTheTrueTimeThroughDriftJitterAndWraps) {
    for (const double drift : {-1e-4, 0.0, 1e-4, 3e-3}) {
        SimulatedDevice device{.drift = drift, .counter_zero = -7 * kNsPerSecond};
        DeviceClock clock(kRate, 32);
        Law law;
        TimeNs last_arrival = 0;
        TimeNs worst = 0;
        // Ten minutes: the counter wraps eight times.
        for (TimeNs now = 0; now < 600 * kNsPerSecond; now += kClockPeriod) {
            const TimeNs arrival = last_arrival = std::max(last_arrival, device.arrival(now));
            const auto moment = clock.at(device.ticks(now), arrival);
            law.rises(moment, arrival);
            if (HasFatalFailure()) return;
            if (now > 10 * kNsPerSecond) {
                worst = std::max(worst, std::abs(moment.host_time - now - kLeastDelay));
            }
        }
        EXPECT_LT(worst, kNsPerMs) << "drift " << drift;
        EXPECT_NEAR(clock.ticks_per_second() / (kRate * (1 + drift)), 1, 2e-5);
        EXPECT_EQ(clock.jumps(), 0);
    }
}

TEST(DeviceClock, DeviceTimeIsTheUnwrappedCounterAtTheNominalRate) {
    SimulatedDevice device{.drift = 1e-4};
    DeviceClock clock(kRate, 32);
    const TimeNs start = 70 * kNsPerSecond;
    for (TimeNs now = start; now < start + 200 * kNsPerSecond; now += kClockPeriod) {
        const auto moment = clock.at(device.ticks(now), device.arrival(now));
        const auto expected = static_cast<double>(now - start) * (1 + device.drift);
        ASSERT_NEAR(static_cast<double>(moment.device_time), expected, 40);
    }
}

TEST(DeviceClock, APauseLongerThanTheCountersRangeIsNotLost) {
    SimulatedDevice device{.drift = 1e-4};
    DeviceClock clock(kRate, 32);
    Law law;
    const auto run = [&](TimeNs from, TimeNs to) {
        for (TimeNs now = from; now < to; now += kClockPeriod) {
            const TimeNs arrival = std::max(law.last.host_time, device.arrival(now));
            law.rises(clock.at(device.ticks(now), arrival), arrival);
            if (HasFatalFailure()) return;
        }
    };
    run(0, 20 * kNsPerSecond);
    run(200 * kNsPerSecond, 201 * kNsPerSecond);
    EXPECT_NEAR(to_seconds(law.last.host_time), 201, 0.05);
    EXPECT_NEAR(to_seconds(law.last.device_time), 201, 0.1);
    EXPECT_EQ(clock.jumps(), 0);
}

TEST(DeviceClock, AResetOfTheCounterIsFoundAndTimeGoesOn) {
    test::Random random(5);
    for (int round = 0; round < 40; ++round) {
        SimulatedDevice device{.drift = 1e-4};
        device.random = test::Random(random.bits());
        DeviceClock clock(kRate, 32);
        Law law;
        TimeNs last_arrival = 0;
        const TimeNs reset = from_seconds(random.real(3, 60));
        for (TimeNs now = 0; now < reset + 5 * kNsPerSecond; now += kClockPeriod) {
            if (now >= reset && device.counter_zero == 0) device.counter_zero = now;
            const TimeNs arrival = last_arrival = std::max(last_arrival, device.arrival(now));
            const auto moment = clock.at(device.ticks(now), arrival);
            law.rises(moment, arrival);
            if (HasFatalFailure()) return;
            // A spike of delay at the reset may stay until the line has sunk to its place.
            ASSERT_LT(std::abs(moment.host_time - now), 75 * kNsPerMs) << "round " << round;
            ASSERT_LT(std::abs(moment.device_time - now), 75 * kNsPerMs) << "round " << round;
        }
        EXPECT_EQ(clock.jumps(), 1);
    }
}

TEST(DeviceClock, RestartTakesTheNextStampAsItIs) {
    SimulatedDevice device;
    DeviceClock clock(kRate, 32);
    Law law;
    for (TimeNs now = 0; now < 10 * kNsPerSecond; now += kClockPeriod) {
        law.rises(clock.at(device.ticks(now), now + kLeastDelay), now + kLeastDelay);
    }
    clock.restart();
    // A stamp that would also do as the next one: only restart() can tell.
    const TimeNs later = 40 * kNsPerSecond;
    const auto moment = clock.at(device.ticks(11 * kNsPerSecond), later);
    law.rises(moment, later);
    EXPECT_EQ(moment.host_time, later);
    EXPECT_NEAR(to_seconds(moment.device_time), 40, 1e-2);
    EXPECT_EQ(clock.jumps(), 0);
}

TEST(DeviceClock, AResetDuringALongPauseIsFoundByStayingLate) {
    SimulatedDevice device;
    DeviceClock clock(kRate, 32);
    Law law;
    for (TimeNs now = 0; now < 5 * kNsPerSecond; now += kClockPeriod) {
        law.rises(clock.at(device.ticks(now), now), now);
    }
    // The counter goes on 10 s behind after a pause of 40 s: like a backlog, but it never ends.
    device.counter_zero = 10 * kNsPerSecond;
    const TimeNs back = 45 * kNsPerSecond;
    for (TimeNs now = back; now < back + 5 * kNsPerSecond; now += kClockPeriod) {
        law.rises(clock.at(device.ticks(now), now), now);
    }
    EXPECT_EQ(clock.jumps(), 1);
    EXPECT_NEAR(to_seconds(law.last.host_time), 50, 0.04);
}

TEST(DeviceClock, ABacklogAfterAStandstillKeepsItsTimes) {
    SimulatedDevice device;
    DeviceClock clock(kRate, 32);
    Law law;
    for (TimeNs now = 0; now < 20 * kNsPerSecond; now += kClockPeriod) {
        // The process stood still from 10 s to 13 s.
        const TimeNs arrival = now > 10 * kNsPerSecond ? std::max(now, 13 * kNsPerSecond) : now;
        const auto moment = clock.at(device.ticks(now), arrival);
        law.rises(moment, arrival);
        if (HasFatalFailure()) return;
        ASSERT_LT(std::abs(moment.host_time - now), kNsPerMs);
    }
    EXPECT_EQ(clock.jumps(), 0);
}

TEST(DeviceClock, OnePunctualStampIsEnoughToSetLateOnesRight) {
    DeviceClock clock(kRate, 32);
    SimulatedDevice device;
    const TimeNs late[] = {20 * kNsPerMs, 0, 20 * kNsPerMs, 30 * kNsPerMs};
    for (int i = 0; i < 4; ++i) {
        const TimeNs now = (i + 1) * kClockPeriod;
        const auto moment = clock.at(device.ticks(now), now + late[i]);
        if (i > 0) {
            EXPECT_LT(std::abs(moment.host_time - now), kNsPerMs) << i;
        }
    }
}

TEST(DeviceClock, TwoStreamsMayShareItAndSwapPlaces) {
    SimulatedDevice device{.drift = 1e-4};
    DeviceClock clock(kRate, 32);
    TimeNs newest = 0;
    for (TimeNs now = kNsPerSecond; now < 100 * kNsPerSecond; now += kClockPeriod) {
        const TimeNs arrival = now + 40 * kNsPerMs;
        const auto depth = clock.at(device.ticks(now), arrival);
        const auto color = clock.at(device.ticks(now - 20 * kNsPerMs), arrival);
        ASSERT_GT(depth.host_time, newest);
        newest = depth.host_time;
        if (now < 3 * kNsPerSecond) continue;
        ASSERT_NEAR(static_cast<double>(depth.device_time - color.device_time), 20.002e6, 100);
        ASSERT_NEAR(static_cast<double>(depth.host_time - color.host_time), 20e6, 0.2e6);
    }
    EXPECT_EQ(clock.jumps(), 0);
}

TEST(DeviceClock, AnyStampsAtAllGiveRisingTimesNoLaterThanTheirArrival) {
    for (const int bits : {8, 16, 32, 48, 64}) {
        test::Random random(static_cast<std::uint64_t>(bits));
        DeviceClock clock(1e6, bits);
        TimeNs newest_device = -1;
        TimeNs newest_host = -1;
        TimeNs arrival = 0;
        for (int i = 0; i < 20000; ++i) {
            arrival += random.chance(0.1) ? random.integer(0, 2'000'000'000)
                                          : random.integer(0, 50'000'000);
            const std::uint64_t ticks =
                random.chance(0.3) ? random.bits() : static_cast<std::uint64_t>(arrival / 1000);
            const auto moment = clock.at(ticks, arrival);
            if (moment.device_time > newest_device) {
                ASSERT_GT(moment.host_time, newest_host);
                ASSERT_LE(moment.host_time, std::max(arrival, newest_host + 1));
                newest_device = moment.device_time;
                newest_host = moment.host_time;
            } else {
                ASSERT_LE(moment.host_time, newest_host);
            }
            if (random.chance(0.01)) clock.restart();
        }
    }
}

TEST(DeviceClock, AnHostClockThatStandsStillIsNoError) {
    DeviceClock clock(kRate, 32);
    Law law;
    for (int i = 0; i < 100; ++i) {
        law.rises(clock.at(static_cast<std::uint64_t>(i) * 2'000'000, 5), 5);
        if (HasFatalFailure()) return;
    }
}

}  // namespace
}  // namespace kino
