#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numeric>

#include "tests/support/random.h"
#include "tests/viz/lights/light_rig.h"
#include "tests/viz/lights/light_scenes.h"
#include "tests/viz/viz_fixture.h"

namespace kino::test {
namespace {

using ::testing::Each;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr int kWidth = 79;  // no multiple of a tile
constexpr int kHeight = 61;

class LightListsTest : public VizTest {
  protected:
    /// One for all tests: pipelines take longer than pictures.
    static LightRig& rig() {
        static auto* made = new LightRig(device());
        return *made;
    }
    static LightRig::Drawn draw(const LitScene& lit, const LightRig::Options& options) {
        auto drawn = rig().draw(lit.scene, lit.view, options);
        EXPECT_TRUE(drawn) << (drawn ? "" : drawn.error().to_string());
        return drawn ? std::move(*drawn) : LightRig::Drawn{};
    }
    static void show(const LitScene& lit) { ASSERT_TRUE(rig().set_surface(lit.surface)); }
};

std::vector<LightListOptions> variants(std::uint32_t capacity) {
    std::vector<LightListOptions> all;
    for (const std::uint32_t tile : {8u, 16u, 32u}) {
        for (const DepthCells cells :
             {DepthCells::none, DepthCells::linear, DepthCells::logarithmic}) {
            all.push_back({.tile_px = tile, .capacity = capacity, .cells = cells});
        }
    }
    all.push_back({.tile_px = 16, .capacity = capacity, .two_level = false});
    all.push_back({.tile_px = 16, .capacity = capacity, .cell_count = 8});
    all.push_back({.tile_px = 16, .capacity = capacity, .pool = 200'000});
    return all;
}

std::string name_of(const LightListOptions& o) {
    return fmt::format("tile {} cells {} of {} two-level {} pool {}", o.tile_px,
                       static_cast<int>(o.cells), o.cell_count, o.two_level, o.pool);
}

/// Lights that a tile needs and its list does not have.
std::int64_t missing(const reference::ExactLists& exact, const LightRig::Drawn& drawn) {
    std::int64_t lost = 0;
    for (std::size_t tile = 0; tile < exact.needed.size(); ++tile) {
        std::vector<std::uint32_t> list = drawn.list(tile);
        std::sort(list.begin(), list.end());
        for (const std::uint32_t light : exact.needed[tile]) {
            lost += !std::binary_search(list.begin(), list.end(), light);
        }
    }
    return lost;
}

// Every light that a pixel of the tile needs, in double, is in its list, for every way of culling;
// and the picture is the one of walking all lights, to the last bit.
TEST_F(LightListsTest, NoVariantLosesALightOnAdversarialScenes) {
    for (const LitScene& lit : adversarial_lit_scenes(kWidth, kHeight)) {
        show(lit);
        std::map<std::uint32_t, reference::ExactLists> exact;
        for (const std::uint32_t tile : {8u, 16u, 32u}) {
            exact[tile] = reference::exact_lists(lit.scene, lit.view, lit.surface.view_z_m,
                                                 static_cast<int>(tile));
        }
        const auto all = draw(lit, {.lists = {.capacity = 4096}, .brute_force = true});
        for (const LightListOptions& options : variants(4096)) {
            const auto drawn = draw(lit, {.lists = options});
            EXPECT_EQ(missing(exact[options.tile_px], drawn), 0)
                << lit.name << ", " << name_of(options);
            EXPECT_EQ(drawn.bits, all.bits) << lit.name << ", " << name_of(options);
            EXPECT_EQ(drawn.counters.dropped + drawn.counters.pool_dropped, 0u) << lit.name;
        }
    }
}

TEST_F(LightListsTest, NoVariantLosesALightOnRandomScenes) {
    const std::vector<LightListOptions> all = variants(4096);
    double listed = 0;
    double needed = 0;
    for (std::uint64_t seed = 0; seed < 50; ++seed) {
        const LitScene lit = random_lit_scene(seed, kWidth, kHeight, 70);
        show(lit);
        const auto brute = draw(lit, {.lists = {.capacity = 4096}, .brute_force = true});
        // Two variants a scene; every one gets eight scenes.
        for (std::size_t k = 0; k < 2; ++k) {
            const LightListOptions& options = all[(2 * seed + k) % all.size()];
            const auto exact = reference::exact_lists(lit.scene, lit.view, lit.surface.view_z_m,
                                                      static_cast<int>(options.tile_px));
            const auto drawn = draw(lit, {.lists = options});
            EXPECT_EQ(missing(exact, drawn), 0) << "seed " << seed << ", " << name_of(options);
            EXPECT_EQ(drawn.bits, brute.bits) << "seed " << seed << ", " << name_of(options);
            listed += drawn.counters.listed;
            for (const auto& list : exact.needed) needed += static_cast<double>(list.size());
        }
    }
    RecordProperty("listed_over_needed", fmt::format("{:.3f}", listed / needed));
    // Over all variants, those without cells and those of large tiles included.
    EXPECT_LT(listed / needed, 1.5);
}

TEST_F(LightListsTest, ListsAscendAndDepthsOnlyTakeAway) {
    const LitScene lit = colonnade(160, 90, 300);
    show(lit);
    const auto plain =
        draw(lit, {.lists = {.tile_px = 16, .capacity = 512, .cells = DepthCells::none}});
    const auto cells = draw(lit, {.lists = {.tile_px = 16, .capacity = 512}});
    const auto exact = reference::exact_lists(lit.scene, lit.view, lit.surface.view_z_m, 16);
    for (std::size_t tile = 0; tile < exact.needed.size(); ++tile) {
        const auto wide = plain.list(tile);
        const auto narrow = cells.list(tile);
        EXPECT_TRUE(std::is_sorted(wide.begin(), wide.end(), std::less_equal<>()));
        EXPECT_TRUE(std::is_sorted(narrow.begin(), narrow.end()));
        EXPECT_TRUE(std::includes(wide.begin(), wide.end(), narrow.begin(), narrow.end()));
        EXPECT_TRUE(std::includes(narrow.begin(), narrow.end(), exact.needed[tile].begin(),
                                  exact.needed[tile].end()));
    }
    // The source: over 200 to at most 120.
    EXPECT_LE(cells.counters.longest, 0.6 * plain.counters.longest);
}

// Lights in the gap between columns and wall, clear of both by two cells, are in no list.
TEST_F(LightListsTest, LightsWhollyInTheGapReachNoTile) {
    LitScene lit = colonnade(160, 90, 0);
    for (int i = 0; i < 40; ++i) {
        lit.scene.lights.push_back(
            {.kind = LightKind::point, .position = {-4 + 0.2 * i, 0, 3}, .radius_m = 1.5});
    }
    show(lit);
    EXPECT_GT(draw(lit, {.lists = {.tile_px = 8, .cells = DepthCells::none}}).counters.listed, 0u);
    // Walls, floor and ceiling are in the picture, too: only tiles that show both depths count.
    const auto drawn = draw(lit, {.lists = {.tile_px = 8}});
    EXPECT_EQ(drawn.counters.listed, 0u);
}

TEST_F(LightListsTest, WhatOverflowsIsCountedAndTheBrightestStay) {
    std::vector<LitScene> scenes = adversarial_lit_scenes(kWidth, kHeight);
    LitScene& lit = *std::find_if(scenes.begin(), scenes.end(), [](const LitScene& s) {
        return s.name == "thousands in one tile";
    });
    for (std::size_t i = 0; i < lit.scene.lights.size(); ++i) {
        lit.scene.lights[i].color = glm::vec3(0.001f * static_cast<float>(i % 97 + 1));
    }
    show(lit);
    const auto whole = draw(lit, {.lists = {.tile_px = 16, .capacity = 4096}});
    ASSERT_GT(whole.counters.longest, 2000u);
    const auto clipped = draw(lit, {.lists = {.tile_px = 16, .capacity = 256}});
    std::uint32_t tiles = 0;
    std::uint32_t dropped = 0;
    for (std::size_t tile = 0; tile < whole.headers.size() / 2; ++tile) {
        const std::uint32_t count = whole.headers[2 * tile + 1];
        EXPECT_EQ(clipped.headers[2 * tile + 1], std::min(count, 256u));
        tiles += count > 256;
        dropped += count - std::min(count, 256u);
        if (count <= 256) continue;
        const auto power = [&](std::uint32_t i) {
            return lit.scene.lights[i].color.r * lit.scene.lights[i].radius_m;
        };
        const auto kept = clipped.list(tile);
        float least = 1e9f;
        for (const std::uint32_t i : kept) least = std::min(least, power(i));
        auto all = whole.list(tile);
        std::sort(all.begin(), all.end(),
                  [&](std::uint32_t a, std::uint32_t b) { return power(a) > power(b); });
        EXPECT_FLOAT_EQ(least, power(all[255]));
    }
    EXPECT_GT(tiles, 0u);
    EXPECT_EQ(clipped.counters.overflowing_tiles, tiles);
    EXPECT_EQ(clipped.counters.dropped, dropped);
    EXPECT_EQ(draw(lit, {.lists = {.tile_px = 16, .capacity = 256}}).bits, clipped.bits);
}

TEST_F(LightListsTest, AFullPoolIsCutOffAndCounted) {
    const LitScene lit = random_lit_scene(3, kWidth, kHeight, 120);
    show(lit);
    const auto whole = draw(lit, {.lists = {.pool = 100'000}});
    const std::uint32_t pool = whole.counters.listed / 2;
    const auto cut = draw(lit, {.lists = {.pool = pool}});
    EXPECT_EQ(cut.counters.listed, pool);
    EXPECT_EQ(cut.counters.pool_dropped, whole.counters.listed - pool);
    EXPECT_EQ(cut.indices.size(), pool);
    std::uint32_t next = 0;
    for (std::size_t tile = 0; tile < cut.headers.size() / 2; ++tile) {
        EXPECT_EQ(cut.headers[2 * tile], next);  // segments follow each other
        next += cut.headers[2 * tile + 1];
        const auto kept = cut.list(tile);
        const auto full = whole.list(tile);
        EXPECT_TRUE(std::equal(kept.begin(), kept.end(), full.begin()));
    }
    EXPECT_EQ(next, pool);
}

TEST_F(LightListsTest, TheSameSceneGivesTheSameBytes) {
    const LitScene lit = random_lit_scene(8, kWidth, kHeight, 200);
    show(lit);
    const auto first = draw(lit, {});
    for (int i = 0; i < 100; ++i) {
        const auto again = draw(lit, {});
        ASSERT_EQ(again.bits, first.bits) << i;
        ASSERT_EQ(again.headers, first.headers) << i;
        for (std::size_t tile = 0; tile < first.headers.size() / 2; ++tile) {
            ASSERT_EQ(again.list(tile), first.list(tile));
        }
    }
}

TEST_F(LightListsTest, ShuffledLightsGiveTheSamePictureButForRounding) {
    LitScene lit = random_lit_scene(9, kWidth, kHeight, 150);
    show(lit);
    const auto first = draw(lit, {});
    std::reverse(lit.scene.lights.begin(), lit.scene.lights.end());
    const auto other = draw(lit, {});
    for (std::size_t i = 0; i < first.linear.size(); ++i) {
        for (int k = 0; k < 3; ++k) {
            const float a = first.linear.pixels()[i][k];
            // One step of a half float.
            ASSERT_NEAR(other.linear.pixels()[i][k], a, std::abs(a) / 1000 + 1e-6f);
        }
    }
}

TEST_F(LightListsTest, BrokenLightsAreDroppedAndCounted) {
    std::vector<LitScene> scenes = adversarial_lit_scenes(kWidth, kHeight);
    LitScene& lit = *std::find_if(scenes.begin(), scenes.end(),
                                  [](const LitScene& s) { return s.name == "not a number"; });
    show(lit);
    const auto with = draw(lit, {});
    EXPECT_EQ(with.lists.check.dropped, 8u);
    lit.scene.lights.resize(lit.scene.lights.size() - 8);
    const auto without = draw(lit, {});
    EXPECT_EQ(without.lists.check.dropped, 0u);
    EXPECT_EQ(with.bits, without.bits);
}

// Lists for what is blended hold every light that reaches a point before the opaque surface, or
// before nothing.
TEST_F(LightListsTest, ListsForBlendedSurfacesReachFromTheEyeToTheSurface) {
    Random random(4);
    for (const std::uint64_t seed : {11u, 12u, 13u, 14u}) {
        LitScene lit = random_lit_scene(seed, kWidth, kHeight, 80);
        if (seed > 12) {  // nothing behind, too
            std::erase_if(lit.solids, [](const Solid& s) { return s.kind == Solid::Kind::room; });
            lit.surface = surface_of(lit.solids, lit.view);
        }
        show(lit);
        const auto opaque = draw(lit, {.lists = {.tile_px = 16, .capacity = 512}});
        const auto blended =
            draw(lit, {.lists = {.tile_px = 16, .capacity = 512, .for_blended = true}});
        Image<float> before = lit.surface.view_z_m;
        for (float& z : before.pixels()) {
            z = static_cast<float>((z > 0 ? z : 12.0f) * random.real(0.02, 1));
        }
        EXPECT_EQ(missing(reference::exact_lists(lit.scene, lit.view, before, 16), blended), 0);
        for (std::size_t tile = 0; tile < opaque.headers.size() / 2; ++tile) {
            const auto wide = blended.list(tile);
            const auto narrow = opaque.list(tile);
            EXPECT_TRUE(std::includes(wide.begin(), wide.end(), narrow.begin(), narrow.end()));
        }
    }
}

TEST_F(LightListsTest, StatisticsAreThoseOfTheHeaders) {
    const LitScene lit = random_lit_scene(21, kWidth, kHeight, 300);
    show(lit);
    const auto drawn = draw(lit, {});
    std::vector<std::uint32_t> histogram(65, 0);
    std::uint32_t listed = 0;
    std::uint32_t longest = 0;
    for (std::size_t i = 1; i < drawn.headers.size(); i += 2) {
        ++histogram[std::min((drawn.headers[i] + 7) / 8, 64u)];
        listed += drawn.headers[i];
        longest = std::max(longest, drawn.headers[i]);
    }
    EXPECT_EQ(drawn.counters.listed, listed);
    EXPECT_EQ(drawn.counters.longest, longest);
    EXPECT_TRUE(std::equal(histogram.begin(), histogram.end(), drawn.counters.histogram));
}

// Not called for, not paid for.
TEST_F(LightListsTest, FewLightsHaveNoLists) {
    LightRig fresh(device());
    LitScene lit = random_lit_scene(2, kWidth, kHeight, 8);
    ASSERT_TRUE(fresh.set_surface(lit.surface));
    EXPECT_FALSE(wants_light_lists(lit.scene));
    const auto few = fresh.draw(lit.scene, lit.view, {.read = false}).value();
    EXPECT_EQ(few.lists.tile_px, 0u);
    EXPECT_FALSE(few.lists.headers.valid());
    EXPECT_THAT(few.report.passes, testing::ElementsAre("light/upload", "light/shade lists"));
    EXPECT_THAT(fresh.pipelines().names(), testing::ElementsAre("light/shade live"));
    lit.scene.lights.push_back(lit.scene.lights[0]);
    EXPECT_TRUE(wants_light_lists(lit.scene));
    const auto more = fresh.draw(lit.scene, lit.view, {.statistics = false, .read = false}).value();
    EXPECT_THAT(more.report.passes,
                testing::ElementsAre("light/upload", "light/tile bounds", "light/macro cull",
                                     "light/tile cull", "light/shade lists"));
    // Directional lights, however many, are in no list.
    Scene scene;
    scene.lights.resize(20);
    EXPECT_FALSE(wants_light_lists(scene));
}

}  // namespace
}  // namespace kino::test
