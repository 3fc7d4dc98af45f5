#pragma once

#include <cstdint>

#include "viz/light/light_lists.h"

namespace kino {

/// Single pixels of a picture that are worked on again.
struct PixelList {
    graph::BufferId pixels;  ///< y << 16 | x
    /// VkDispatchIndirectCommand of workgroups of 64 at byte 0, the number of pixels at byte 12.
    graph::BufferId dispatch;
    std::uint32_t most = 0;  ///< there are never more
};

/// Shades the listed pixels of the surface as add_shade_pass() does, into `linear` (RGBA16F, made
/// with `storage`, of the size of `view`), and leaves the others. The lists must hold for every
/// pixel of the surface; shadow masks are one a listed pixel, in the order of the list.
[[nodiscard]] graph::TextureId add_shade_list(graph::FrameGraph& graph, const Scene& scene,
                                              const View& view, const ShadeInputs& inputs,
                                              const PixelList& list, graph::TextureId linear);

}  // namespace kino
