#pragma once

#include "viz/frame/stage.h"

namespace kino {

/// True where the options ask for several samples and the scene has edges for them: meshes.
[[nodiscard]] bool wants_samples(const Scene& scene, const StageOptions& options);

/// The stage with four samples a pixel (GPU Pro 4, Tiled Forward Shading, 4.4): live frame and
/// background are drawn and shaded as always and put into every sample, meshes get a depth prepass,
/// tiles the bounds of all samples, and every mesh is shaded where it is drawn, once for each pixel
/// that it covers a sample of; what covers a pixel whole takes the light of the picture with one
/// sample, which is drawn as always. Blended surfaces follow, then one sample a pixel is left.
/// Edges of the live frame stay as they are. `surface` and `depth` of the result have one sample.
[[nodiscard]] Stage add_multisampled_stage(graph::FrameGraph& graph, const Scene& scene,
                                           const View& view, const StageParts& parts,
                                           const StageOptions& options);

}  // namespace kino
