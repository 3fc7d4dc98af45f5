#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>

#include "tests/viz/forward/solid_scene.h"
#include "tests/viz/viz_fixture.h"
#include "viz/surface/mesh_shapes.h"

namespace kino::test {
namespace {

// A clear coat returns more the flatter it is looked at (Schlick 1994): black glass over a grey
// wall lets less of it through.
TEST_F(VizTest, GlassCoversMoreFromTheSide) {
    constexpr int kSide = 48;
    constexpr double kOpacity = 0.25;
    Renderer renderer(device());
    Scene scene;
    scene.color_mode = ColorMode::relit;
    scene.ambient = glm::vec3(1);
    scene.materials = {{.name = "wall", .base_color = glm::vec3(0.6f)},
                       {.name = "glass", .base_color = glm::vec3(0), .opacity = kOpacity}};
    MeshNode wall{.id = 1, .mesh = make_box({20, 20, 0.1f}), .material = 1};
    wall.world_from_object[3] = glm::dvec4(0, 0, -6, 1);
    MeshNode pane{.id = 2, .mesh = make_grid(4, 4, 1, 1), .material = 2};
    for (const double degrees : {0.0, 40.0, 60.0, 75.0}) {
        // The grid looks up; 0 degrees: at the camera.
        const double turn = (90 - degrees) * std::numbers::pi / 180;
        pane.world_from_object = glm::rotate(glm::translate(glm::dmat4(1), glm::dvec3(0, 0, -2)),
                                             turn, glm::dvec3(1, 0, 0));
        scene.meshes = {wall, pane};
        const auto frame = renderer.render_to_image(scene, solid_view(kSide, kSide), {});
        ASSERT_TRUE(frame);
        const double away = 1 - std::cos(degrees * std::numbers::pi / 180);
        const double cover = kOpacity + (1 - kOpacity) * 0.96 * std::pow(away, 5);
        // The way to the middle of this pixel is half a pixel off the axis.
        EXPECT_NEAR(linear_of(frame->picture.at(kSide / 2, kSide / 2).g), 0.6 * (1 - cover), 0.012)
            << degrees;
    }
}

}  // namespace
}  // namespace kino::test
