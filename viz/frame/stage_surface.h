#pragma once

#include "viz/frame/stage.h"
#include "viz/graph/graph.h"
#include "viz/light/light_lists.h"
#include "viz/scene/scene.h"
#include "viz/scene/view.h"
#include "viz/surface/depth_rasterizer.h"
#include "viz/surface/mesh_drawer.h"

namespace kino {

struct DrawnSurface {
    SurfaceTargets surface;
    graph::TextureId depth;  ///< kDepthFormat; invalid without meshes
};

/// Live frame or background: albedo, depth, normal and, if asked for, ids; no objects.
[[nodiscard]] SurfaceTargets add_ground(graph::FrameGraph& graph, const Scene& scene,
                                        const View& view, const StageParts& parts,
                                        RasterPath raster, bool ids);
/// A picture (kObjectFormat) of nothing but material 0.
[[nodiscard]] graph::TextureId add_no_objects(graph::FrameGraph& graph, const View& view);
/// Meshes over a ground.
[[nodiscard]] DrawnSurface add_meshes(graph::FrameGraph& graph, const View& view,
                                      const StageParts& parts, const MeshList& list,
                                      SurfaceTargets surface);
/// Both: all that is opaque.
[[nodiscard]] DrawnSurface add_surface(graph::FrameGraph& graph, const Scene& scene,
                                       const View& view, const StageParts& parts, RasterPath raster,
                                       bool ids);
/// What the bouncing lights shine on, as lights.
[[nodiscard]] SpawnedLights add_bounces(graph::FrameGraph& graph, const Scene& scene,
                                        const View& view, const StageParts& parts,
                                        const StageOptions& options);

}  // namespace kino
