#pragma once

#include <optional>

#include "viz/accel/scene_bvh.h"
#include "viz/graph/graph.h"
#include "viz/light/indirect.h"
#include "viz/light/light_lists.h"
#include "viz/light/light_parts.h"
#include "viz/light/multisample.h"
#include "viz/light/ray_shadows.h"
#include "viz/quality/framebuffer_lod.h"
#include "viz/quality/lod_regions.h"
#include "viz/scene/scene.h"
#include "viz/scene/view.h"
#include "viz/surface/depth_rasterizer.h"
#include "viz/surface/mesh_drawer.h"

namespace kino {

/// True where the picture is made surface first, then light: a scene with meshes, with more local
/// lights than a shader should walk, or with light that bounces. Without either, the live frame
/// takes its light before it is drawn, or none at all, and nothing of this file runs.
[[nodiscard]] bool wants_stage(const Scene& scene);

struct StageOptions {
    RasterPath raster = RasterPath::compute;
    LightListOptions lists;
    RayShadowOptions shadows;
    BounceOptions bounces;
    std::optional<FramebufferLodOptions> lod;
    /// Parts of the light that are shaded coarser or finer than `lod` says, or without it; not with
    /// four samples forward.
    PartRates rates;
    /// Set: light is coarser than `lod` says in tiles where that will do, with `lod` or without;
    /// its parts are not told apart then.
    std::optional<RegionLodOptions> regions;
    /// Set: a coarse picture may be finished on its way to full size, where nothing is drawn over
    /// it or added to it.
    std::optional<LodFinish> finish;
    bool read_ids = false;  ///< the surface gets ids
    /// 4: meshes are shaded forward with four samples a pixel (multisampled_stage.h). Together with
    /// lod, whose r may be 1: light is worked out as with one sample, and edges are smoothed from
    /// what is there (supersampled_stage.h).
    std::uint32_t samples = 1;
    SampleResolve resolve = SampleResolve::as_shown;
    float edge_share = 0.25f;  ///< with lod and samples: at most this share of the picture is edge
};

/// What a staged picture was made from, for readers after it.
struct Stage {
    graph::TextureId linear;  ///< scene-linear light, RGBA16F
    /// Valid: StageOptions::finish's target, finished; there is no linear one then.
    graph::TextureId picture;
    /// Valid: objects whose emission is not in `linear` yet (add_final_pass takes it).
    graph::TextureId emitting;
    SurfaceTargets surface;
    graph::TextureId depth;  ///< kDepthFormat; invalid without meshes
    LightLists lists;
    LodFixList fixed;  ///< valid: pixels of a coarse picture that were shaded anew
};

/// What is on the device for a stage, brought up to date for this frame's scene.
struct StageParts {
    const DepthRasterizer& live;
    const MeshDrawer& meshes;
    SceneBvh& bvh;
};

/// Adds visibility, surface, light lists, shadows, shading, reconstruction and blended surfaces, as
/// far as the scene and the options call for them.
[[nodiscard]] Stage add_stage(graph::FrameGraph& graph, const Scene& scene, const View& view,
                              const StageParts& parts, const StageOptions& options);

/// Packed sRGB RGBA8 of a colour in [0, 1].
[[nodiscard]] std::uint32_t pack_srgb(const glm::vec3& color);

}  // namespace kino
