#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "viz/accel/traverse.h"
#include "viz/light/light_shared.h"
#include "viz/light/ray_shadows.h"
#include "viz/light/shadow_shared.h"

namespace kino::test {

/// Triangles as a mesh of a scene.
[[nodiscard]] MeshNode mesh_node(const std::vector<Triangle>& triangles, std::uint32_t id = 1);

/// A room full of balls with lights in it, seen from a corner, and what a rasteriser would have
/// made of it. The room stands away from the world's origin.
struct ShadowStage {
    struct Options {
        int width = 66, height = 47;
        int balls = 7, rings = 10;
        int lights = 40;
        double smallest_radius = 1.5, largest_radius = 4;
        bool spots = true;       ///< every third one
        bool unshadowed = true;  ///< every fourth one
        bool hole = true;        ///< nothing in a corner of the picture but for one pixel
    };
    explicit ShadowStage(const Options& options);

    Scene scene;
    View view;
    std::vector<float> view_z;
    std::vector<std::array<std::int16_t, 2>> normals;  ///< octahedral
    [[nodiscard]] std::size_t at(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(view.width) +
               static_cast<std::size_t>(x);
    }
};

/// Something in the middle of the stage's room as a depth camera under the ceiling would see it: a
/// bent shell, and nothing round it.
[[nodiscard]] LiveDepth live_shell(const ShadowStage& stage, int width, int height);

/// What the device made of a stage.
struct ShadowCast {
    std::vector<glm::uvec4> masks;
    shared::ShadowCounters counters{};
    std::vector<shared::LightRecord> lights;
    std::vector<glm::uvec2> headers;
    std::vector<std::uint32_t> indices;
    LightLists lists;
    double shadow_ms = 0;
    double build_ms = 0;  ///< of trees by passes
};
/// Throws std::runtime_error where the device fails.
[[nodiscard]] ShadowCast cast_shadows(gpu::Device& device, graph::Executor& executor,
                                      const ShadowStage& stage, SceneBvh& bvh,
                                      const RayShadowOptions& options);

/// A ray that a pixel sends, as the processor counts them: lights in single precision as the
/// device does, the ray itself in double.
struct ShadowRay {
    std::uint32_t slot;
    Ray ray;
};
[[nodiscard]] std::vector<ShadowRay> shadow_rays(const ShadowStage& stage, const ShadowCast& cast,
                                                 const glm::dvec3& center, float offset, int x,
                                                 int y);

[[nodiscard]] inline bool shadow_bit(const glm::uvec4& mask, std::uint32_t slot) {
    return ((mask[static_cast<int>(slot / 32)] >> (slot % 32)) & 1u) != 0;
}

}  // namespace kino::test
