#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "sensor/codec/image_codec.h"

namespace kino::reference {

/// Slow decoders written from docs/session-codec.md alone, sharing no code with the product. They
/// answer the pixels, or nothing for what is no frame.
[[nodiscard]] std::optional<std::vector<std::uint8_t>> decode_fast(
    const ImageFormat& format, const std::vector<std::uint8_t>& frame);

/// What stands in the zstd frame of rvl+zstd.
[[nodiscard]] std::optional<std::vector<std::uint8_t>> decode_rvl(
    const std::vector<std::uint8_t>& groups, std::size_t pixels);

}  // namespace kino::reference
