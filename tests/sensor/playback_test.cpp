#include "sensor/playback.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace kino {
namespace {

constexpr TimeNs kStart = 123'456'789;

std::vector<TimeNs> uneven_times(std::size_t count, unsigned seed) {
    std::mt19937 random(seed);
    std::vector<TimeNs> times = {0};
    while (times.size() < count) times.push_back(times.back() + 1000 + random() % 100000);
    return times;
}

std::int64_t frame_at(const std::vector<TimeNs>& times, double media) {
    std::int64_t index = 0;
    for (std::size_t i = 0; i < times.size(); ++i) {
        if (static_cast<double>(times[i]) <= media) index = static_cast<std::int64_t>(i);
    }
    return index;
}

TEST(Playback, SpeedSShowsTheFrameOfSTimesT) {
    const auto times = uneven_times(40, 1);
    for (const double speed : {0.1, 0.5, 1.0, 2.0, 8.0}) {
        Playback playback(times, 5000, LoopMode::once, kStart);
        playback.set_speed(speed, kStart);
        for (TimeNs t = 0; t < 3'000'000; t += 777) {
            EXPECT_EQ(playback.due(kStart + t),
                      frame_at(times, std::floor(static_cast<double>(t) * speed)));
        }
    }
}

TEST(Playback, SpeedIsKeptInItsRange) {
    Playback playback({0, 10}, 10, LoopMode::loop, 0);
    playback.set_speed(100, 0);
    EXPECT_EQ(playback.speed(), 8);
    playback.set_speed(-3, 0);
    EXPECT_EQ(playback.speed(), 0.1);
    playback.set_speed(std::nan(""), 0);
    EXPECT_EQ(playback.speed(), 1);
}

TEST(Playback, ChangingTheSpeedMovesNothing) {
    const auto times = uneven_times(30, 2);
    Playback playback(times, 1000, LoopMode::loop, 0);
    const TimeNs now = 700'000;
    const auto before = playback.due(now);
    playback.set_speed(4, now);
    EXPECT_EQ(playback.due(now), before);
}

TEST(Playback, LoopRepeatsWithThePeriod) {
    const std::vector<TimeNs> times = {0, 30, 50};
    const Playback playback(times, 20, LoopMode::loop, kStart);
    for (TimeNs t = 0; t < 70; ++t) {
        EXPECT_EQ(playback.due(kStart + t), frame_at(times, static_cast<double>(t)));
        EXPECT_EQ(playback.due(kStart + t + 70 * 12345), playback.due(kStart + t));
    }
}

TEST(Playback, PingPongDoesNotRepeatTheEnds) {
    for (const std::size_t n : {1u, 2u, 3u, 6u}) {
        std::vector<TimeNs> times;
        for (std::size_t i = 0; i < n; ++i) times.push_back(static_cast<TimeNs>(i) * 10);
        const Playback playback(times, 10, LoopMode::ping_pong, 0);
        std::int64_t expected = 0;
        std::int64_t direction = 1;
        for (TimeNs t = 5; t < 500; t += 10) {
            EXPECT_EQ(playback.due(t), expected) << n << " frames at " << t;
            if (n == 1) continue;
            if (expected + direction < 0 || expected + direction >= static_cast<std::int64_t>(n)) {
                direction = -direction;
            }
            expected += direction;
        }
    }
}

TEST(Playback, OnceStopsOnTheLastFrameAndStartsOver) {
    Playback playback({0, 10, 20}, 10, LoopMode::once, 0);
    EXPECT_FALSE(playback.finished(29));
    EXPECT_TRUE(playback.finished(30));
    EXPECT_EQ(playback.due(1'000'000), 2);
    playback.resume(2'000'000);
    EXPECT_EQ(playback.due(2'000'000), 0);
    EXPECT_EQ(playback.due(2'000'015), 1);
}

TEST(Playback, AStepAndItsOppositeCancel) {
    for (const LoopMode mode : {LoopMode::once, LoopMode::loop, LoopMode::ping_pong}) {
        for (const std::size_t n : {1u, 2u, 5u}) {
            Playback playback(uneven_times(n, 3), 1000, mode, 0);
            std::mt19937 random(9);
            for (int i = 0; i < 200; ++i) {
                const TimeNs now = i * 50;
                const auto before = playback.due(now);
                const int direction = random() % 2 == 0 ? 1 : -1;
                if (playback.step(direction, now)) {
                    if (n > 2) {
                        EXPECT_NE(playback.due(now), before);
                    }
                    EXPECT_TRUE(playback.step(-direction, now));
                }
                EXPECT_EQ(playback.due(now), before);
                playback.step(1, now);
            }
        }
    }
}

TEST(Playback, StepPausesAndStopsAtTheEndsOfOnce) {
    Playback playback({0, 10, 20}, 10, LoopMode::once, 0);
    EXPECT_FALSE(playback.step(-1, 0));
    EXPECT_TRUE(playback.paused());
    EXPECT_TRUE(playback.step(1, 0));
    EXPECT_TRUE(playback.step(1, 0));
    EXPECT_FALSE(playback.step(1, 0));
    EXPECT_EQ(playback.due(1'000'000), 2);
}

TEST(Playback, SeekIsExactWhateverCameBefore) {
    for (const LoopMode mode : {LoopMode::once, LoopMode::loop, LoopMode::ping_pong}) {
        const auto times = uneven_times(20, 4);
        Playback playback(times, 1000, mode, 0);
        std::mt19937 random(5);
        TimeNs now = 0;
        for (int i = 0; i < 300; ++i) {
            now += random() % 1'000'000;
            const auto index = static_cast<std::int64_t>(random() % 20);
            if (random() % 4 == 0) playback.pause(now);
            if (random() % 4 == 0) playback.resume(now);
            playback.seek(index, now);
            EXPECT_EQ(playback.due(now), index);
        }
        playback.seek(99, now);
        EXPECT_EQ(playback.due(now), 19);
        playback.seek(-1, now);
        EXPECT_EQ(playback.due(now), 0);
    }
}

TEST(Playback, PauseHoldsAndResumeGoesOnFromThere) {
    const auto times = uneven_times(50, 6);
    Playback stopped(times, 1000, LoopMode::loop, 0);
    const Playback running(times, 1000, LoopMode::loop, 0);
    stopped.pause(300'000);
    EXPECT_EQ(stopped.due(9'000'000), running.due(300'000));
    stopped.resume(9'000'000);
    for (TimeNs t = 0; t < 2'000'000; t += 999) {
        EXPECT_EQ(stopped.due(9'000'000 + t), running.due(300'000 + t));
    }
}

TEST(Playback, ChangingTheModeKeepsTheFrame) {
    Playback playback(uneven_times(7, 8), 1000, LoopMode::loop, 0);
    std::mt19937 random(3);
    TimeNs now = 0;
    for (int i = 0; i < 300; ++i) {
        now += random() % 90'000;
        const auto before = playback.due(now);
        playback.set_mode(static_cast<LoopMode>(random() % 3), now);
        EXPECT_EQ(playback.due(now), before);
        if (playback.finished(now)) playback.resume(now);
    }
}

TEST(Playback, AHostClockThatRunsBackStandsStill) {
    const Playback playback({0, 10, 20}, 10, LoopMode::loop, kStart);
    EXPECT_EQ(playback.due(kStart - 1'000'000), 0);
}

TEST(Playback, OneFrameWorksInEveryMode) {
    for (const LoopMode mode : {LoopMode::once, LoopMode::loop, LoopMode::ping_pong}) {
        Playback playback({0}, 10, mode, 0);
        EXPECT_EQ(playback.due(0), 0);
        EXPECT_EQ(playback.due(12345), 0);
        EXPECT_FALSE(playback.step(1, 5));
        EXPECT_FALSE(playback.step(-1, 5));
        playback.seek(0, 6);
        EXPECT_EQ(playback.due(6), 0);
    }
}

}  // namespace
}  // namespace kino
