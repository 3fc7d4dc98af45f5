#pragma once

#include <cstdint>

#include "base/image.h"

namespace kino::reference {

/// A pixel's channel as a number; pixels are four bytes in a word.
[[nodiscard]] double channel(std::uint32_t pixel, int channel);

/// Channel `c` of `small` between the centres of its blocks of z x z, at pixel (x, y) of the
/// enlarged picture: bilinear, the border's pixel beyond the border.
[[nodiscard]] double zoom_bilinear(const Image<std::uint32_t>& small, int z, int c, int x, int y);

/// Channel `c` of the enlarged picture after `passes` of a box of width z (even z: z + 1 pixels,
/// the outer two by half) along both axes: sums over every pixel, blocks repeated beyond the
/// border.
[[nodiscard]] double zoom_boxes(const Image<std::uint32_t>& small, int z, int passes, int c, int x,
                                int y);

}  // namespace kino::reference
