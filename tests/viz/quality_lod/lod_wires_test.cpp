#include <gmock/gmock.h>

#include <cmath>

#include "tests/viz/quality_lod/wires_scene.h"
#include "tests/viz/viz_fixture.h"

namespace kino::test {
namespace {

using testing::Contains;
using testing::Each;
using testing::Not;
using testing::StartsWith;

/// Mean squared error where wires are, and elsewhere.
struct WireError {
    double wires = 0, others = 0;
    int count = 0;
};
WireError wire_error(const FrameResult& frame, const FrameResult& truth) {
    WireError error;
    const Image<float>& z = truth.surface.view_z_m;
    int others = 0;
    for (std::size_t i = 0; i < z.size(); ++i) {
        const Rgba8 a = frame.picture.pixels()[i];
        const Rgba8 b = truth.picture.pixels()[i];
        const double d =
            (std::pow(a.r - b.r, 2) + std::pow(a.g - b.g, 2) + std::pow(a.b - b.b, 2)) / 3;
        const bool wire = z.pixels()[i] > 1.46f && z.pixels()[i] < 2;
        (wire ? error.wires : error.others) += d;
        ++(wire ? error.count : others);
    }
    error.wires /= std::max(error.count, 1);
    error.others /= std::max(others, 1);
    return error;
}

// What no coarse pixel saw is shaded by its own lights.
TEST_F(VizTest, ThinWiresAreShadedAnew) {
    Renderer renderer(device());
    for (const int lights : {4, 40}) {
        // And once with shadows.
        Scene scene = wires_scene(lights);
        for (Light& light : scene.lights) {
            light.shadow = lights == 40 ? LightShadow::raycast : LightShadow::none;
        }
        FrameOptions options;
        options.ray_shadows.half_resolution = false;
        options.read_surface = true;
        const FrameResult truth = draw_wires(renderer, scene, options);
        options.read_surface = false;
        options.lod = FramebufferLodOptions{.r = 4};
        EXPECT_THAT(draw_wires(renderer, scene, options).report.passes,
                    Each(Not(StartsWith("lod/fix"))));
        // With room for one pixel: the same passes, so that nothing else differs.
        options.lod->fix_share = 1e-6f;
        const FrameResult coarse = draw_wires(renderer, scene, options);
        options.lod->fix_share = 0.1f;
        EXPECT_FALSE(draw_wires(renderer, scene, options).fixed) << "nobody asked";
        options.count_fixed = true;
        const FrameResult fixed = draw_wires(renderer, scene, options);
        ASSERT_TRUE(fixed.fixed);
        EXPECT_EQ(fixed.fixed->failed, fixed.fixed->shaded);
        EXPECT_LE(fixed.fixed->shaded, 0.1 * kWiresWidth * kWiresHeight);
        EXPECT_THAT(fixed.report.passes, Contains("light/shade listed"));
        const WireError before = wire_error(coarse, truth);
        const WireError after = wire_error(fixed, truth);
        EXPECT_GT(fixed.fixed->shaded, static_cast<unsigned>(before.count) / 2);
        ASSERT_GT(before.count, 300);
        ASSERT_GT(before.wires, 25.0) << lights << " lights";
        EXPECT_LE(after.wires, 0.1 * before.wires) << lights << " lights";
        EXPECT_LE(after.others, before.others * 1.001 + 1e-3) << lights << " lights";
    }
}

}  // namespace
}  // namespace kino::test
