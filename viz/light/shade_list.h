#pragma once

#include "viz/light/light_lists.h"
#include "viz/light/pixel_list.h"

namespace kino {

/// Shades the listed pixels of the surface as add_shade_pass() does, into `linear` (RGBA16F, made
/// with `storage`, of the size of `view`), and leaves the others. The lists must hold for every
/// pixel of the surface; shadow masks are one a listed pixel, in the order of the list.
[[nodiscard]] graph::TextureId add_shade_list(graph::FrameGraph& graph, const Scene& scene,
                                              const View& view, const ShadeInputs& inputs,
                                              const PixelList& list, graph::TextureId linear);

}  // namespace kino
