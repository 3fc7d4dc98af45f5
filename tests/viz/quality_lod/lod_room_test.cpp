#include <gmock/gmock.h>

#include <cstring>

#include "tests/support/random.h"
#include "tests/viz/quality_lod/lod_rig.h"
#include "tests/viz/quality_lod/wires_scene.h"
#include "tests/viz/viz_fixture.h"

namespace kino::test {
namespace {

class LodRoom : public VizTest {};

template <class T>
bool same_bits(const Image<T>& a, const Image<T>& b) {
    return a.width() == b.width() && a.height() == b.height() &&
           (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

/// Slanted patches with edges everywhere, so that border pixels are weighed.
LodScene room_scene(int width, int height) {
    Random random(21);
    LodScene scene = plain_scene(width, height);
    scene.object = Image<std::uint32_t>(width, height, 3);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const int patch = x / 37 + 11 * (y / 29);
            scene.z.at(x, y) =
                1.5f + 0.2f * static_cast<float>(patch % 5) + 0.0005f * static_cast<float>(x);
            scene.object.at(x, y) = static_cast<std::uint32_t>(patch % 3);
            scene.albedo.at(x, y).g = static_cast<std::uint8_t>(random.integer(0, 255));
        }
    }
    return scene;
}

constexpr double kSweep[] = {1.25, 2.0, 8.0, 3.1, 1.37, 5.0, 4.0, 1.25};

// A sub-rectangle of a larger texture, whatever else lies in that, is as good as a texture of the
// right size.
TEST_F(LodRoom, PicturesDoNotDependOnTheRoom) {
    const LodScene scene = room_scene(203, 151);
    const LodShading light = [](int x, int y, const glm::vec3& albedo) {
        return glm::vec4(albedo * (0.2f + 0.01f * static_cast<float>((7 * x + 13 * y) % 90)), 1);
    };
    for (const LodFormat format : {LodFormat::packed, LodFormat::wide}) {
        LodRig exact(device());
        LodRig roomy(device());
        roomy.set_poison(true);
        for (const double r : kSweep) {
            FramebufferLodOptions options{.r = r, .format = format, .fix_share = 0.05f};
            const LodResult wanted = exact.run(scene, options, light);
            options.least_r = 1.25;
            const LodResult got = roomy.run(scene, options, light);
            EXPECT_EQ(got.coarse_view.projection.cx, wanted.coarse_view.projection.cx);
            EXPECT_EQ(got.coarse_view.projection.fx, wanted.coarse_view.projection.fx);
            EXPECT_TRUE(same_bits(got.z, wanted.z)) << r;
            EXPECT_TRUE(same_bits(got.guide, wanted.guide)) << r;
            EXPECT_FALSE(got.picture.empty());
            EXPECT_TRUE(same_bits(got.picture, wanted.picture)) << r;
            EXPECT_EQ(got.fixed, wanted.fixed) << r;
        }
    }
}

// The whole frame, light lists and shadows of the coarse picture included.
TEST_F(LodRoom, FactorsThatChangeEveryFrameAllocateNothing) {
    Scene scene = wires_scene(40);
    for (std::size_t i = 0; i < scene.lights.size(); i += 2) {
        scene.lights[i].shadow = LightShadow::raycast;
    }
    for (const float share : {0.0f, 0.05f}) {
        Renderer exact(device());
        Renderer roomy(device());
        roomy.poison_memory(true);
        std::int64_t allocations = 0;
        for (const double r : kSweep) {
            FrameOptions options;
            // With the third pass light lists are of the fine picture, and shadows of 2x2 pixels
            // fit their tiles at some factors only: the first of these makes one buffer more.
            options.ray_shadows.half_resolution = share == 0;
            options.lod = FramebufferLodOptions{.r = r, .least_r = 1.25, .fix_share = share};
            const FrameResult got = draw_wires(roomy, scene, options);
            if (allocations != 0) {
                EXPECT_EQ(device().allocations(), allocations) << "r " << r;
            }
            options.lod->least_r = 0;
            const FrameResult wanted = draw_wires(exact, scene, options);
            EXPECT_FALSE(got.picture.empty());
            EXPECT_TRUE(same_bits(got.picture, wanted.picture)) << "r " << r;
            EXPECT_EQ(got.report.passes, wanted.report.passes);
            allocations = device().allocations();
        }
    }
}

// Without it nothing is larger than it must be.
TEST_F(LodRoom, NotAskedForItCostsNoByte) {
    Renderer renderer(device());
    const Scene scene = wires_scene(4);
    const auto bytes = [&](double r, double least_r) {
        FrameOptions options;
        options.lod = FramebufferLodOptions{.r = r, .least_r = least_r};
        return draw_wires(renderer, scene, options).report.transient_bytes;
    };
    EXPECT_LT(bytes(4, 0), bytes(2, 0));
    EXPECT_LT(bytes(4, 0), bytes(4, 2));
    EXPECT_EQ(bytes(4, 2), bytes(2, 0));
    EXPECT_EQ(bytes(4, 8), bytes(4, 0)) << "not below r itself";
}

}  // namespace
}  // namespace kino::test
