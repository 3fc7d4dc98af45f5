#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/frame.h"
#include "sensor/kinect1/packet_assembler.h"

namespace kino::test {

/// Bit i of the stream, the first byte's most significant one first.
inline unsigned bit_at(std::span<const std::uint8_t> bytes, std::size_t i) {
    return bytes[i / 8] >> (7 - i % 8) & 1u;
}

/// Value number `index` of `bits` bits, bit by bit.
inline unsigned value_at(std::span<const std::uint8_t> bytes, std::size_t index, int bits) {
    unsigned value = 0;
    for (int b = 0; b < bits; ++b) {
        value = value << 1 |
                bit_at(bytes, index * static_cast<std::size_t>(bits) + static_cast<std::size_t>(b));
    }
    return value;
}

/// For every pixel, whether one of its bits is in a missing byte.
inline std::vector<bool> lost_pixels(std::size_t pixels, int bits,
                                     const std::vector<bool>& byte_missing) {
    std::vector<bool> out(pixels);
    for (std::size_t p = 0; p < pixels; ++p) {
        for (std::size_t b = p * static_cast<std::size_t>(bits);
             b < (p + 1) * static_cast<std::size_t>(bits); ++b) {
            if (byte_missing[b / 8]) out[p] = true;
        }
    }
    return out;
}

inline std::vector<RowRange> rows_with(const std::vector<bool>& lost, int width) {
    std::vector<RowRange> out;
    const int height = static_cast<int>(lost.size()) / width;
    for (int y = 0; y < height; ++y) {
        bool any = false;
        for (int x = 0; x < width; ++x) any |= lost[static_cast<std::size_t>(y * width + x)];
        if (!any) continue;
        if (!out.empty() && out.back().first + out.back().count == y) {
            ++out.back().count;
        } else {
            out.push_back({y, 1});
        }
    }
    return out;
}

}  // namespace kino::test
