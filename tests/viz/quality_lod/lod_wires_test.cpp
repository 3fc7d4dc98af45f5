#include <gmock/gmock.h>

#include <cmath>

#include "tests/viz/viz_fixture.h"
#include "viz/surface/mesh_shapes.h"

namespace kino::test {
namespace {

using testing::Contains;
using testing::Each;
using testing::Not;
using testing::StartsWith;

constexpr int kWiresWidth = 320;
constexpr int kWiresHeight = 180;

View wires_view() {
    return {.width = kWiresWidth,
            .height = kWiresHeight,
            .projection = perspective(0.8, kWiresWidth, kWiresHeight),
            .world_from_view = look_at({0, 0, 0}, {0, 0, -1})};
}

/// Wires of half a pixel, upright and slanted, half a metre before a wall, under more lights than
/// a shader walks. Lights near the wires do not reach the wall.
Scene wires_scene(int lights) {
    Scene scene;
    scene.color_mode = ColorMode::relit;
    scene.ambient = glm::vec3(0.03f);
    scene.materials.push_back({.name = "wall", .base_color = glm::vec3(0.5f)});
    scene.materials.push_back({.name = "wire", .base_color = glm::vec3(0.7f, 0.6f, 0.5f)});
    const auto add = [&](std::shared_ptr<const MeshAsset> mesh, const glm::dmat4& place,
                         std::uint32_t material) {
        MeshNode node{.id = static_cast<std::uint32_t>(scene.meshes.size() + 1),
                      .mesh = std::move(mesh),
                      .material = material};
        node.world_from_object = place;
        node.previous_world_from_object = place;
        scene.meshes.push_back(std::move(node));
    };
    glm::dmat4 wall(1);
    wall[3] = {0, 0, -3.1, 1};
    add(make_box({8, 8, 0.2f}), wall, 1);
    const double pixel_m = 1.5 / wires_view().projection.fx;  // at the wires
    const auto wire = make_box({static_cast<float>(0.5 * pixel_m), 2, 0.002f});
    for (int i = 0; i < 14; ++i) {
        glm::dmat4 place(1);
        const double slant = i % 2 == 0 ? 0.0 : 0.23;
        place[0] = {std::cos(slant), std::sin(slant), 0, 0};
        place[1] = {-std::sin(slant), std::cos(slant), 0, 0};
        place[3] = {-0.9 + 0.137 * i, 0, -1.5, 1};
        add(wire, place, 2);
    }
    // A shelf before the wires parts the lights.
    glm::dmat4 shelf(1);
    shelf[3] = {0, 0.02, -1.2, 1};
    add(make_box({3, 0.02f, 0.5f}), shelf, 1);
    for (int i = 0; i < lights; ++i) {
        const bool near = i % 2 == 0;
        scene.lights.push_back(
            {.kind = LightKind::point,
             .position = {-1.0 + 2.0 * (i % 8) / 7, -0.5 + 0.2 * (i / 8), near ? -1.1 : -2.5},
             .color = near ? glm::vec3(0.5f, 0.2f, 0.1f) : glm::vec3(0.3f),
             .radius_m = 0.9f});
    }
    return scene;
}

FrameResult draw(Renderer& renderer, const Scene& scene, const FrameOptions& options) {
    auto frame = renderer.render_to_image(scene, wires_view(), options);
    EXPECT_TRUE(frame) << (frame ? "" : frame.error().to_string());
    return frame ? std::move(*frame) : FrameResult{};
}

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
        const FrameResult truth = draw(renderer, scene, options);
        options.read_surface = false;
        options.lod = FramebufferLodOptions{.r = 4};
        const FrameResult coarse = draw(renderer, scene, options);
        EXPECT_THAT(coarse.report.passes, Each(Not(StartsWith("lod/fix"))));
        options.lod->fix_share = 0.1f;
        EXPECT_FALSE(draw(renderer, scene, options).fixed) << "nobody asked";
        options.count_fixed = true;
        const FrameResult fixed = draw(renderer, scene, options);
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
