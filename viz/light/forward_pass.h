#pragma once

#include <cstdint>

#include "viz/graph/graph.h"
#include "viz/light/mesh_light.h"
#include "viz/scene/scene.h"
#include "viz/scene/view.h"
#include "viz/surface/mesh_drawer.h"

namespace kino {

/// Bits 1 << MaterialKind of the kinds that the scene's opaque meshes show.
[[nodiscard]] std::uint32_t opaque_kinds(const Scene& scene);
/// All kinds but layered ones, which the surface's own shading pass does.
constexpr std::uint32_t kForwardKinds =
    kAllKinds & ~(1u << static_cast<std::uint32_t>(MaterialKind::layered));

/// Draws the opaque meshes of the materials in `kinds` once more, each kind by its own shader under
/// the lights of `light`, into `linear` (kSceneLinearFormat, any number of samples), where `depth`
/// (as many samples) holds just their depths (GPU Pro 4, Tiled Forward Shading, 4.4). Adds nothing
/// where no mesh has such a material. Layered ones want `light.sample_z`. Returns the new ids.
struct ForwardTargets {
    graph::TextureId linear, depth;
};
[[nodiscard]] ForwardTargets add_forward_pass(graph::FrameGraph& graph, const Scene& scene,
                                              const View& view, const MeshDrawer& meshes,
                                              const MeshLight& light, std::uint32_t kinds,
                                              ForwardTargets targets);

}  // namespace kino
