#pragma once

#include <volk.h>
#include <cstdint>

#include "base/image.h"
#include "viz/surface/surface_shared.h"

namespace kino {

/// The part of a depth frame that has readings: what is drawn, and the only part that costs. On a
/// stage people alone are left of a frame.
struct DepthBounds {
    std::uint32_t x0 = 0, y0 = 0;  ///< first column and row, px
    std::uint32_t x1 = 0, y1 = 0;  ///< one past the last; x1 == 0: no reading anywhere
    float nearest_m = 0;
    float farthest_m = 0;
    [[nodiscard]] bool empty() const { return x1 == 0; }
};
/// Readings are what is above 0 and finite.
[[nodiscard]] DepthBounds measure_depth_bounds(const Image<float>& depth_m);

/// Pixels of the picture outside of which nothing of the bounded frame is drawn, `margin_px` more
/// on each side; the whole picture where parts of it may lie behind the near plane. For plain
/// pinhole depth cameras (params.depth_k): all points lie in the hull of eight corners.
[[nodiscard]] VkRect2D picture_bounds(const shared::SurfaceParams& params,
                                      const DepthBounds& bounds, double margin_px);

}  // namespace kino
