#pragma once

#include <cstdint>
#include <span>

#include "base/error.h"
#include "base/image.h"

namespace kino {

/// Baseline or progressive JPEG as RGBA. Fails where it is damaged, cut off, or not of the
/// expected size.
[[nodiscard]] Result<void> decode_jpeg(std::span<const std::uint8_t> bytes, int width, int height,
                                       Image<Rgba8>& out);

}  // namespace kino
