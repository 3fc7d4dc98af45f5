#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace kino::fake {

/// Each value in `bits` bits (1 .. 16), most significant first, without gaps; the last byte is
/// filled with zeros.
[[nodiscard]] std::vector<std::uint8_t> pack_bits(std::span<const std::uint16_t> values, int bits);

/// One 64-bit number from several, the same on all machines (SplitMix64's finaliser, Steele 2014).
[[nodiscard]] std::uint64_t mix(std::uint64_t a, std::uint64_t b = 0, std::uint64_t c = 0,
                                std::uint64_t d = 0);

/// Little-endian numbers at the end of `bytes`.
void put_u16(std::vector<std::uint8_t>& bytes, unsigned value);
void put_u32(std::vector<std::uint8_t>& bytes, std::uint32_t value);

/// A little-endian number at `offset`, which lies inside.
[[nodiscard]] std::uint16_t get_u16(std::span<const std::uint8_t> bytes, std::size_t offset);

}  // namespace kino::fake
