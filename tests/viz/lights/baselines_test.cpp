#include <gtest/gtest.h>

#include <algorithm>

#include "tests/viz/lights/light_baselines.h"
#include "tests/viz/lights/light_rig.h"
#include "tests/viz/lights/light_scenes.h"
#include "tests/viz/viz_fixture.h"

namespace kino::test {
namespace {

class BaselinesTest : public VizTest {};

LitScene points_only(std::uint64_t seed) {
    LitScene lit = random_lit_scene(seed, 79, 61, 90);
    for (Light& light : lit.scene.lights) light.kind = LightKind::point;
    return lit;
}

std::int64_t lost(const reference::ExactLists& exact, const HostLists& lists,
                  const PackedLights& packed) {
    std::int64_t count = 0;
    for (std::size_t tile = 0; tile < exact.needed.size(); ++tile) {
        std::vector<std::uint32_t> list;
        for (std::uint32_t i = 0; i < lists.headers[2 * tile + 1]; ++i) {
            list.push_back(packed.records[lists.indices[lists.headers[2 * tile] + i]].scene_index);
        }
        EXPECT_TRUE(std::is_sorted(list.begin(), list.end()));
        for (const std::uint32_t light : exact.needed[tile]) {
            count += !std::binary_search(list.begin(), list.end(), light);
        }
    }
    return count;
}

TEST_F(BaselinesTest, ListsOfTheHostAndOfTheTreeLoseNothing) {
    std::vector<LitScene> scenes = adversarial_lit_scenes(79, 61);
    for (std::uint64_t seed = 60; seed < 80; ++seed) {
        scenes.push_back(random_lit_scene(seed, 79, 61, 90));
    }
    for (const LitScene& lit : scenes) {
        const PackedLights packed = pack_lights(lit.scene, lit.view, UINT32_MAX);
        for (const std::uint32_t tile : {8u, 32u}) {
            const auto exact = reference::exact_lists(lit.scene, lit.view, lit.surface.view_z_m,
                                                      static_cast<int>(tile));
            EXPECT_EQ(lost(exact, make_host_lists(packed, lit.view, tile), packed), 0) << lit.name;
            // Boxes of spheres of 3e38 m are no numbers.
            if (lit.name == "huge radii") continue;
            EXPECT_EQ(lost(exact, make_tree_lists(packed, lit.view, tile), packed), 0) << lit.name;
        }
    }
}

// All rivals make the same picture, else their times mean nothing.
TEST_F(BaselinesTest, RivalsMakeTheSamePicture) {
    LightRig rig(device());
    const LitScene lit = points_only(7);
    ASSERT_TRUE(rig.set_surface(lit.surface));
    const auto wanted = rig.draw(lit.scene, lit.view, {.lists = {.capacity = 512}}).value();
    const auto expect_same = [&](const char* name, auto&& add) {
        LightRig::Options options;
        options.instead = add;
        const auto got = rig.draw(lit.scene, lit.view, options).value();
        for (std::size_t i = 0; i < got.linear.size(); ++i) {
            for (int k = 0; k < 3; ++k) {
                const float a = wanted.linear.pixels()[i][k];
                ASSERT_NEAR(got.linear.pixels()[i][k], a, std::abs(a) / 900 + 1e-6f) << name;
            }
        }
    };
    expect_same("deferred", [&](graph::FrameGraph& g, const LightLists&, const SurfaceTargets& s) {
        return add_deferred(g, lit.scene, lit.view, s);
    });
    expect_same("clustered", [&](graph::FrameGraph& g, const LightLists&, const SurfaceTargets& s) {
        return add_clustered(g, lit.scene, lit.view, s);
    });
    expect_same("host", [&](graph::FrameGraph& g, const LightLists&, const SurfaceTargets& s) {
        return add_shade_pass(g, lit.scene, lit.view,
                              {.surface = s,
                               .lists = add_host_light_lists(g, lit.scene, lit.view, 16),
                               .shadow_masks = {}});
    });
}

TEST_F(BaselinesTest, HeatMapShowsLengths) {
    LightRig rig(device());
    const LitScene lit = points_only(9);
    ASSERT_TRUE(rig.set_surface(lit.surface));
    LightRig::Options options;
    options.lists.tile_px = 16;
    options.instead = [](graph::FrameGraph& g, const LightLists& lists, const SurfaceTargets&) {
        return add_light_heat_map(g, lists, 50);
    };
    const auto map = rig.draw(lit.scene, lit.view, options).value();
    for (int y = 0; y < 61; y += 7) {
        for (int x = 0; x < 79; x += 7) {
            const auto tile = static_cast<std::size_t>(y / 16 * 5 + x / 16);
            const float heat = std::min(static_cast<float>(map.headers[2 * tile + 1]) / 50, 1.0f);
            const glm::vec4 c = map.linear.at(x, y);
            if (heat == 0) {
                EXPECT_EQ(c.b, 0.0f);
                continue;
            }
            EXPECT_NEAR(c.r, std::max(2 * heat - 1, 0.0f), 2e-3);
            EXPECT_NEAR(c.b, std::max(1 - 2 * heat, 0.0f), 2e-3);
        }
    }
}

}  // namespace
}  // namespace kino::test
