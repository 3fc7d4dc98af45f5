#pragma once

#include <cstdint>
#include <span>

namespace kino {

/// The CRC-32 of IEEE 802.3 (reflected polynomial EDB88320, start and end inverted), as EBML's
/// CRC-32 element wants it (RFC 8794, 11.3.1). `so_far` continues an earlier answer.
[[nodiscard]] std::uint32_t crc32(std::span<const std::uint8_t> bytes, std::uint32_t so_far = 0);

}  // namespace kino
