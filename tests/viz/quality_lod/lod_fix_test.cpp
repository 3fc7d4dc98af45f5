#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <set>

#include "tests/support/random.h"
#include "tests/viz/quality_lod/lod_rig.h"
#include "tests/viz/viz_fixture.h"
#include "viz/quality/framebuffer_lod.h"

namespace kino::test {
namespace {

using testing::ElementsAre;
using testing::IsSupersetOf;

class LodFix : public VizTest {
  protected:
    static LodRig& rig() {
        static auto* made = new LodRig(device());  // leaked, as the device is
        return *made;
    }
};

/// Depths and normals that change every few pixels.
LodScene patched_scene(int width, int height, std::uint64_t seed, bool objects) {
    Random random(seed);
    LodScene scene = plain_scene(width, height);
    if (objects) scene.object = Image<std::uint32_t>(width, height, 5);
    double z = 2;
    glm::dvec3 normal(0, 0, -1);
    for (std::size_t i = 0; i < scene.z.size(); ++i) {
        if (random.chance(0.15)) z = random.chance(0.7) ? 2 : random.real(1.8, 2.3);
        if (random.chance(0.1)) {
            normal = glm::normalize(glm::dvec3(random.real(-0.3, 0.3), random.real(-0.3, 0.3), -1));
        }
        scene.z.pixels()[i] = static_cast<float>(z);
        scene.normal.pixels()[i] = packed_normal(normal);
        if (random.chance(0.02)) scene.albedo.pixels()[i].a = 0;
        if (random.chance(0.02)) scene.z.pixels()[i] = 0;
        if (objects && random.chance(0.1)) scene.object.pixels()[i] = 9;
    }
    return scene;
}

const LodShading kGrey = [](int, int, const glm::vec3& albedo) {
    return glm::vec4(0.5f * albedo, 1);
};

std::uint32_t word_of(int x, int y) {
    return static_cast<std::uint32_t>(y) << 16 | static_cast<std::uint32_t>(x);
}

// Exactly the pixels whose confidence in double precision is below the limit, in order.
TEST_F(LodFix, ListsEveryDoubtfulPixelAndNoOther) {
    std::uint64_t seed = 1;
    for (const LodFormat format : {LodFormat::packed, LodFormat::wide}) {
        for (const RangeMetric metric :
             {RangeMetric::depth, RangeMetric::log_depth, RangeMetric::plane}) {
            const LodScene scene = patched_scene(203, 151, seed, seed % 2 == 0);
            ++seed;
            FramebufferLodOptions options{.r = 2.7, .metric = metric, .format = format};
            options.flat_tolerance = 0;
            options.fix_share = 1;
            const LodResult result = rig().run(scene, options, kGrey);
            Image<double> bits;
            (void)lod_reference_picture(scene, result, options, &bits);
            const std::set<std::uint32_t> listed(result.fixed.begin(), result.fixed.end());
            EXPECT_EQ(listed.size(), result.fixed.size());
            EXPECT_TRUE(std::is_sorted(result.fixed.begin(), result.fixed.end()));
            EXPECT_EQ(result.fix.failed, result.fix.count);
            // 0.05 is between the steps 16 and 17; rounding to steps begins at 16.5.
            const double limit = 16.5;
            int wrong = 0;
            int doubtful = 0;
            for (int y = 0; y < 151; ++y) {
                for (int x = 0; x < 203; ++x) {
                    const double steps = 8 * std::sqrt(std::max(bits.at(x, y), 0.0));
                    if (std::abs(steps - limit) < 0.05) continue;  // too near to call in floats
                    doubtful += steps > limit;
                    wrong += (steps > limit) != listed.contains(word_of(x, y));
                }
            }
            EXPECT_EQ(wrong, 0) << "metric " << static_cast<int>(metric);
            EXPECT_GT(doubtful, 500);
            EXPECT_LT(doubtful, 203 * 151 / 2);
        }
    }
}

/// A wire one pixel wide that no coarse texel sees, before a plane.
LodScene wire_scene(int at) {
    LodScene scene = plain_scene(320, 240);
    for (int y = 0; y < 240; ++y) {
        scene.z.at(at, y) = 0.5f;
        scene.normal.at(at, y) = packed_normal({0.9, 0, -0.4});
    }
    return scene;
}

// Its tiles are flat for all that the coarse picture knows.
TEST_F(LodFix, FlatTilesAreCheckedToo) {
    for (const bool objects : {false, true}) {
        LodScene scene = wire_scene(120);
        if (objects) {
            // Told apart by number alone.
            scene = plain_scene(320, 240);
            scene.object = Image<std::uint32_t>(320, 240, 5);
            for (int y = 0; y < 240; ++y) scene.object.at(120, y) = 6;
        }
        const LodResult result = rig().run(scene, {.r = 5, .fix_share = 0.05f}, kGrey);
        std::vector<std::uint32_t> wire;
        for (int y = 0; y < 240; ++y) wire.push_back(word_of(120, y));
        EXPECT_EQ(result.fixed, wire);
    }
}

TEST_F(LodFix, ListIsNeverLongerThanItsCapAndTakesTheWorstFirst) {
    LodScene scene = patched_scene(320, 240, 9, false);
    FramebufferLodOptions options{.r = 4, .flat_tolerance = 0, .fix_share = 1};
    const LodResult whole = rig().run(scene, options, kGrey);
    ASSERT_GT(whole.fix.failed, 3000u);
    Image<double> bits;
    (void)lod_reference_picture(scene, whole, options, &bits);
    for (const float share : {0.03f, 0.01f, 0.002f, 1e-9f}) {
        options.fix_share = share;
        const LodResult some = rig().run(scene, options, kGrey);
        const auto cap = std::max(1u, static_cast<std::uint32_t>(share * 320 * 240));
        EXPECT_EQ(some.fix.failed, whole.fix.failed);
        EXPECT_LE(some.fixed.size(), cap);
        EXPECT_TRUE(cap < 100 || 20 * some.fixed.size() > 17 * cap) << some.fixed.size();
        EXPECT_THAT(whole.fixed, IsSupersetOf(some.fixed));
        EXPECT_EQ(rig().run(scene, options, kGrey).fixed, some.fixed) << "the same every time";
        if (cap < 100) continue;
        // What was left out is not more doubtful than what is in, and the list is from everywhere.
        const std::set<std::uint32_t> in(some.fixed.begin(), some.fixed.end());
        double least_in = 1e9;
        for (const std::uint32_t p : some.fixed) {
            least_in = std::min(least_in, bits.at(static_cast<int>(p & 0xFFFF), p >> 16));
        }
        const double step = 0.1 + 8 * std::sqrt(std::min(least_in, 62.0));
        for (const std::uint32_t p : whole.fixed) {
            if (in.contains(p)) continue;
            const double left_out = bits.at(static_cast<int>(p & 0xFFFF), p >> 16);
            EXPECT_LE(8 * std::sqrt(std::min(left_out, 62.0)), step + 1);
        }
        EXPECT_LT(some.fixed.front() >> 16, 24u);
        EXPECT_GT(some.fixed.back() >> 16, 215u);
    }
}

TEST_F(LodFix, OffItIsNothing) {
    const LodScene scene = patched_scene(150, 112, 4, false);
    LodRig fresh(device());
    EXPECT_THAT(fresh.run(scene, {}, kGrey).passes,
                ElementsAre("lod/pick", "lod/pack", "lod/classify", "lod/runs", "lod/up"));
    EXPECT_THAT(fresh.pipelines().names(),
                testing::Each(testing::Not(testing::AnyOf(testing::StartsWith("lod/fix"),
                                                          testing::HasSubstr("checked")))));
    EXPECT_THAT(fresh.run(scene, {.fix_share = 0.05f}, kGrey).passes,
                ElementsAre("lod/pick", "lod/pack", "lod/classify", "lod/runs", "lod/up",
                            "lod/fix clear", "lod/fix count", "lod/fix cut", "lod/fix recount",
                            "lod/fix places", "lod/fix list"));
    // Bilinear resizing has no confidence; at full size there is nothing to doubt.
    EXPECT_EQ(
        fresh.run(scene, {.reconstruction = Reconstruction::bilinear, .fix_share = 0.05f}, kGrey)
            .fix.groups_y,
        0u);
    EXPECT_TRUE(fresh.run(scene, {.r = 1, .fix_share = 0.05f}, kGrey).direct);
}

// A list for a picture that is flawless is empty, and its dispatch has no group.
TEST_F(LodFix, SurePicturesHaveAnEmptyList) {
    const LodResult result = rig().run(plain_scene(130, 98), {.r = 2, .fix_share = 0.05f}, kGrey);
    EXPECT_EQ(result.fix.count, 0u);
    EXPECT_EQ(result.fix.failed, 0u);
    EXPECT_EQ(result.fix.groups_x, 0u);
}

}  // namespace
}  // namespace kino::test
