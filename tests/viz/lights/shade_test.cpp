#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/random.h"
#include "tests/viz/lights/light_rig.h"
#include "tests/viz/lights/light_scenes.h"
#include "tests/viz/viz_fixture.h"
#include "viz/light/light_passes.h"

namespace kino::test {
namespace {

constexpr int kWide = 96;
constexpr int kHigh = 54;

class ShadeTest : public VizTest {
  protected:
    static LightRig& rig() {
        static auto* made = new LightRig(device());
        return *made;
    }
    static LightRig::Drawn draw(const LitScene& lit, const LightRig::Options& options = {}) {
        EXPECT_TRUE(rig().set_surface(lit.surface));
        auto drawn = rig().draw(lit.scene, lit.view, options);
        EXPECT_TRUE(drawn) << (drawn ? "" : drawn.error().to_string());
        return drawn ? std::move(*drawn) : LightRig::Drawn{};
    }
    /// Largest difference from the double reference, relative to the pixel's value where that is
    /// over a hundredth.
    static double worst(const LitScene& lit, const LightRig::Drawn& drawn, int step = 3) {
        double off = 0;
        for (int y = 0; y < lit.view.height; y += step) {
            for (int x = 0; x < lit.view.width; x += step) {
                const glm::dvec3 wanted = reference::shaded(lit.scene, lit.view, lit.surface, x, y);
                const glm::dvec3 got(drawn.linear.at(x, y));
                for (int k = 0; k < 3; ++k) {
                    off = std::max(off, std::abs(got[k] - wanted[k]) / std::max(wanted[k], 0.01));
                }
            }
        }
        return off;
    }
};

// A step of a half float is 1/2048 of the value, half of it rounding; the rest is for normals of 16
// bits, which grazing light multiplies.
constexpr double kRounding = 4e-3;

TEST_F(ShadeTest, PictureFollowsTheDoubleReference) {
    for (const std::uint64_t seed : {31u, 32u, 33u}) {
        LitScene lit = random_lit_scene(seed, kWide, kHigh, 120);
        lit.scene.lights.push_back({.kind = LightKind::directional,
                                    .direction = {0.3, -0.8, 0.2},
                                    .color = {0.3f, 0.2f, 0.1f}});
        EXPECT_LE(worst(lit, draw(lit)), kRounding) << seed;
        lit.scene.color_mode = ColorMode::mixed;
        EXPECT_LE(worst(lit, draw(lit)), kRounding) << seed;
    }
}

std::vector<Material> all_kinds() {
    Material metal{.name = "metal", .emission = {0.02f, 0, 0.01f}};
    metal.layers = {
        {.lobes = {{.kind = LobeKind::ggx, .color = {0.9f, 0.7f, 0.4f}, .roughness = 0.45f}}}};
    Material paint{.name = "paint"};
    paint.layers = {
        {.lobes = {{.kind = LobeKind::ggx, .color = glm::vec3(0.04f), .roughness = 0.3f}},
         .transmission = {0.9f, 0.8f, 0.85f}},
        {.lobes = {{.kind = LobeKind::lambert, .color = {0.7f, 0.1f, 0.1f}, .weight = 0.6f},
                   {.kind = LobeKind::oren_nayar, .weight = 0.4f, .roughness = 0.7f}}}};
    Material cloth{.name = "cloth"};
    cloth.layers = {
        {.lobes = {{.kind = LobeKind::rim, .color = {0.3f, 0.4f, 1.5f}, .roughness = 0.4f},
                   {.kind = LobeKind::lambert}}}};
    return {metal, paint, cloth, Material{.name = "plain"}};
}

LitScene with_materials(std::uint64_t seed) {
    LitScene lit = random_lit_scene(seed, kWide, kHigh, 60);
    Random random(seed);
    for (Solid& solid : lit.solids)
        solid.material = static_cast<std::uint32_t>(random.integer(0, 4));
    lit.scene.materials = all_kinds();
    lit.surface = surface_of(lit.solids, lit.view, true);
    for (Light& light : lit.scene.lights) {
        light.material_mask = static_cast<std::uint32_t>(random.bits()) | 1u << (random.bits() % 5);
    }
    lit.scene.lights.push_back({.kind = LightKind::directional,
                                .direction = {-0.3, -0.8, -0.4},
                                .color = {0.2f, 0.2f, 0.3f},
                                .material_mask = 0b10110});
    return lit;
}

TEST_F(ShadeTest, LayeredMaterialsFollowTheDoubleReference) {
    for (const std::uint64_t seed : {41u, 42u, 43u}) {
        LitScene lit = with_materials(seed);
        for (const ColorMode mode : {ColorMode::relit, ColorMode::mixed, ColorMode::captured}) {
            lit.scene.color_mode = mode;
            const auto drawn = draw(lit);
            EXPECT_LE(worst(lit, drawn), 2e-2) << seed << " mode " << static_cast<int>(mode);
            EXPECT_EQ(drawn.bits, draw(lit, {.brute_force = true}).bits);
        }
    }
}

TEST_F(ShadeTest, MeshesOfMaterial0LookLikeThePictureWithoutObjects) {
    LitScene lit = random_lit_scene(44, kWide, kHigh, 60);
    const auto live = draw(lit);
    lit.surface = surface_of(lit.solids, lit.view, true);
    const auto meshes = draw(lit);
    for (std::size_t i = 0; i < live.linear.size(); ++i) {
        for (int k = 0; k < 3; ++k) {
            const float a = live.linear.pixels()[i][k];
            ASSERT_NEAR(meshes.linear.pixels()[i][k], a, std::abs(a) / 1000 + 1e-6f);
        }
    }
}

// The pass without lists and materials walks the scene's lights as they are.
TEST_F(ShadeTest, PassWithoutListsMakesTheSamePicture) {
    LitScene lit = random_lit_scene(49, kWide, kHigh, 40);
    lit.scene.lights.push_back({.kind = LightKind::directional, .direction = {0.3, -0.8, 0.2}});
    const auto lists = draw(lit);
    LightRig::Options options;
    options.instead = [&](graph::FrameGraph& g, const LightLists&, const SurfaceTargets& s) {
        return add_light_pass(g, lit.scene, lit.view, s);
    };
    const auto plain = draw(lit, options);
    for (std::size_t i = 0; i < lists.linear.size(); ++i) {
        for (int k = 0; k < 3; ++k) {
            const float a = lists.linear.pixels()[i][k];
            ASSERT_NEAR(plain.linear.pixels()[i][k], a, std::abs(a) / 900 + 1e-6f);
        }
    }
}

TEST_F(ShadeTest, BackgroundPassesThrough) {
    LitScene lit = random_lit_scene(45, kWide, kHigh, 60);
    lit.solids.clear();
    lit.surface = surface_of(lit.solids, lit.view);
    const auto drawn = draw(lit);
    const glm::dvec3 wanted = reference::shaded(lit.scene, lit.view, lit.surface, 5, 5);
    for (const glm::vec4& pixel : drawn.linear.pixels()) {
        ASSERT_EQ(pixel.a, 0.0f);
        ASSERT_NEAR(pixel.r, wanted.r, 1e-5);
    }
}

// Exactly 0 at the radius, so that a list that ends there loses nothing.
TEST_F(ShadeTest, LightEndsAtItsRadius) {
    LitScene lit;
    lit.scene.color_mode = ColorMode::relit;
    lit.scene.ambient = glm::vec3(0);
    lit.view = {.width = 33,
                .height = 17,
                .projection = perspective(0.7, 33, 17),
                .world_from_view = world_from_camera_axes()};
    lit.solids = {{.kind = Solid::Kind::box, .center = {0, 0, -3}, .half = {9, 9, 1}}};
    lit.surface = surface_of(lit.solids, lit.view);
    for (const double beyond : {1e-3, 0.0, -0.2}) {
        lit.scene.lights = {{.kind = LightKind::point,
                             .position = {0, 0, -1.5 + beyond},
                             .color = glm::vec3(100),
                             .radius_m = 0.5f}};
        const auto drawn = draw(lit);
        const float most = drawn.linear.at(16, 8).r;
        if (beyond < 0)
            EXPECT_GT(most, 0.0f);
        else
            EXPECT_EQ(most, 0.0f) << beyond;
    }
}

TEST_F(ShadeTest, ShadowMasksHideLightsOfTheirSlots) {
    LitScene lit = random_lit_scene(46, kWide, kHigh, 40);
    for (std::size_t i = 0; i < lit.scene.lights.size(); i += 2) {
        lit.scene.lights[i].shadow = LightShadow::raycast;
    }
    lit.scene.lights.push_back({.kind = LightKind::directional,
                                .direction = {-0.3, -0.8, -0.4},
                                .shadow = LightShadow::raycast});
    const std::size_t words = std::size_t{4} * kWide * kHigh;
    const auto lit_all = draw(lit);
    const auto none_hidden = draw(lit, {.shadow_masks = std::vector<std::uint32_t>(words, 0u)});
    EXPECT_EQ(none_hidden.bits, lit_all.bits);
    const auto hidden = draw(lit, {.shadow_masks = std::vector<std::uint32_t>(words, ~0u)});
    LitScene rest = lit;
    std::erase_if(rest.scene.lights, [](const Light& l) { return l.shadow != LightShadow::none; });
    EXPECT_EQ(hidden.bits, draw(rest).bits);
    // Slot 0 is the directional light.
    std::vector<std::uint32_t> first(words, 0u);
    for (std::size_t i = 0; i < words; i += 4) first[i] = 1;
    rest = lit;
    rest.scene.lights.pop_back();
    EXPECT_EQ(draw(lit, {.shadow_masks = first}).bits, draw(rest).bits);
}

TEST_F(ShadeTest, LightsFromSlot128OnHaveNoShadow) {
    LitScene lit = random_lit_scene(47, kWide, kHigh, 0);
    for (int i = 0; i < 140; ++i) {
        lit.scene.lights.push_back({.kind = LightKind::point,
                                    .position = lit.view.world_from_view.translation,
                                    .color = glm::vec3(0.01f),
                                    .radius_m = 100,
                                    .shadow = LightShadow::raycast});
    }
    const std::size_t words = std::size_t{4} * kWide * kHigh;
    const auto hidden = draw(lit, {.shadow_masks = std::vector<std::uint32_t>(words, ~0u)});
    lit.scene.lights.resize(12);
    EXPECT_EQ(hidden.bits, draw(lit).bits);
}

// Framebuffer LOD: a smaller picture of the same view finds its tiles by position.
TEST_F(ShadeTest, CoarserPicturesUseTheListsOfTheFineOne) {
    LitScene fine = random_lit_scene(48, kWide, kHigh, 150);
    LitScene coarse = fine;
    coarse.view.width = kWide / 2;
    coarse.view.height = kHigh / 2;
    coarse.view.projection.fx /= 2;
    coarse.view.projection.fy /= 2;
    // Coarse pixel j shows fine pixel 2 j + 1.
    coarse.view.projection.cx = (fine.view.projection.cx - 1) / 2;
    coarse.view.projection.cy = (fine.view.projection.cy - 1) / 2;
    coarse.surface = surface_of(coarse.solids, coarse.view);
    for (int y = 0; y < coarse.view.height; ++y) {
        for (int x = 0; x < coarse.view.width; ++x) {
            coarse.surface.view_z_m.at(x, y) = fine.surface.view_z_m.at(2 * x + 1, 2 * y + 1);
        }
    }
    const auto wanted = draw(coarse, {.brute_force = true});
    // The lists come from the fine depths, the picture from the coarse surface.
    LightRig::Options options{.shading_view = coarse.view};
    options.lists_z = &fine.surface.view_z_m;
    auto got = rig().draw(fine.scene, fine.view, options);
    ASSERT_TRUE(got);
    EXPECT_EQ(got->bits, wanted.bits);
}

}  // namespace
}  // namespace kino::test
