#pragma once

#include "viz/graph/graph.h"
#include "viz/light/host_lists.h"
#include "viz/scene/scene.h"
#include "viz/scene/view.h"
#include "viz/surface/depth_rasterizer.h"

namespace kino::test {

/// What Forward+ is measured against. All shade a picture of material 0 under point lights and
/// return linear RGBA16F.

/// Compute-based deferred lighting: culls and adds up in one pass of 8x8 work groups, 16 bytes a
/// pixel out; a last pass multiplies by the albedo.
[[nodiscard]] graph::TextureId add_deferred(graph::FrameGraph& graph, const Scene& scene,
                                            const View& view, const SurfaceTargets& surface);

/// A grid of clusters, filled by the host, 32 px wide and `slices` deep.
[[nodiscard]] graph::TextureId add_clustered(graph::FrameGraph& graph, const Scene& scene,
                                             const View& view, const SurfaceTargets& surface,
                                             std::uint32_t slices = 24);

/// The lists of make_host_lists() by way of a tree over the lights: every tile walks the tree with
/// its four planes.
[[nodiscard]] HostLists make_tree_lists(const PackedLights& packed, const View& view,
                                        std::uint32_t tile_px);

}  // namespace kino::test
