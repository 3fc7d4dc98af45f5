#include "tests/viz/quality_lod/wires_scene.h"

#include <gtest/gtest.h>

#include <cmath>

#include "viz/surface/mesh_shapes.h"

namespace kino::test {

View wires_view() {
    return {.width = kWiresWidth,
            .height = kWiresHeight,
            .projection = perspective(0.8, kWiresWidth, kWiresHeight),
            .world_from_view = look_at({0, 0, 0}, {0, 0, -1})};
}

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

FrameResult draw_wires(Renderer& renderer, const Scene& scene, const FrameOptions& options) {
    auto frame = renderer.render_to_image(scene, wires_view(), options);
    EXPECT_TRUE(frame) << (frame ? "" : frame.error().to_string());
    return frame ? std::move(*frame) : FrameResult{};
}

}  // namespace kino::test
