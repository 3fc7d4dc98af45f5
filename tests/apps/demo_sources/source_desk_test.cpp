#include "apps/demo_sources/source_desk.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "fake_sensor.h"
#include "skeleton/synthetic/synthetic_source.h"

namespace kino {
namespace {

using test::FakeSensor;
using test::runner_of;
using test::SensorWord;

constexpr TimeNs kPatience = 5 * kNsPerSecond;

std::size_t threads_now() {
    const std::filesystem::directory_iterator tasks("/proc/self/task");
    return static_cast<std::size_t>(std::distance(begin(tasks), end(tasks)));
}

/// A desk on a clock that the test moves by hand.
class SourceDeskTest : public testing::Test {
  protected:
    SourceDeskOptions options() {
        SourceDeskOptions out;
        out.open_live = [this]() -> Result<std::unique_ptr<LiveRunner>> {
            ++asked;
            if (!plugged_in) return fail("no sensor is plugged in");
            return runner_of(std::make_unique<FakeSensor>(sensor));
        };
        out.open_performance = [this]() -> Result<std::unique_ptr<LiveRunner>> {
            ++performances;
            auto source = SyntheticSource::create(make_scene(Motion::idle, 32, 24));
            KINO_CHECK(source.has_value());
            return runner_of(std::move(*source));
        };
        out.waits = true;
        out.look_every = 5 * kNsPerMs;
        return out;
    }
    void open(const SourceDeskOptions& wanted) {
        auto made = SourceDesk::create(wanted);
        ASSERT_TRUE(made) << made.error().to_string();
        desk = std::move(*made);
    }
    /// Steps with the clock at rest until `done`, or for too long.
    template <class Done>
    SourceDesk::Shown until(const Done& done) {
        const TimeNs began = now_ns();
        for (;;) {
            SourceDesk::Shown shown = desk->step(clock);
            cuts += shown.cut ? 1 : 0;
            if (done(shown)) return shown;
            if (now_ns() - began > kPatience) {
                ADD_FAILURE() << "it never came to that";
                return shown;
            }
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
    }
    SourceDesk::Shown until_mode(ShowMode mode) {
        return until([mode](const SourceDesk::Shown& shown) { return shown.mode == mode; });
    }
    SourceDesk::Shown until_frame() {
        return until([](const SourceDesk::Shown& shown) { return shown.fresh.has_value(); });
    }

    std::atomic<bool> plugged_in{false};
    std::atomic<int> asked{0};
    int performances = 0;
    int cuts = 0;
    std::shared_ptr<SensorWord> sensor = std::make_shared<SensorWord>();
    TimeNs clock = 0;
    std::unique_ptr<SourceDesk> desk;
};

TEST_F(SourceDeskTest, WithoutASensorThePerformanceIsPlayed) {
    open(options());
    const auto shown = until_frame();
    EXPECT_EQ(shown.mode, ShowMode::attract);
    EXPECT_EQ(shown.fresh->surface->depth_m.width(), 32);
    until([this](const auto&) { return desk->knows_of_none(); });
    EXPECT_FALSE(desk->has_sensor());
}

TEST_F(SourceDeskTest, ASensorThatIsPluggedInIsShown) {
    open(options());
    until_mode(ShowMode::attract);
    cuts = 0;
    plugged_in = true;
    until_mode(ShowMode::live);
    EXPECT_EQ(cuts, 1);
    EXPECT_EQ(until_frame().fresh->surface->depth_m.width(), 8);
    EXPECT_TRUE(desk->has_sensor());
    EXPECT_EQ(performances, 1);
}

TEST_F(SourceDeskTest, NobodyForTwentySecondsBringsThePerformanceAndSomebodyEndsIt) {
    plugged_in = true;
    open(options());
    until_mode(ShowMode::live);
    until_frame();
    clock += 20 * kNsPerSecond;
    EXPECT_EQ(desk->step(clock).mode, ShowMode::live);
    clock += kNsPerMs;
    EXPECT_EQ(until_mode(ShowMode::attract).mode, ShowMode::attract);
    EXPECT_EQ(until_frame().fresh->surface->depth_m.width(), 32);
    sensor->people = 1;
    until_mode(ShowMode::live);
    EXPECT_EQ(until_frame().fresh->surface->depth_m.width(), 8);
    // Somebody is there: however long.
    for (int i = 0; i < 5; ++i) {
        clock += 15 * kNsPerSecond;
        EXPECT_EQ(until_frame().mode, ShowMode::live);
    }
}

TEST_F(SourceDeskTest, AGlimpseOfSomebodyDoesNotEndIt) {
    plugged_in = true;
    SourceDeskOptions wanted = options();
    wanted.frames_to_return = 1'000'000;
    open(wanted);
    until_mode(ShowMode::live);
    clock += 21 * kNsPerSecond;
    until_mode(ShowMode::attract);
    sensor->people = 1;
    for (int i = 0; i < 20; ++i) {
        EXPECT_EQ(desk->step(clock).mode, ShowMode::attract);
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
}

TEST_F(SourceDeskTest, ALostSensorIsToldAndGoesOn) {
    plugged_in = true;
    sensor->people = 1;
    open(options());
    until_mode(ShowMode::live);
    until_frame();
    cuts = 0;
    sensor->present = false;
    EXPECT_FALSE(until_mode(ShowMode::lost).fresh.has_value());
    // It stays so, however long.
    clock += 100 * kNsPerSecond;
    EXPECT_EQ(desk->step(clock).mode, ShowMode::lost);
    sensor->present = true;
    until_mode(ShowMode::live);
    until_frame();
    // Those who played still do: nothing was cut.
    EXPECT_EQ(cuts, 0);
}

TEST_F(SourceDeskTest, LostWhileNobodyIsThereIsToldToo) {
    plugged_in = true;
    open(options());
    until_mode(ShowMode::live);
    clock += 21 * kNsPerSecond;
    until_mode(ShowMode::attract);
    sensor->present = false;
    until_mode(ShowMode::lost);
}

TEST_F(SourceDeskTest, WhatWasAskedForMustOpen) {
    SourceDeskOptions wanted = options();
    wanted.waits = false;
    const auto none = SourceDesk::create(wanted);
    ASSERT_FALSE(none);
    EXPECT_EQ(none.error().what, "no sensor is plugged in");
}

TEST_F(SourceDeskTest, ARecordingThatWasAskedForIsPlayedForEver) {
    SourceDeskOptions wanted = options();
    wanted.waits = false;
    wanted.open_live = wanted.open_performance;
    open(wanted);
    until_frame();
    clock += 100 * kNsPerSecond;
    EXPECT_EQ(until_frame().mode, ShowMode::live);
    EXPECT_EQ(performances, 1);
}

TEST_F(SourceDeskTest, WithoutASensorToWaitForThereIsOneThread) {
    const std::size_t before = threads_now();
    SourceDeskOptions wanted = options();
    wanted.waits = false;
    wanted.open_live = wanted.open_performance;
    open(wanted);
    until_frame();
    EXPECT_EQ(threads_now(), before + 1);
    EXPECT_EQ(asked, 0);
    desk.reset();
    EXPECT_EQ(threads_now(), before);
}

TEST_F(SourceDeskTest, ThePerformanceLeavesNothingBehind) {
    plugged_in = true;
    const std::size_t before = threads_now();
    open(options());
    until_mode(ShowMode::live);
    until_frame();
    // The sensor's own: the performance and the search are over.
    EXPECT_EQ(threads_now(), before + 1);
}

}  // namespace
}  // namespace kino
