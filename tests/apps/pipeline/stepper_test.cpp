#include "apps/pipeline/stepper.h"

#include <gtest/gtest.h>

#include <vector>

#include "counting_source.h"

namespace kino {
namespace {

using test::CountingLog;
using test::CountingSource;

Stepper make(CountingSource::Options options, LoopMode mode,
             std::shared_ptr<CountingLog> log = std::make_shared<CountingLog>()) {
    auto opened = prepare_for_playing(
        std::make_unique<CountingSource>(std::move(options), std::move(log)), {.mode = mode});
    KINO_CHECK(opened.has_value());
    return Stepper(std::move(*opened));
}

/// Indices of the next `count` frames; -1 the end, -2 an error.
std::vector<std::int64_t> indices(Stepper& stepper, int count) {
    std::vector<std::int64_t> out;
    for (int i = 0; i < count; ++i) {
        const auto frame = stepper.next();
        out.push_back(!frame ? -2 : !*frame ? -1 : (*frame)->set.index);
    }
    return out;
}

using Indices = std::vector<std::int64_t>;

TEST(Stepper, PlaysInTheOrderOfTheMode) {
    Stepper once = make({.frames = 3}, LoopMode::once);
    EXPECT_EQ(indices(once, 5), (Indices{0, 1, 2, -1, -1}));
    Stepper loop = make({.frames = 3}, LoopMode::loop);
    EXPECT_EQ(indices(loop, 7), (Indices{0, 1, 2, 0, 1, 2, 0}));
    Stepper ping_pong = make({.frames = 4}, LoopMode::ping_pong);
    EXPECT_EQ(indices(ping_pong, 9), (Indices{0, 1, 2, 3, 2, 1, 0, 1, 2}));
    EXPECT_EQ(ping_pong.round(), 6);
}

TEST(Stepper, AnErrorConcernsOneFrame) {
    Stepper stepper = make({.frames = 4, .unreadable = {0, 2}}, LoopMode::loop);
    EXPECT_EQ(indices(stepper, 6), (Indices{-2, 1, -2, 3, -2, 1}));
}

TEST(Stepper, APictureAloneInItsLoopIsReadOnce) {
    auto log = std::make_shared<CountingLog>();
    Stepper stepper = make({.frames = 1}, LoopMode::loop, log);
    EXPECT_EQ(indices(stepper, 4), (Indices{0, 0, 0, 0}));
    EXPECT_EQ(log->reads, 1);
}

TEST(Stepper, WithoutTimelineItEndsWithTheSource) {
    Stepper stepper = make({.frames = 2, .with_timeline = false}, LoopMode::loop);
    EXPECT_EQ(indices(stepper, 4), (Indices{0, 1, -1, -1}));
}

TEST(Stepper, TwoRunsGiveTheSameBits) {
    const auto run = [] {
        Stepper stepper = make({.frames = 6, .with_color = true, .without_color = {0, 2, 3}},
                               LoopMode::ping_pong);
        std::vector<std::pair<Image<float>, Image<Rgba8>>> frames;
        for (int i = 0; i < 14; ++i) {
            const auto frame = stepper.next();
            frames.emplace_back((*frame)->surface->depth_m, (*frame)->surface->color);
        }
        return frames;
    };
    EXPECT_TRUE(run() == run());
}

}  // namespace
}  // namespace kino
