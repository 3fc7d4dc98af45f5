#include "apps/pipeline/live_runner.h"

#include <gtest/gtest.h>

#include <atomic>
#include <memory>

#include "counting_source.h"

namespace kino {
namespace {

using test::CountingLog;
using test::CountingSource;
using test::kFrameTime;

/// Far longer than anything here takes; only a hang reaches it.
constexpr TimeNs kPatience = 20 * kNsPerSecond;

class LiveRunnerTest : public testing::Test {
  protected:
    void start(CountingSource::Options options, LoopMode mode) {
        auto opened = prepare_for_playing(std::make_unique<CountingSource>(std::move(options), log),
                                          {.mode = mode});
        ASSERT_TRUE(opened) << opened.error().to_string();
        runner = std::make_unique<LiveRunner>(
            std::move(*opened),
            LiveRunnerOptions{.clock = [clock = clock] { return clock->load(); }});
    }
    void advance(TimeNs time) { clock->fetch_add(time); }
    /// Until the runner has made `count` frames ready (or failed to).
    [[nodiscard]] bool wait_processed(std::int64_t count) const {
        const TimeNs until = now_ns() + kPatience;
        while (now_ns() < until) {
            const LiveStatus status = runner->status();
            if (status.processed + status.errors >= count) return true;
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
        return false;
    }
    [[nodiscard]] std::int64_t next_index() const {
        const auto frame = runner->wait(kPatience);
        return frame ? frame->set.index : -1;
    }
    static void let_it_look() { std::this_thread::sleep_for(std::chrono::milliseconds(20)); }

    std::shared_ptr<std::atomic<TimeNs>> clock = std::make_shared<std::atomic<TimeNs>>(1);
    std::shared_ptr<CountingLog> log = std::make_shared<CountingLog>();
    std::unique_ptr<LiveRunner> runner;
};

TEST_F(LiveRunnerTest, ShowsEveryFrameInOrderWhenThereIsTime) {
    start({.frames = 4}, LoopMode::loop);
    for (const std::int64_t expected : {0, 1, 2, 3, 0, 1}) {
        EXPECT_EQ(next_index(), expected);
        advance(kFrameTime);
    }
    EXPECT_EQ(runner->status().dropped, 0);
}

TEST_F(LiveRunnerTest, FrameHasTheDepthOfItsIndex) {
    start({.frames = 9}, LoopMode::loop);
    runner->seek(7);
    const TimeNs until = now_ns() + kPatience;
    std::optional<ProcessedFrame> frame;
    while (now_ns() < until && (!frame || frame->set.index != 7))
        frame = runner->wait(kNsPerSecond);
    ASSERT_TRUE(frame);
    ASSERT_EQ(frame->set.index, 7);
    EXPECT_FLOAT_EQ(frame->surface->depth_m.at(3, 3), 1.007f);
    EXPECT_EQ(frame->valid_points, 48);
}

TEST_F(LiveRunnerTest, PauseHoldsTheFrame) {
    start({}, LoopMode::loop);
    EXPECT_EQ(next_index(), 0);
    advance(kFrameTime);
    EXPECT_EQ(next_index(), 1);
    runner->pause();
    advance(50 * kFrameTime);
    let_it_look();
    EXPECT_FALSE(runner->take());
    EXPECT_EQ(runner->status().position, 1);
    EXPECT_TRUE(runner->status().paused);
    runner->resume();
    let_it_look();
    EXPECT_EQ(runner->status().position, 1);
    advance(kFrameTime);
    EXPECT_EQ(next_index(), 2);
}

TEST_F(LiveRunnerTest, StepsBothWays) {
    start({.frames = 5}, LoopMode::loop);
    EXPECT_EQ(next_index(), 0);
    runner->step(1);
    EXPECT_EQ(next_index(), 1);
    runner->step(1);
    EXPECT_EQ(next_index(), 2);
    runner->step(-1);
    EXPECT_EQ(next_index(), 1);
    runner->step(-1);
    EXPECT_EQ(next_index(), 0);
    runner->step(-1);
    EXPECT_EQ(next_index(), 4);
    EXPECT_EQ(runner->status().dropped, 0);
}

TEST_F(LiveRunnerTest, SeekIsExactForEveryFrame) {
    start({.frames = 12}, LoopMode::loop);
    runner->pause();
    EXPECT_EQ(next_index(), 0);
    for (const std::int64_t index : {11, 3, 4, 10, 1, 7, 0, 6, 2, 9, 5, 8}) {
        runner->seek(index);
        EXPECT_EQ(next_index(), index);
    }
    EXPECT_EQ(runner->status().dropped, 0);
}

TEST_F(LiveRunnerTest, NewestWinsAndTheOthersAreCounted) {
    start({.frames = 10}, LoopMode::loop);
    for (std::int64_t made = 1; made <= 4; ++made) {
        ASSERT_TRUE(wait_processed(made));
        if (made < 4) advance(kFrameTime);
    }
    EXPECT_EQ(next_index(), 3);
    EXPECT_EQ(runner->status().dropped, 3);
    EXPECT_FALSE(runner->take());
}

TEST_F(LiveRunnerTest, FramesThatTimeRanOverCountAsDropped) {
    start({.frames = 10}, LoopMode::loop);
    EXPECT_EQ(next_index(), 0);
    advance(5 * kFrameTime);
    EXPECT_EQ(next_index(), 5);
    EXPECT_EQ(runner->status().dropped, 4);
    advance(7 * kFrameTime);  // over the end of the loop: 6 7 8 9 0 1 are missed
    EXPECT_EQ(next_index(), 2);
    EXPECT_EQ(runner->status().dropped, 10);
}

TEST_F(LiveRunnerTest, UnreadableFramesAreCountedAndPlayingGoesOn) {
    start({.frames = 5, .unreadable = {1, 3}}, LoopMode::loop);
    EXPECT_EQ(next_index(), 0);
    advance(kFrameTime);
    ASSERT_TRUE(wait_processed(2));
    advance(kFrameTime);
    EXPECT_EQ(next_index(), 2);
    const LiveStatus status = runner->status();
    EXPECT_EQ(status.errors, 1);
    EXPECT_NE(status.last_error.find("unreadable"), std::string::npos);
}

TEST_F(LiveRunnerTest, OnceFinishesAndResumeStartsOver) {
    start({.frames = 3}, LoopMode::once);
    EXPECT_EQ(next_index(), 0);
    advance(10 * kFrameTime);
    EXPECT_EQ(next_index(), 2);
    EXPECT_TRUE(runner->status().finished);
    runner->resume();
    EXPECT_EQ(next_index(), 0);
    EXPECT_FALSE(runner->status().finished);
}

TEST_F(LiveRunnerTest, SpeedChangesWhatIsDue) {
    start({.frames = 10}, LoopMode::loop);
    EXPECT_EQ(next_index(), 0);
    runner->set_speed(2);
    advance(kFrameTime);
    EXPECT_EQ(next_index(), 2);
}

TEST_F(LiveRunnerTest, StopsInTheMiddleOfReading) {
    start({.frames = 1000, .reading_time = 30 * kNsPerMs}, LoopMode::loop);
    const TimeNs until = now_ns() + kPatience;
    while (log->reads == 0 && now_ns() < until) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    advance(kFrameTime);
    runner->stop();
    const int reads = log->reads;
    runner->stop();
    advance(kFrameTime);
    let_it_look();
    EXPECT_EQ(log->reads, reads);
    // Nothing comes any more, and nobody waits for it.
    while (runner->take()) {
    }
    EXPECT_FALSE(runner->wait(kPatience));
}

TEST_F(LiveRunnerTest, CommandsFromTheRenderThreadWhileFramesFlow) {
    start({.frames = 50}, LoopMode::ping_pong);
    std::int64_t taken = 0;
    for (int i = 0; i < 300; ++i) {
        advance(kFrameTime / 3);
        if (i % 7 == 0) runner->seek(i % 50);
        if (i % 11 == 0) runner->set_speed(1 + i % 3);
        if (i % 13 == 0) runner->step(i % 2 == 0 ? 1 : -1);
        if (i % 17 == 0) runner->set_mode(LoopMode::loop);
        if (i % 5 == 0) runner->resume();
        if (const auto frame = runner->take()) {
            ++taken;
            EXPECT_FLOAT_EQ(frame->surface->depth_m.at(0, 0),
                            static_cast<float>(1000 + frame->set.index) * 0.001f);
        }
        (void)runner->status();
    }
    ASSERT_TRUE(wait_processed(1));
    taken += runner->take().has_value() ? 1 : 0;
    EXPECT_GT(taken, 0);
}

TEST_F(LiveRunnerTest, SourceWithoutTimelineDeliversInOrderAndEnds) {
    start({.frames = 5, .with_timeline = false}, LoopMode::loop);
    const TimeNs until = now_ns() + kPatience;
    std::int64_t last = -1;
    while (!runner->status().finished && now_ns() < until) {
        if (const auto frame = runner->take()) {
            EXPECT_GT(frame->set.index, last);
            last = frame->set.index;
        }
    }
    if (const auto frame = runner->take()) last = frame->set.index;
    EXPECT_EQ(last, 4);
    EXPECT_TRUE(runner->status().finished);
    EXPECT_EQ(runner->status().processed, 5);
}

}  // namespace
}  // namespace kino
