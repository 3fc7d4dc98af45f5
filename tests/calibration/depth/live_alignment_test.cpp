#include "calibration/live_alignment.h"

#include <gmock/gmock.h>

#include <cmath>

#include "tests/support/random.h"

namespace kino {
namespace {

using testing::HasSubstr;

// A dark box before a bright wall; the colour camera is the depth camera, and its picture has slid.
struct SlidScene {
    RigParameters rig = default_kinect1_rig(320, 240);
    Image<float> depth{320, 240, 2.5f};
    Image<Rgba8> color{320, 240};
    Image<RayXy> rays;

    SlidScene(int dx, int dy, std::uint64_t seed = 3) {
        rig.color = rig.depth;
        rig.color_from_depth = {};
        auto alone = rig;
        alone.color.reset();
        rays = Rig::create(alone)->depth_rays();
        test::Random random(seed);
        const auto in = [](int x, int y) { return x >= 80 && x < 220 && y >= 60 && y < 180; };
        for (int y = 0; y < 240; ++y) {
            for (int x = 0; x < 320; ++x) {
                if (in(x, y)) depth.at(x, y) = 1.2f;
                const int level = (in(x - dx, y - dy) ? 60 : 190) + random.integer(-8, 8);
                const auto v = static_cast<std::uint8_t>(level);
                color.at(x, y) = {v, v, v, 255};
            }
        }
    }
    std::optional<LiveAlignment::Figure> look() const {
        LiveAlignment alignment;
        return alignment.look_now(depth, rays, color, rig);
    }
};

TEST(LiveAlignment, FindsHowFarColourHasSlid) {
    for (const auto& [dx, dy] : {std::pair(0, 0), std::pair(5, -3), std::pair(-7, 2),
                                 std::pair(1, 1), std::pair(8, 8), std::pair(-9, -4)}) {
        const auto found = SlidScene(dx, dy).look();
        ASSERT_TRUE(found);
        EXPECT_NEAR(found->dx_px, dx, 0.7) << dx << ' ' << dy;
        EXPECT_NEAR(found->dy_px, dy, 0.7) << dx << ' ' << dy;
        EXPECT_GT(found->sharpness, 2.5);
    }
}

TEST(LiveAlignment, LooksAtEveryNthFrameAndTakesTheMedian) {
    LiveAlignment alignment;
    const SlidScene good(0, 0);
    const SlidScene slid(6, 0);
    const auto feed = [&](const SlidScene& scene, int frames) {
        for (int i = 0; i < frames; ++i) {
            alignment.look(scene.depth, scene.rays, scene.color, scene.rig);
        }
    };
    feed(good, 2 * LiveAlignment::kEvery);
    EXPECT_FALSE(alignment.figure());
    EXPECT_EQ(alignment.words(), "");
    feed(good, LiveAlignment::kEvery);
    ASSERT_TRUE(alignment.figure());
    EXPECT_EQ(alignment.figure()->looks, 3);
    EXPECT_THAT(alignment.words(), HasSubstr("good"));
    // One frame in which something moved does not matter.
    feed(slid, LiveAlignment::kEvery);
    EXPECT_THAT(alignment.words(), HasSubstr("good"));
    feed(slid, LiveAlignment::kLooks * LiveAlignment::kEvery);
    EXPECT_EQ(alignment.figure()->looks, LiveAlignment::kLooks);
    EXPECT_NEAR(alignment.figure()->dx_px, 6, 0.7);
    EXPECT_THAT(alignment.words(), HasSubstr("slid"));
    alignment.reset();
    EXPECT_FALSE(alignment.figure());
}

TEST(LiveAlignment, SaysNothingWhereNothingIsToBeSeen) {
    SlidScene flat(0, 0);
    flat.depth = Image<float>(320, 240, 2.0f);
    EXPECT_FALSE(flat.look());
    SlidScene depth_only(0, 0);
    depth_only.rig.color.reset();
    EXPECT_FALSE(depth_only.look());
    SlidScene other_size(0, 0);
    other_size.color = Image<Rgba8>(160, 120);
    EXPECT_FALSE(other_size.look());
    // A colour picture without any contour does not make a figure.
    SlidScene grey(0, 0);
    grey.color = Image<Rgba8>(320, 240, {90, 90, 90, 255});
    LiveAlignment alignment;
    for (int i = 0; i < 6 * LiveAlignment::kEvery; ++i) {
        alignment.look(grey.depth, grey.rays, grey.color, grey.rig);
    }
    EXPECT_FALSE(alignment.figure());
}

}  // namespace
}  // namespace kino
