#pragma once

#include "base/error.h"
#include "base/frame.h"
#include "base/image.h"

namespace kino {

/// Any delivered colour as RGBA, alpha 255 (rgba8 keeps its own), still sRGB-encoded. `out` is
/// resized and reuses its memory.
/// - uyvy, yuyv: the frame's matrix (ITU-R BT.601 or BT.709) and range (full 0..255, or limited
///   16..235 and 16..240); both pixels of a pair take the pair's chroma. Within 1/255 of the
///   formula in exact arithmetic. Width must be even.
/// - bayer_grbg8: bilinear; the image is mirrored at its border, which keeps the colour pattern.
///   Both sizes at least 2.
/// - mjpeg: as JFIF says always BT.601 full range, whatever the frame states. A picture that is
///   cut off is an error; harmless oddities that webcams produce are not.
/// Fails where the bytes do not fill the stated size.
[[nodiscard]] Result<void> to_rgba8(const ColorFrame& frame, Image<Rgba8>& out);

}  // namespace kino
