#pragma once

#include <cstddef>
#include <cstdint>

// Plain data and function pointers only: this header is also read by code compiled for AVX2, whose
// inline functions must not reach the rest of the program.

namespace kino::kinect1 {

/// The sensor's packed pixels to 16 bits each. Packed values follow one another from the most
/// significant bit of the first byte on. `packed` holds exactly n values and nothing beyond them
/// is read; n is a multiple of 8 for eleven bits and of 4 for ten. Every implementation gives the
/// same bits.
struct Unpacker {
    void (*eleven)(const std::uint8_t* packed, std::size_t n, std::uint16_t* out);
    void (*ten)(const std::uint8_t* packed, std::size_t n, std::uint16_t* out);
    /// Depth in ten bits as DepthUnit::kinect_disparity11 wants it: twice the value, 2047 for 1023.
    void (*ten_doubled)(const std::uint8_t* packed, std::size_t n, std::uint16_t* out);
    const char* name;
};

extern const Unpacker kPortableUnpacker;
extern const Unpacker kAvx2Unpacker;  // only after best_unpacker() or an own check

/// The fastest that this processor can run.
[[nodiscard]] const Unpacker& best_unpacker();

}  // namespace kino::kinect1
