#pragma once

#include <cstdint>

/// What the test driver's cameras see: a function of the place and the frame's number, known to the
/// driver and to the tests. Small, odd enough to show a wrong stride or a flip.
namespace kino::test::camera {

constexpr int kWidth = 44;
constexpr int kHeight = 30;
constexpr int kPeriodUs = 5000;

/// The frame's number stands in the first pixel, so that any frame can be told.
inline std::uint16_t depth_at(int x, int y, int index) {
    if (x == 0 && y == 0) return static_cast<std::uint16_t>(index & 0x3FF);
    if ((x * 7 + y * 3 + index) % 11 == 0) return 0;
    return static_cast<std::uint16_t>(500 + 13 * x + 29 * y + (index * 5) % 97);
}

/// Byte `byte` of the colour picture's row y.
inline std::uint8_t color_at(int byte, int y, int index) {
    return static_cast<std::uint8_t>(byte * 3 + y * 5 + index);
}

inline std::uint16_t infrared_at(int x, int y, int index) {
    return static_cast<std::uint16_t>((x * 11 + y * 17 + index) % 1024);
}

inline std::uint64_t time_us(int index) {
    return 1'000'000 + static_cast<std::uint64_t>(index) * kPeriodUs;
}

}  // namespace kino::test::camera
