#pragma once

#include <cstddef>
#include <cstdint>

#include "sensor/codec/image_codec.h"

struct AVFrame;

namespace kino {

/// The AVPixelFormat that libavcodec's FFV1 keeps a layout in: gray16le, gray, bgr0, bgra, yuv422p.
[[nodiscard]] int ffv1_pixel_format(PixelLayout layout);

/// Between our packed pixels and the planes of a frame of that format and of the picture's size.
void pack_to_frame(const ImageFormat& format, const std::uint8_t* pixels, AVFrame& frame);
void unpack_from_frame(const ImageFormat& format, const AVFrame& frame, std::uint8_t* pixels);

}  // namespace kino
