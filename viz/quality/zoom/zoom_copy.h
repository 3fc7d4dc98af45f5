#pragma once

#include <cstdint>
#include <glm/vec2.hpp>

#include "base/image.h"
#include "viz/quality/zoom/zoom_options.h"

namespace kino {

/// Copies `small` into `out`, every pixel z times along each side; z in 1 .. kMaxZoom. A pixel is
/// four channels of a byte, in whatever order. `out`'s pixel (x, y) is pixel (x, y) + `offset` of
/// the enlarged picture, the nearest one where that lies outside. The blur is part of the copy:
/// with `box`, pixels are the bilinear blend of `small` between the centres of blocks, rounded to
/// nearest within 1/32 of a step. Pitches may be anything that holds a row, but `small` and `out`
/// must not overlap. Returns how many pixels of `out` lay outside.
std::int64_t enlarge(const ImageView<const std::uint32_t>& small, int z, ZoomBlur blur,
                     const ImageView<std::uint32_t>& out, glm::ivec2 offset = {0, 0});

/// The same bits without SIMD.
std::int64_t enlarge_portable(const ImageView<const std::uint32_t>& small, int z, ZoomBlur blur,
                              const ImageView<std::uint32_t>& out, glm::ivec2 offset = {0, 0});

}  // namespace kino
