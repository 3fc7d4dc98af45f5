#include "viz/light/light_parts.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "tests/support/random.h"
#include "tests/viz/multires/stage_rig.h"
#include "tests/viz/viz_fixture.h"
#include "viz/frame/stage_light.h"
#include "viz/frame/stage_surface.h"
#include "viz/light/light_records.h"

namespace kino::test {
namespace {

using testing::ElementsAre;

std::ptrdiff_t count_of(const std::vector<std::string>& passes, const std::string& name) {
    return std::count(passes.begin(), passes.end(), name);
}

TEST(LightLevels, NothingAskedForIsOneLevel) {
    EXPECT_THAT(light_levels({}, kAllLights, 2), ElementsAre(LightLevel{2, kAllLights}));
    EXPECT_THAT(light_levels({}, 0, 1), ElementsAre(LightLevel{1, kAllLights}));
    // What the scene has no lights of calls for nothing.
    EXPECT_THAT(light_levels({.bounced = 8}, kShadowedLights | kPlainLights, 2),
                ElementsAre(LightLevel{2, kAllLights}));
    EXPECT_THAT(light_levels({.shadowed = 3, .plain = 3, .bounced = 3}, kAllLights, 1),
                ElementsAre(LightLevel{3, kAllLights}));
}

// What is not resized at all does not say by what the others are.
TEST(LightLevels, FullSizeStandsBesideTheChain) {
    EXPECT_THAT(light_levels({.shadowed = 1, .plain = 1.75, .bounced = 3.5}, kAllLights, 1),
                ElementsAre(LightLevel{1, kShadowedLights}, LightLevel{1.75, kPlainLights},
                            LightLevel{3.5, kBouncedLights}));
}

TEST(LightLevels, EveryPartIsInOneLevelAtTwosFromTheFirstResized) {
    Random random(5);
    for (int round = 0; round < 200; ++round) {
        const auto rate = [&] {
            return random.integer(0, 4) < 2 ? random.integer(0, 1) : random.real(1, 9);
        };
        const PartRates rates{rate(), rate(), rate()};
        const double lod_r = random.integer(0, 2) == 0 ? 1 : random.real(1, 5);
        const auto present = static_cast<std::uint32_t>(random.integer(1, 7));
        const auto levels = light_levels(rates, present, lod_r);
        std::uint32_t seen = 0;
        double before = 0;
        for (const LightLevel& level : levels) {
            EXPECT_EQ(seen & level.parts, 0u);
            seen |= level.parts;
            EXPECT_GT(level.r, before);
            before = level.r;
            const double first = levels.front().r == 1 ? levels.back().r : levels.front().r;
            const double octaves = level.r == 1 ? 0 : std::log2(level.r / first);
            EXPECT_NEAR(octaves, std::round(octaves), 1e-12);
            const double asked[] = {rates.shadowed, rates.plain, rates.bounced};
            for (int k = 0; k < 3; ++k) {
                if ((level.parts & present & (1u << k)) == 0) continue;
                const double wanted = asked[k] == 0 ? lod_r : asked[k];
                EXPECT_LE(std::abs(std::log2(level.r / wanted)), 0.5 + 1e-9);
                EXPECT_EQ(level.r == 1, wanted == 1);
            }
        }
        EXPECT_EQ(seen, kAllLights);
    }
}

TEST(LightParts, EveryLightIsPackedWithOnePart) {
    const Scene scene = parts_scene();
    std::size_t sum = 0;
    for (const std::uint32_t part : {kShadowedLights, kPlainLights, kBouncedLights}) {
        const PackedLights packed = pack_lights(scene, parts_view(), 512, part);
        for (const auto& record : packed.records) {
            EXPECT_EQ(record.casts_shadow != 0, part == kShadowedLights);
        }
        sum += packed.records.size();
    }
    EXPECT_EQ(sum, pack_lights(scene, parts_view(), 512).records.size());
    EXPECT_EQ(light_parts(scene), kAllLights);
}

StageOptions exact_options() {
    StageOptions options;
    options.shadows.half_resolution = false;
    return options;
}

/// The light of the levels over the scene's surface, made coarse first by `r`, not enlarged.
RigDrawn levels_of(StageRig& rig, const Scene& scene, const View& view,
                   const std::vector<LightLevel>& levels) {
    const StageOptions options = exact_options();
    return rig.draw(scene, view, [&](graph::FrameGraph& graph, const StageParts& parts) {
        const SurfaceTargets surface =
            add_surface(graph, scene, view, parts, options.raster, false).surface;
        const SpawnedLights bounces = add_bounces(graph, scene, view, parts, options);
        const SceneBvhPasses bvh = parts.bvh.add(graph);
        return add_light_levels(graph, {scene, bounces, bvh, options},
                                {.surface = surface, .view = view, .guide = {}}, levels, {}, true);
    });
}

// Every sum has three half floats (2^-11 each) more than the light at once.
TEST_F(VizTest, PartsAddUpToTheWhole) {
    StageRig& rig = shared_rig(device());
    const Scene scene = parts_scene();
    const View view = parts_view();
    const RigDrawn whole = levels_of(rig, scene, view, {{1, kAllLights}});
    const RigDrawn parts =
        levels_of(rig, scene, view, {{1, kShadowedLights}, {1, kPlainLights}, {1, kBouncedLights}});
    ASSERT_EQ(count_of(whole.passes, "light/shade lists"), 1);
    ASSERT_EQ(count_of(parts.passes, "light/shade lists"), 3);
    ASSERT_EQ(count_of(parts.passes, "light/shadow pixels"), 1) << "one part casts shadows";
    double most = 0;
    double brightest = 0;
    for (std::size_t i = 0; i < whole.linear.size(); ++i) {
        const glm::vec4 a = whole.linear.pixels()[i];
        const glm::vec4 b = parts.linear.pixels()[i];
        EXPECT_EQ(a.a, b.a);
        for (int k = 0; k < 3; ++k) {
            most = std::max(most, std::abs(a[k] - b[k]) / std::max(1e-3, double{a[k]}));
            brightest = std::max(brightest, double{a[k]});
        }
    }
    EXPECT_GT(brightest, 0.3);
    EXPECT_LE(most, 3.5 / 2048);
    // Each part is there: without it the picture is another.
    for (const std::uint32_t part : {kShadowedLights, kPlainLights, kBouncedLights}) {
        const RigDrawn without = levels_of(rig, scene, view, {{1, kAllLights & ~part}});
        EXPECT_GT(light_error(without.linear, whole.linear).mse, 1e-4) << part;
    }
}

// Light that is the same everywhere stays what it is, whatever it is resized by; so does what
// belongs to the first level alone.
TEST_F(VizTest, ConstantLightIsKeptByEveryRate) {
    StageRig& rig = shared_rig(device());
    Scene scene = parts_scene();
    scene.meshes.resize(1);  // the wall
    scene.lights = {{.direction = {0, 0, -1}, .color = glm::vec3(0.7f, 0.5f, 0.3f)},
                    {.direction = {0, 0, -1},
                     .color = glm::vec3(0.1f, 0.2f, 0.25f),
                     .shadow = LightShadow::raycast}};
    const View view = parts_view();
    for (const double lod_r : {1.0, 2.0}) {
        // Beside a coarse picture emission is the last pass's.
        scene.materials[0].emission = lod_r > 1 ? glm::vec3(0) : glm::vec3(0.11f, 0, 0.02f);
        const RigDrawn full = rig.draw(scene, view, exact_options());
        for (const double plain : {2.0, 4.0, 8.0}) {
            StageOptions options = exact_options();
            if (lod_r > 1) options.lod = FramebufferLodOptions{.r = lod_r};
            options.rates = {.shadowed = lod_r, .plain = lod_r * plain};
            const RigDrawn parts = rig.draw(scene, view, options);
            EXPECT_EQ(count_of(parts.passes, "light/shade lists"), 2);
            double most = 0;
            for (std::size_t i = 0; i < full.linear.size(); ++i) {
                for (int k = 0; k < 3; ++k) {
                    const double a = full.linear.pixels()[i][k];
                    most = std::max(most, std::abs(a - parts.linear.pixels()[i][k]) / a);
                }
            }
            // Six roundings to half floats: two pictures, light of each twice.
            EXPECT_LE(most, 6.0 / 2048) << lod_r << " " << plain;
        }
    }
}

// What is resized alone is near the full picture, the nearer the finer, and never bleeds over an
// edge of the surface.
TEST_F(VizTest, BouncedLightMayBeCoarse) {
    StageRig& rig = shared_rig(device());
    const Scene scene = parts_scene();
    const View view = parts_view(256, 192);
    const LightError none{};
    LightError before = none;
    const RigDrawn full = rig.draw(scene, view, exact_options());
    StageOptions all = exact_options();
    for (const double r : {2.0, 4.0}) {
        StageOptions options = exact_options();
        options.rates = {.bounced = r};
        const RigDrawn drawn = rig.draw(scene, view, options);
        EXPECT_EQ(count_of(drawn.passes, "lod/up"), 1);
        const LightError error = light_error(drawn.linear, full.linear);
        all.lod = FramebufferLodOptions{.r = r};
        const LightError equal = light_error(rig.draw(scene, view, all).linear, full.linear);
        EXPECT_LT(error.mse, 0.25 * equal.mse) << r;
        EXPECT_LT(error.mse, 2e-5) << r;
        EXPECT_GT(error.mse, before.mse) << r;
        before = error;
    }
    // With everything coarse, and bounces coarser: nearly what everything coarse alone loses.
    all.lod->r = 2;
    const LightError equal = light_error(rig.draw(scene, view, all).linear, full.linear);
    all.rates = {.bounced = 4};
    const RigDrawn nested = rig.draw(scene, view, all);
    EXPECT_EQ(count_of(nested.passes, "lod/pick"), 2);
    EXPECT_EQ(count_of(nested.passes, "lod/up"), 2);
    EXPECT_LT(light_error(nested.linear, full.linear).mse, 1.1 * equal.mse);
}

// Rates that change nothing change no pass, no byte and no pipeline.
TEST_F(VizTest, RatesThatSayNothingCostNothing) {
    const Scene scene = parts_scene();
    const View view = parts_view();
    StageRig plain(device());
    StageRig rated(device());
    StageOptions options = exact_options();
    options.lod = FramebufferLodOptions{.r = 2};
    const RigDrawn a = plain.draw(scene, view, options);
    options.rates = {2, 2, 2};
    const RigDrawn b = rated.draw(scene, view, options);
    EXPECT_EQ(a.passes, b.passes);
    EXPECT_EQ(a.transient_bytes, b.transient_bytes);
    EXPECT_EQ(plain.pipelines().names(), rated.pipelines().names());
    EXPECT_EQ(count_of(a.passes, "light/shade lists"), 1);
    EXPECT_EQ(a.linear, b.linear);
}

}  // namespace
}  // namespace kino::test
