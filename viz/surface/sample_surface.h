#pragma once

#include <cstdint>

#include "viz/graph/graph.h"
#include "viz/scene/view.h"
#include "viz/surface/mesh_drawer.h"

namespace kino {

constexpr std::uint32_t kSurfaceSamples = 4;

/// The thin surface with four samples a pixel, as viz/surface/sample_surface.glsl packs it. A
/// sample holds what covers its place, and that as it is at the pixel's centre, where the surface's
/// own plane meets the centre's ray (the rules of multisampling).
struct SampleTargets {
    graph::TextureId texel;  ///< RGBA32F: all of it
    graph::TextureId depth;  ///< kDepthFormat
    [[nodiscard]] bool valid() const { return texel.valid(); }
};

/// `ground` (live frame or background: albedo, view_z and normal) into every sample, and the meshes
/// of the list over it: two passes, or one that starts from is_backdrop() where the ground is
/// nothing but background. Nothing is made for an empty list.
[[nodiscard]] SampleTargets add_sample_surface(graph::FrameGraph& graph, const View& view,
                                               const SurfaceTargets& ground, const MeshList& list,
                                               bool background_only);

}  // namespace kino
