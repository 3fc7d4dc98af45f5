#include <gmock/gmock.h>

#include <cmath>

#include "tests/viz/quality_lod/wires_scene.h"
#include "tests/viz/viz_fixture.h"
#include "viz/surface/mesh_shapes.h"

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

/// All lights above a roof that nothing shines through.
Scene roofed_wires(LightShadow shadow) {
    Scene scene = wires_scene(40);
    MeshNode roof = scene.meshes.front();
    roof.id = 100;
    roof.mesh = make_box({6, 0.05f, 6});
    roof.world_from_object = glm::dmat4(1);
    roof.world_from_object[3] = {0, 1.2, -1.8, 1};
    roof.previous_world_from_object = roof.world_from_object;
    scene.meshes.push_back(roof);
    for (Light& light : scene.lights) {
        light.position = {light.position.x, 1.6, -1.2};
        light.radius_m = 2.5f;
        light.shadow = shadow;
    }
    return scene;
}

// Shaded anew means with its own shadows, too.
TEST_F(VizTest, WiresInTheShadeStayInIt) {
    Renderer renderer(device());
    FrameOptions options;
    options.ray_shadows.half_resolution = false;
    options.read_surface = true;
    const Scene shaded = roofed_wires(LightShadow::raycast);
    const FrameResult truth = draw_wires(renderer, shaded, options);
    options.read_surface = false;
    options.count_fixed = true;
    options.lod = FramebufferLodOptions{.r = 4, .fix_share = 0.1f};
    const FrameResult fixed = draw_wires(renderer, shaded, options);
    ASSERT_TRUE(fixed.fixed);
    EXPECT_GT(fixed.fixed->shaded, 300u);
    EXPECT_LT(wire_error(fixed, truth).wires, 1.0);
    const FrameResult bright = draw_wires(renderer, roofed_wires(LightShadow::none), options);
    EXPECT_GT(wire_error(bright, truth).wires, 400.0) << "else no shadow would be missed";
}

}  // namespace
}  // namespace kino::test
