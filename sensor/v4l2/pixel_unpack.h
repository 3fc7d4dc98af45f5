#pragma once

#include <cstddef>
#include <cstdint>

namespace kino {

/// `count` pixels of 10 bits, most significant bit first, without gaps: pixel i starts at bit
/// 10 i. Reads (10 count + 7) / 8 bytes and writes `count` values in 0..1023.
void unpack_packed10(const std::uint8_t* packed, std::size_t count, std::uint16_t* out);

/// 10-bit Kinect disparity to the 11-bit scale in place: twice the count, and 1023 (no reading)
/// to 2047.
void widen_disparity10(std::uint16_t* values, std::size_t count);

/// 16-bit words of either order; bits outside `mask` are cleared.
void unpack_words(const std::uint8_t* bytes, std::size_t count, bool big_endian, std::uint16_t mask,
                  std::uint16_t* out);

}  // namespace kino
