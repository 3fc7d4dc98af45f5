#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "tests/support/random.h"
#include "tests/viz/quality_lod/lod_rig.h"
#include "tests/viz/quality_lod/wires_scene.h"
#include "tests/viz/viz_fixture.h"

namespace kino::test {
namespace {

using testing::Contains;
using testing::Not;

class LodFinished : public VizTest {};

/// Steps, noise and background.
LodScene finish_scene(int width, int height) {
    Random random(3);
    LodScene scene = plain_scene(width, height);
    scene.object = Image<std::uint32_t>(width, height, 1);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const auto byte = [&] { return static_cast<std::uint8_t>(random.integer(0, 255)); };
            scene.albedo.at(x, y) = {byte(), byte(), byte(), 255};
            if (x / 24 % 3 == 1) scene.z.at(x, y) = 3;
            if (x / 31 % 4 == 3 && y < height / 2) {
                scene.z.at(x, y) = 0;
                scene.albedo.at(x, y).a = 0;
            }
        }
    }
    return scene;
}

// A pass less, the same picture: what differs is the rounding to half floats that is left out, a
// part in 2048 before a curve that is nowhere steeper than 13.
TEST_F(LodFinished, IsThePictureOfTheLastPass) {
    LodRig rig(device());
    const LodScene scene = finish_scene(203, 151);
    const LodShading light = [](int x, int y, const glm::vec3& albedo) {
        return glm::vec4(albedo * (0.1f + 0.02f * static_cast<float>((5 * x + 3 * y) % 97)), 1);
    };
    Scene rules;
    for (const ColorMode mode : {ColorMode::relit, ColorMode::captured}) {
        rules.color_mode = mode;
        rules.exposure = mode == ColorMode::relit ? 1.7f : 1.0f;
        for (FramebufferLodOptions options :
             {FramebufferLodOptions{}, FramebufferLodOptions{.flat_tolerance = 0},
              FramebufferLodOptions{.format = LodFormat::wide},
              FramebufferLodOptions{.reconstruction = Reconstruction::bilinear},
              FramebufferLodOptions{.reconstruction = Reconstruction::bilinear,
              .fine_grained = false}}) {
            options.r = mode == ColorMode::relit ? 2.6 : 2;
            const LodRig::Finished finished = rig.finish(scene, options, light, rules);
            ASSERT_EQ(finished.apart.size(), scene.z.size());
            int most = 0;
            std::size_t differ = 0;
            for (std::size_t i = 0; i < scene.z.size(); ++i) {
                const Rgba8 a = finished.apart.pixels()[i];
                const Rgba8 b = finished.on_the_way.pixels()[i];
                most = std::max({most, std::abs(a.r - b.r), std::abs(a.g - b.g),
                                 std::abs(a.b - b.b), std::abs(a.a - b.a)});
                differ += a == b ? 0 : 1;
            }
            EXPECT_LE(most, 1);
            EXPECT_LT(differ, scene.z.size() / 5);
        }
    }
}

// In a frame: fused where nothing comes between, and only there.
TEST_F(LodFinished, FramesLoseAPassWhereNothingIsDrawnBetween) {
    Renderer renderer(device());
    Scene scene = wires_scene(4);
    FrameOptions options;
    options.lod = FramebufferLodOptions{.r = 2};
    const FrameResult fused = draw_wires(renderer, scene, options);
    EXPECT_THAT(fused.report.passes, Not(Contains("light/final")));
    options.lod->fix_share = 1e-6f;
    const FrameResult listed = draw_wires(renderer, scene, options);
    EXPECT_THAT(listed.report.passes, Contains("light/final"));
    int most = 0;
    std::size_t differ = 0;
    for (std::size_t i = 0; i < fused.picture.size(); ++i) {
        const Rgba8 a = fused.picture.pixels()[i];
        const Rgba8 b = listed.picture.pixels()[i];
        const int d = std::max({std::abs(a.r - b.r), std::abs(a.g - b.g), std::abs(a.b - b.b)});
        differ += d > 1;
        most = std::max(most, d);
    }
    EXPECT_LE(differ, 1u) << "but for the one pixel that is listed";

    options.lod->fix_share = 0;
    options.lod->r = 1;
    EXPECT_THAT(draw_wires(renderer, scene, options).report.passes, Contains("light/final"));
    options.lod->r = 2;
    scene.materials.front().emission = glm::vec3(0.2f);
    EXPECT_THAT(draw_wires(renderer, scene, options).report.passes, Contains("light/final"));
    options.lod.reset();
    EXPECT_THAT(draw_wires(renderer, scene, options).report.passes, Contains("light/final"));
}

}  // namespace
}  // namespace kino::test
