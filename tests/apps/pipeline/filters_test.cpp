#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/pipeline/opened_source.h"
#include "counting_source.h"

namespace kino {
namespace {

using test::CountingSource;

Result<OpenedSource> open(const std::string& filters, CountingSource::Options options = {}) {
    return prepare_for_playing(std::make_unique<CountingSource>(std::move(options)),
                               {.filters = filters});
}

TEST(Filters, UnknownOnesAreNamed) {
    const auto opened = open("flying,rainbow");
    ASSERT_FALSE(opened);
    EXPECT_THAT(opened.error().to_string(), testing::HasSubstr("rainbow"));
}

TEST(Filters, ConstantDepthComesThroughAsItWas) {
    auto plain = open("");
    auto filtered = open("flying,spatial,temporal,holes");
    ASSERT_TRUE(plain && filtered);
    // Nothing asked for, nothing there; and what was asked for is at work.
    EXPECT_TRUE(plain->processor.filters().empty());
    EXPECT_FALSE(filtered->processor.filters().empty());
    for (int i = 0; i < 3; ++i) {
        const auto a = read_frame(*plain, {}, 0);
        const auto b = read_frame(*filtered, {}, 0);
        ASSERT_TRUE(a && *a && b && *b);
        // The frame's own raw depth is not touched: it is what is recorded.
        EXPECT_EQ((*b)->set.depth->raw.at(2, 2), 1000 + i);
        EXPECT_NEAR((*b)->surface->depth_m.at(4, 3), (*a)->surface->depth_m.at(4, 3), 1.5e-3);
    }
}

TEST(Filters, DecimationMakesASmallerSurfaceSeenByItsOwnCamera) {
    auto opened = open("decimate:factor=2", {.with_color = true});
    ASSERT_TRUE(opened) << opened.error().to_string();
    const auto frame = read_frame(*opened, {}, 0);
    ASSERT_TRUE(frame && *frame) << frame.error().to_string();
    const DepthSurface& surface = *(*frame)->surface;
    EXPECT_EQ(surface.depth_m.width(), 4);
    EXPECT_EQ(surface.depth_m.height(), 3);
    EXPECT_EQ(surface.color.width(), 4);
    EXPECT_NEAR(surface.focal_px, 4, 1e-9);
    // The picture's corners look where the full one's corner blocks look.
    EXPECT_NEAR(surface.rays->at(0, 0).x, (0.5 - 3.5) / 8, 1e-6);
    EXPECT_NEAR(surface.depth_m.at(1, 1), 1.0f, 1e-3f);
}

TEST(Filters, AJumpForgetsWhatWasSeen) {
    auto opened = open("temporal:alpha=0.01", {.frames = 100});
    ASSERT_TRUE(opened);
    for (int i = 0; i < 10; ++i) ASSERT_TRUE(read_frame(*opened, i, 0));
    const auto frame = read_frame(*opened, 99, 0);
    ASSERT_TRUE(frame && *frame);
    EXPECT_NEAR((*frame)->surface->depth_m.at(3, 3), 1.099f, 2e-4f);
}

}  // namespace
}  // namespace kino
