#pragma once

#include "viz/graph/graph.h"

namespace kino {

struct GuidedDepthOptions {
    float sigma_luma = 0.1f;  ///< of sRGB-coded luminance, 0 to 1; infinite: colour does not count
    float same_surface = 0.025f;  ///< depths nearer to each other than this share are one surface's
    /// Depth pixel j stands at pixel (j + 1/2) W / w - 1/2 + offset_px of the colour picture.
    float offset_px = 0;
};

/// Brings depth (R32F, metres; no positive number: no reading) to the size of a colour picture
/// (RGBA8, sRGB; alpha 0: not known, does not count) of the same view: joint bilateral upsampling
/// (Kopf et al. 2007) by the kernel of framebuffer_lod.h, with luminance for a guide. Each pixel
/// gets a mean over one surface only, the one that most of the weight is of, so no depth lies
/// between two surfaces; a pixel has a reading where the nearest depth pixel has one. Neither side
/// of `depth` may be larger than the colour's. One pass, R32F.
[[nodiscard]] graph::TextureId add_guided_depth(graph::FrameGraph& graph, graph::TextureId depth,
                                                graph::TextureId color,
                                                const GuidedDepthOptions& options = {});

}  // namespace kino
