#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace kino {

/// A. D. Wilson, Fast lossless depth image compression, ISS 2017: runs of zeros and of others, the
/// others as zigzag differences, all in 4-bit groups of 3 bits; here 32-bit words of 8 groups,
/// first group highest, words little-endian, the last one filled with zeros.

/// Most bytes that `pixels` can take: six groups for a difference of 17 bits, and the runs.
[[nodiscard]] constexpr std::size_t rvl_bound_bytes(std::size_t pixels) {
    return 4 * ((6 * pixels + 32) / 8 + 1);
}

/// Bytes written; `out` holds at least rvl_bound_bytes(). `pixels` are little-endian 16-bit values.
[[nodiscard]] std::size_t rvl_encode(std::span<const std::uint8_t> pixels,
                                     std::span<std::uint8_t> out);

/// False if `data` is not exactly one picture of this size as rvl_encode() writes it: a value out
/// of 1 .. 65535, an empty run other than the first, too little or too much data.
[[nodiscard]] bool rvl_decode(std::span<const std::uint8_t> data, std::span<std::uint8_t> pixels);

}  // namespace kino
