#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/viz/quality_lod/wires_scene.h"
#include "tests/viz/viz_fixture.h"
#include "viz/surface/mesh_shapes.h"

namespace kino::test {
namespace {

/// A floor seen from three centimetres above it, under a sun that nothing hides.
Scene grazed_floor() {
    Scene scene;
    scene.color_mode = ColorMode::relit;
    scene.ambient = glm::vec3(0.05f);
    scene.materials.push_back({.name = "floor", .base_color = glm::vec3(0.5f)});
    MeshNode node{.id = 1, .mesh = make_box({30, 0.2f, 30}), .material = 1};
    node.world_from_object[3] = {0, -0.13, -12, 1};
    node.previous_world_from_object = node.world_from_object;
    scene.meshes.push_back(node);
    scene.lights.push_back({.kind = LightKind::directional,
                            .direction = glm::normalize(glm::dvec3(0.4, -1, 0.3)),
                            .color = glm::vec3(0.6f),
                            .shadow = LightShadow::raycast});
    return scene;
}

// Between fine pixels a coarse one may lie behind its surface; its rays must not start there.
TEST_F(VizTest, GrazedSurfacesDoNotShadowThemselvesAtAnyFactor) {
    Renderer renderer(device());
    const Scene scene = grazed_floor();
    FrameOptions options;
    options.read_surface = true;
    options.ray_shadows.half_resolution = false;
    const FrameResult truth = draw_wires(renderer, scene, options);
    options.read_surface = false;
    for (const double r : {1.25, 1.37, 2.0, 2.6, 3.1, 4.0}) {
        options.lod = FramebufferLodOptions{.r = r};
        const FrameResult coarse = draw_wires(renderer, scene, options);
        int floor = 0;
        int dark = 0;
        for (std::size_t i = 0; i < truth.picture.size(); ++i) {
            if (!(truth.surface.view_z_m.pixels()[i] > 0)) continue;
            ++floor;
            dark += coarse.picture.pixels()[i].g + 20 < truth.picture.pixels()[i].g;
        }
        EXPECT_GT(floor, 10000);
        EXPECT_EQ(dark, 0) << "r " << r;
    }
}

}  // namespace
}  // namespace kino::test
