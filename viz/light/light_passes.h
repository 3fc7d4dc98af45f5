#pragma once

#include "viz/graph/executor.h"
#include "viz/graph/graph.h"
#include "viz/scene/scene.h"
#include "viz/scene/view.h"
#include "viz/surface/depth_passes.h"
#include "viz/surface/depth_rasterizer.h"

namespace kino {

constexpr VkFormat kSceneLinearFormat = VK_FORMAT_R16G16B16A16_SFLOAT;

/// True where the scene calls for virtual light at all; if not, nothing of this room runs.
[[nodiscard]] bool wants_light(const Scene& scene);

/// Shades the surface with the scene's lights into a new linear RGBA16F texture. The surface must
/// have view_z and normal.
[[nodiscard]] graph::TextureId add_light_pass(graph::FrameGraph& graph, const Scene& scene,
                                              const View& view, const SurfaceTargets& surface);

/// Light at the rate of depth pixels: a colour for each of them, sRGB-coded RGBA8, exposure and
/// tone map included. Takes `inputs.normals`, which must be valid.
[[nodiscard]] graph::BufferId add_point_light_pass(graph::FrameGraph& graph, const Scene& scene,
                                                   const View& view, const DepthPassInputs& inputs);

/// True where highlights roll off; captured colours stay what they are.
[[nodiscard]] bool wants_tone_map(const Scene& scene);

/// Exposure, tone map, sRGB, dither, into `target`; returns its new id. `emitting`, where valid:
/// the picture's objects (SurfaceTargets::object), whose materials' emission is added before.
[[nodiscard]] graph::TextureId add_final_pass(graph::FrameGraph& graph, const Scene& scene,
                                              graph::TextureId scene_linear,
                                              graph::TextureId target,
                                              graph::TextureId emitting = {});

}  // namespace kino
