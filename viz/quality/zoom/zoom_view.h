#pragma once

#include "viz/scene/view.h"

namespace kino {

/// The zoom that a picture of this size can have: `wanted` within 1 .. min(kMaxZoom, width,
/// height).
[[nodiscard]] int usable_zoom(int wanted, int width, int height);

/// The view whose picture, enlarged `z` times, is `view`'s: ceil(W/z) x ceil(H/z) pixels, each
/// centred on the block it becomes, and `guard_px` pixels (small ones) more on every side. Rays
/// through a block's centre, hence the picture's centre and scale, are those of `view`; the surplus
/// to the right and below is cut off.
[[nodiscard]] View zoomed_view(const View& view, int z, int guard_px = 0);

}  // namespace kino
