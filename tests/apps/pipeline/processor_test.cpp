#include "apps/pipeline/processor.h"

#include <gtest/gtest.h>

#include <set>
#include <thread>

#include "apps/pipeline/time_series.h"
#include "counting_source.h"

namespace kino {
namespace {

using test::CountingSource;

/// The frames of a counting source, one after the other.
struct Bench {
    explicit Bench(CountingSource::Options options)
        : source(std::move(options)), processor(*Processor::create(*source.calibration())) {}
    Result<ProcessedFrame> next() { return processor.process(std::move(**source.next(0))); }

    CountingSource source;
    Processor processor;
};

TEST(Processor, DepthOnlyLeavesColourEmpty) {
    Bench bench({.with_color = false});
    const auto frame = bench.next();
    ASSERT_TRUE(frame);
    EXPECT_TRUE(frame->surface->color.empty());
    EXPECT_EQ(frame->color, nullptr);
    EXPECT_FLOAT_EQ(frame->surface->depth_m.at(0, 0), 1.0f);
    EXPECT_EQ(frame->surface->rays->width(), 8);
    EXPECT_DOUBLE_EQ(frame->surface->focal_px, 8);
}

TEST(Processor, ColourWithoutPartnerIsTheLastOneDimmed) {
    Bench bench({.with_color = true, .without_color = {1}});
    const auto paired = bench.next();
    const auto alone = bench.next();
    const auto again = bench.next();
    ASSERT_TRUE(paired && alone && again);
    const auto at = [](const Result<ProcessedFrame>& frame) {
        return frame->surface->color.at(4, 3);
    };
    EXPECT_EQ(at(paired), (Rgba8{200, 200, 200, 255}));
    EXPECT_EQ(at(alone), (Rgba8{100, 100, 100, 255}));
    EXPECT_EQ(at(again), (Rgba8{200, 200, 200, 255}));
    // The picture itself is shown as it was.
    EXPECT_EQ(alone->color, paired->color);
}

TEST(Processor, NoColourYetMeansNone) {
    Bench bench({.with_color = true, .without_color = {0, 2}});
    EXPECT_TRUE(bench.next()->surface->color.empty());
    EXPECT_FALSE(bench.next()->surface->color.empty());
    bench.processor.forget();
    EXPECT_TRUE(bench.next()->surface->color.empty());
}

TEST(Processor, VersionsDiffer) {
    Bench one({});
    Bench two({});
    std::set<std::uint64_t> seen;
    for (int i = 0; i < 4; ++i) {
        seen.insert(one.next()->version);
        seen.insert(two.next()->version);
    }
    EXPECT_EQ(seen.size(), 8u);
}

TEST(Processor, MemoryIsUsedAgainOnceNobodyHoldsIt) {
    Bench bench({.frames = 40, .with_color = true});
    std::set<const float*> depth;
    std::set<const Rgba8*> color;
    Result<ProcessedFrame> held = bench.next();
    for (int i = 1; i < 40; ++i) {
        // As a viewer does: the old frame is let go when the new one is there.
        held = bench.next();
        ASSERT_TRUE(held);
        depth.insert(held->surface->depth_m.data());
        color.insert(held->surface->color.data());
    }
    EXPECT_LE(depth.size(), 3u);
    EXPECT_LE(color.size(), 2u);
}

TEST(Processor, AFrameThatIsHeldIsNotOverwritten) {
    Bench bench({.frames = 20});
    const auto held = bench.next();
    for (int i = 1; i < 20; ++i) ASSERT_TRUE(bench.next());
    EXPECT_FLOAT_EQ(held->surface->depth_m.at(5, 5), 1.0f);
}

TEST(Processor, AWrongFrameIsAnErrorAndTheNextOneIsFine) {
    Bench bench({});
    EXPECT_FALSE(bench.processor.process(FrameSet{}));
    FrameSet wrong;
    auto depth = std::make_shared<DepthFrame>();
    depth->raw = Image<std::uint16_t>(5, 5, 1000);
    wrong.depth = depth;
    EXPECT_FALSE(bench.processor.process(wrong));
    const auto frame = bench.next();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->valid_points, 48);
}

TEST(RecyclingPool, ObjectsComeBackFromOtherThreadsAndOutliveThePool) {
    std::shared_ptr<int> survivor;
    {
        RecyclingPool<int> pool;
        survivor = pool.take();
        *survivor = 7;
        for (int i = 0; i < 100; ++i) {
            auto item = pool.take();
            *item = i;
            std::thread([moved = std::move(item)]() mutable { moved.reset(); }).join();
        }
        EXPECT_EQ(pool.idle(), 1u);
    }
    EXPECT_EQ(*survivor, 7);
}

TEST(TimeSeries, QuantilesAreNearestRank) {
    TimeSeries times;
    EXPECT_EQ(times.median_ms(), 0);
    for (int i = 100; i >= 1; --i) times.add(i * kNsPerMs);
    EXPECT_DOUBLE_EQ(times.median_ms(), 50);
    EXPECT_DOUBLE_EQ(times.p95_ms(), 95);
    EXPECT_DOUBLE_EQ(times.quantile_ms(0), 1);
    EXPECT_DOUBLE_EQ(times.quantile_ms(1), 100);
}

}  // namespace
}  // namespace kino
