#pragma once

#include "viz/frame/stage.h"
#include "viz/frame/stage_surface.h"
#include "viz/surface/sample_surface.h"

namespace kino {

/// True where the options ask for edges smoothed from the buffers that framebuffer LOD has (four
/// samples together with lod, whose r may be 1), and the scene has edges for it: meshes.
[[nodiscard]] bool wants_edge_samples(const Scene& scene, const StageOptions& options);

/// add_surface(), and beside it what every sample of a pixel shows. Without a mesh in sight
/// `samples` stays invalid.
[[nodiscard]] DrawnSurface add_sampled_surface(graph::FrameGraph& graph, const Scene& scene,
                                               const View& view, const StageParts& parts,
                                               const StageOptions& options, SampleTargets* samples);

/// Lists the pixels that show more than one surface (viz/quality/lod_samples.h). Each of their
/// samples takes its light from the 3x3 pixels of `linear` around it by Eq. 1 with its own depth,
/// normal, object and colour; the pixel becomes the samples' mean (`options.resolve`). All other
/// pixels keep their bits. `linear` is all that is opaque, emission included, seen at pixel centres
/// on `surface`, and a transient. Nothing for samples that are not valid.
[[nodiscard]] graph::TextureId add_edge_samples(graph::FrameGraph& graph, const Scene& scene,
                                                const View& view, const SampleTargets& samples,
                                                const SurfaceTargets& surface,
                                                graph::TextureId linear,
                                                const StageOptions& options);

}  // namespace kino
