#pragma once

#include "base/image.h"
#include "calibration/rig.h"

namespace kino {

enum class ColorSampling : std::uint8_t { nearest, bilinear };

/// Colour resampled to the depth image's grid: for each depth pixel the colour at its `uv`
/// (RegisteredDepth::uv, so what is hidden from the colour camera has none). Alpha is 255 where
/// there is a colour; elsewhere the pixel is (0, 0, 0, 0), also where uv points outside `color`.
/// Bilinear blends the sRGB-encoded values as they are. `out` is resized and reused.
void register_color(const Image<ColorUv>& uv, const Image<Rgba8>& color, ColorSampling sampling,
                    Image<Rgba8>& out);

}  // namespace kino
