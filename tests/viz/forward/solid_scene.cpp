#include "tests/viz/forward/solid_scene.h"

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "viz/surface/mesh_shapes.h"

namespace kino::test {
namespace {

MeshNode standing(std::shared_ptr<const MeshAsset> mesh, const glm::dvec3& at, double turn,
                  std::uint32_t material) {
    MeshNode node{.id = material, .mesh = std::move(mesh), .material = material};
    node.world_from_object =
        glm::rotate(glm::translate(glm::dmat4(1), at), turn, glm::dvec3(0.3, 1, 0.2));
    node.previous_world_from_object = node.world_from_object;
    return node;
}

}  // namespace

Scene solid_scene(int lights) {
    Scene scene;
    scene.color_mode = ColorMode::relit;
    scene.ambient = glm::vec3(0.25f);
    // Colours of 8 bits, which the thin surface keeps as they are.
    const auto of = [](int r, int g, int b) {
        const auto linear = [](int coded) {
            return static_cast<float>(linear_of(static_cast<std::uint8_t>(coded)));
        };
        return glm::vec3(linear(r), linear(g), linear(b));
    };
    scene.materials = {{.name = "wall", .base_color = of(188, 188, 196)},
                       {.name = "box", .base_color = of(230, 137, 90)},
                       {.name = "post", .base_color = of(90, 218, 149)},
                       {.name = "cube", .base_color = of(124, 149, 240)}};
    scene.meshes = {standing(make_box({8, 6, 0.1f}), {0, 0, -4}, 0, 1),
                    standing(make_box({0.7f, 0.9f, 0.5f}), {-0.7, -0.1, -2.6}, 0.7, 2),
                    standing(make_box({0.06f, 2.4f, 0.06f}), {0.15, 0, -2.4}, 0.25, 3),
                    standing(make_box({0.6f, 0.6f, 0.6f}), {0.85, 0.1, -2.5}, 2.1, 4)};
    for (int i = 0; i < lights; ++i) {
        scene.lights.push_back(
            {.kind = LightKind::point,
             .position = {-1.5 + 3.0 * (i % 4) / 3, -0.9 + 1.8 * (i / 4 % 3) / 2,
                          -0.6 - 0.3 * (i % 3)},
             .color = float(6.0 / lights) *
                      glm::vec3(0.3f + 0.1f * float(i % 3), 0.4f, 0.5f - 0.1f * float(i % 3)),
             .radius_m = 4.5f});
    }
    return scene;
}

View solid_view(int width, int height) {
    return {.width = width,
            .height = height,
            .projection = perspective(0.8, width, height),
            .world_from_view = look_at({0, 0, 0}, {0, 0, -1})};
}

View moved_by(View view, double x_px, double y_px) {
    view.projection.cx -= static_cast<float>(x_px);
    view.projection.cy -= static_cast<float>(y_px);
    return view;
}

double linear_of(std::uint8_t coded) {
    const double c = coded / 255.0;
    return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

double coded_of(double linear) {
    return 255 * (linear <= 0.0031308 ? linear * 12.92 : 1.055 * std::pow(linear, 1 / 2.4) - 0.055);
}

std::vector<glm::dvec3> mean_coded(const std::vector<Image<Rgba8>>& pictures) {
    std::vector<glm::dvec3> mean(pictures.front().size(), glm::dvec3(0));
    for (const Image<Rgba8>& picture : pictures) {
        for (std::size_t i = 0; i < mean.size(); ++i) {
            const Rgba8 p = picture.pixels()[i];
            mean[i] += glm::dvec3(linear_of(p.r), linear_of(p.g), linear_of(p.b));
        }
    }
    for (glm::dvec3& c : mean) {
        for (int k = 0; k < 3; ++k) c[k] = coded_of(c[k] / static_cast<double>(pictures.size()));
    }
    return mean;
}

}  // namespace kino::test
