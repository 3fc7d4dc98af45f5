#include "sensor/v4l2/pixel_unpack.h"

namespace kino {
namespace {

std::uint16_t u16(unsigned value) {
    return static_cast<std::uint16_t>(value);
}

}  // namespace

void unpack_packed10(const std::uint8_t* packed, std::size_t count, std::uint16_t* out) {
    std::size_t i = 0;
    for (; i + 4 <= count; i += 4, packed += 5) {
        out[i] = u16(packed[0] << 2 | packed[1] >> 6);
        out[i + 1] = u16((packed[1] & 0x3f) << 4 | packed[2] >> 4);
        out[i + 2] = u16((packed[2] & 0x0f) << 6 | packed[3] >> 2);
        out[i + 3] = u16((packed[3] & 0x03) << 8 | packed[4]);
    }
    // What is left of a row that is no multiple of four: pixel k ends 2 (k + 1) bits into byte k+1.
    for (unsigned k = 0; i < count; ++i, ++k) {
        const unsigned pair = static_cast<unsigned>(packed[k]) << 8 | packed[k + 1];
        out[i] = u16(pair >> (6 - 2 * k) & 0x3ff);
    }
}

void widen_disparity10(std::uint16_t* values, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i)
        values[i] = values[i] == 1023 ? std::uint16_t{2047} : u16(values[i] * 2u);
}

void unpack_words(const std::uint8_t* bytes, std::size_t count, bool big_endian, std::uint16_t mask,
                  std::uint16_t* out) {
    const unsigned high = big_endian ? 0 : 1;
    for (std::size_t i = 0; i < count; ++i)
        out[i] = u16((bytes[2 * i + high] << 8 | bytes[2 * i + 1 - high]) & mask);
}

}  // namespace kino
