#pragma once

#include <cstddef>
#include <cstdint>

/// Rows of the enlarging copy, in two sets that agree to the bit. Sums are of 16-bit products'
/// upper halves: a channel is 8 bits before the point and 8 behind it.
namespace kino::zoom_rows {

/// Pixels that a row may be written past its end.
constexpr std::size_t kSlack = 8;

/// What the pixels before, at and after a block's own count in each of its rows or columns, in
/// 1/65536; phases past z are 0. Weights are repeated for the four channels.
struct Taps {
    std::uint16_t before[8][4] = {};
    std::uint16_t at[8][4] = {};
    std::uint16_t after[8][4] = {};
};

struct Kernels {
    /// `count` pixels of `small`, z times each.
    void (*replicate)(const std::uint32_t* small, int count, int z, std::uint32_t* out);
    /// The same blurred along the row: four 16-bit channels a pixel.
    void (*blur)(const std::uint32_t* small, int count, int z, const Taps& taps,
                 std::uint16_t* out);
    /// A row of `count` pixels between three blurred ones; a null row counts nothing.
    void (*blend)(const std::uint16_t* before, const std::uint16_t* at, const std::uint16_t* after,
                  const std::uint16_t weights[3], int count, std::uint32_t* out);
};

const Kernels& portable();
const Kernels& avx2();  ///< call only where the processor has AVX2

}  // namespace kino::zoom_rows
