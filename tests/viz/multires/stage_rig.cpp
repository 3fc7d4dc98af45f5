#include "tests/viz/multires/stage_rig.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/packing.hpp>

#include "tests/viz/host_copies.h"
#include "viz/surface/mesh_shapes.h"

namespace kino::test {

Scene parts_scene() {
    Scene scene;
    scene.color_mode = ColorMode::relit;
    scene.ambient = glm::vec3(0.04f, 0.05f, 0.06f);
    scene.materials.push_back({.name = "wall", .base_color = glm::vec3(0.6f, 0.55f, 0.5f)});
    scene.materials.push_back({.name = "box", .base_color = glm::vec3(0.8f, 0.3f, 0.2f)});
    scene.materials.push_back({.name = "post", .base_color = glm::vec3(0.3f, 0.5f, 0.8f)});
    const auto add = [&](const glm::vec3& size, const glm::dvec3& place, std::uint32_t material,
                         double turn) {
        MeshNode node{.id = static_cast<std::uint32_t>(scene.meshes.size() + 1),
                      .mesh = make_box(size),
                      .material = material};
        node.world_from_object[0] = {std::cos(turn), 0, -std::sin(turn), 0};
        node.world_from_object[2] = {std::sin(turn), 0, std::cos(turn), 0};
        node.world_from_object[3] = glm::dvec4(place, 1);
        node.previous_world_from_object = node.world_from_object;
        scene.meshes.push_back(std::move(node));
    };
    add({5, 4, 0.2f}, {0, 0, -3.1}, 1, 0);
    add({5, 0.2f, 4}, {0, -1.1, -1.5}, 1, 0);
    add({0.2f, 4, 4}, {-1.7, 0, -1.5}, 1, 0);
    add({0.6f, 0.6f, 0.6f}, {0.5, -0.7, -2.2}, 2, 0.5);
    add({0.06f, 1.6f, 0.06f}, {-0.3, -0.2, -1.7}, 3, 0.2);
    scene.lights.push_back({.kind = LightKind::spot,
                            .position = {0.9, 0.4, -0.6},
                            .direction = {-1.2, -0.6, -0.8},
                            .color = glm::vec3(6, 5, 4),
                            .radius_m = 8,
                            .inner_rad = 0.3f,
                            .outer_rad = 0.45f,
                            .indirect = true});
    for (int i = 0; i < 2; ++i) {
        scene.lights.push_back({.kind = LightKind::point,
                                .position = {-1.0 + 1.8 * i, 0.9, -1.2 - 0.5 * i},
                                .color = i == 0 ? glm::vec3(0.5f, 0.4f, 0.3f) : glm::vec3(0.3f),
                                .radius_m = 4,
                                .shadow = LightShadow::raycast});
    }
    for (int i = 0; i < 20; ++i) {
        scene.lights.push_back(
            {.kind = LightKind::point,
             .position = {-1.4 + 0.7 * (i % 5), -0.6 + 0.45 * (i / 5), -2.6 + 0.1 * (i % 3)},
             .color = 0.05f * glm::vec3(1 + i % 3, 1 + i % 2, 2),
             .radius_m = 0.9f});
    }
    return scene;
}

View parts_view(int width, int height) {
    return {.width = width,
            .height = height,
            .projection = perspective(0.9, width, height),
            .world_from_view = look_at({0, 0, 0}, {0, -0.15, -1})};
}

StageRig::StageRig(gpu::Device& device)
    : device_(device),
      pipelines_(device),
      executor_(device, pipelines_),
      live_(device),
      meshes_(device),
      bvh_(device) {}

StageRig::~StageRig() {
    device_.wait_idle();
}

RigDrawn StageRig::draw(const Scene& scene, const View& view, const StageOptions& options) {
    return draw(scene, view, [&](graph::FrameGraph& graph, const StageParts& parts) {
        return add_stage(graph, scene, view, parts, options).linear;
    });
}

RigDrawn StageRig::draw(const Scene& scene, const View& view, const Make& make) {
    RigDrawn drawn;
    const auto fails = [](const auto& result) {
        EXPECT_TRUE(result) << (result ? "" : result.error().to_string());
        return !result;
    };
    if (fails(meshes_.upload(scene))) return drawn;
    if (wants_ray_shadows(scene) && fails(bvh_.upload(scene, {}))) return drawn;
    const std::size_t pixels =
        static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height);
    if (readback_.bytes() < pixels * 8) {
        readback_ = gpu::Buffer();
        auto made =
            gpu::Buffer::create(device_, "rig readback", pixels * 8, gpu::MemoryUse::readback);
        if (fails(made)) return drawn;
        readback_ = std::move(*made);
    }
    graph::FrameGraph graph(executor_.history());
    read_back(graph, make(graph, {live_, meshes_, bvh_}), readback_);
    const auto report = executor_.run(graph, graph::Timing::frame);
    if (fails(report)) return drawn;
    drawn.passes = report->passes;
    drawn.transient_bytes = report->transient_bytes;
    drawn.ms = to_ms(report->submit_to_fence);
    drawn.linear.resize(view.width, view.height);
    const auto halves = readback_.read<std::uint64_t>().first(pixels);
    std::transform(halves.begin(), halves.end(), drawn.linear.pixels().begin(),
                   [](std::uint64_t bits) { return glm::unpackHalf4x16(bits); });
    return drawn;
}

StageRig& shared_rig(gpu::Device& device) {
    static StageRig rig(device);
    return rig;
}

LightError light_error(const Image<glm::vec4>& light, const Image<glm::vec4>& truth) {
    LightError error;
    std::size_t count = 0;
    const auto shown = [](float v) { return std::sqrt(std::clamp(double{v}, 0.0, 1.0)); };
    for (std::size_t i = 0; i < truth.size(); ++i) {
        if (!(truth.pixels()[i].a > 0)) continue;
        for (int k = 0; k < 3; ++k) {
            const double d = shown(light.pixels()[i][k]) - shown(truth.pixels()[i][k]);
            error.mse += d * d;
            error.most = std::max(error.most, std::abs(d));
            ++count;
        }
    }
    error.mse /= static_cast<double>(std::max<std::size_t>(count, 1));
    return error;
}

}  // namespace kino::test
