#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/image.h"

namespace kino {

/// ONI's depth codec: differences of neighbours in row order, in half bytes. With a table
/// ("16zT") the numbers are places in a rising list of the frame's values, put in front; without
/// ("16zP") they are the values.
///   table: u16 count, u16 values[count]; then both kinds: u16 first number; then bytes
///   hl, h and l below 13: two differences h - 6 and l - 6, old minus new; l = 13: only the first;
///   l = 15: the first, then a long one; 0xE0 + n: 2 n times no difference; 0xFF: a long one:
///   a byte >= 128 is a difference plus 192, else the high byte of the number, and the low one.
/// Whole frames only; at most 32,768 different values, since a long number has 15 bits.
///
/// None where the frame has more values than that.
[[nodiscard]] std::optional<std::vector<std::uint8_t>> encode_16z_table(
    std::span<const std::uint16_t> pixels);

/// False for bytes that no encoder makes of `out.size()` pixels: too few, too many, places outside
/// the table. Never reads or writes outside.
[[nodiscard]] bool decode_16z(std::span<const std::uint8_t> bytes, bool table,
                              std::span<std::uint16_t> out);
/// As decode_16z without the pixels.
[[nodiscard]] bool check_16z(std::span<const std::uint8_t> bytes, bool table, std::size_t pixels);

}  // namespace kino
