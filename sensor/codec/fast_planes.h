#pragma once

#include <cstddef>
#include <cstdint>

#include "sensor/codec/image_codec.h"

namespace kino::fast {

struct PlaneSize {
    int width = 0;
    int height = 0;
};

/// Planes that an 8-bit layout is cut into; 1 for gray16, which has no others. A plane may be
/// empty (the second column of a mosaic one pixel wide).
[[nodiscard]] int plane_count(PixelLayout layout);
[[nodiscard]] PlaneSize plane_size(const ImageFormat& format, int plane);

/// Samples + 1 of one plane of an 8-bit layout. gray8: the pixels. bayer8: even rows' even columns,
/// their odd columns, odd rows' even, odd rows' odd. rgb: green, then red and blue as difference to
/// green + 128 modulo 256, then alpha. yuv: Y, U, V.
void split(const ImageFormat& format, int plane, const std::uint8_t* pixels, std::uint16_t* out);
/// The way back, planes in order from 0; `in` holds 1 .. 256 or 0, which becomes 0, too.
void join(const ImageFormat& format, int plane, const std::uint16_t* in, std::uint8_t* pixels);

}  // namespace kino::fast
