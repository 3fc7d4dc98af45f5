#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "viz/graph/executor.h"
#include "viz/graph/graph.h"
#include "viz/light/light_lists.h"
#include "viz/light/light_shared.h"
#include "viz/light/material_upload.h"
#include "viz/scene/scene.h"
#include "viz/scene/view.h"
#include "viz/surface/mesh_drawer.h"

namespace kino {

/// What fragment shaders of meshes need that walk light lists (viz/light/forward_head.glsl):
/// forward and blended passes share it.
struct MeshLight {
    LightLists lists;
    MaterialBuffers materials;
    graph::BufferId shadow_masks;  ///< as ShadeInputs has them; invalid: no light has a shadow
    /// With several samples a pixel: their view depths (add_sample_depths), and view depth and
    /// light at pixel centres.
    graph::TextureId sample_z, pixel_z, pixel_light;
    shared::ListShadeParams params{};
    std::uint32_t color_mode = 0;
};

/// `lists` may be of a larger picture of the same view. Adds the upload of the materials.
[[nodiscard]] MeshLight make_mesh_light(graph::FrameGraph& graph, const Scene& scene,
                                        const View& view, const LightLists& lists);
/// Declares what record_mesh_light() reads.
void declare_mesh_light(graph::PassBuilder& builder, const MeshLight& light);
/// A shader of that kind with bindings and constants; what it is drawn into is the caller's.
[[nodiscard]] MeshShader mesh_light_shader(const MeshLight& light, const std::string& name,
                                           std::span<const std::uint32_t> fragment);
[[nodiscard]] bool record_mesh_light(graph::PassContext& context, const MeshList& list,
                                     const MeshLight& light, const MeshShader& shader);

}  // namespace kino
