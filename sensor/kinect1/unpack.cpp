#include "sensor/kinect1/unpack.h"

namespace kino::kinect1 {
namespace {

constexpr std::uint16_t low11(unsigned value) {
    return static_cast<std::uint16_t>(value & 0x7FFu);
}
constexpr std::uint16_t low10(unsigned value) {
    return static_cast<std::uint16_t>(value & 0x3FFu);
}
constexpr std::uint16_t doubled(std::uint16_t value) {
    return static_cast<std::uint16_t>(2 * value + (value == 1023 ? 1 : 0));
}

void eleven(const std::uint8_t* p, std::size_t n, std::uint16_t* out) {
    for (std::size_t i = 0; i < n; i += 8, p += 11, out += 8) {
        // Three bytes hold any of the eight; the shift brings its last bit to the end.
        const auto bits = [p](int byte) {
            return static_cast<unsigned>(p[byte]) << 16 | static_cast<unsigned>(p[byte + 1]) << 8 |
                   p[byte + 2];
        };
        out[0] = low11(bits(0) >> 13);
        out[1] = low11(bits(1) >> 10);
        out[2] = low11(bits(2) >> 7);
        out[3] = low11(bits(4) >> 12);
        out[4] = low11(bits(5) >> 9);
        out[5] = low11(bits(6) >> 6);
        out[6] = low11(bits(8) >> 11);
        out[7] = low11(static_cast<unsigned>(p[9]) << 8 | p[10]);
    }
}

template <bool kDouble>
void ten_bits(const std::uint8_t* p, std::size_t n, std::uint16_t* out) {
    for (std::size_t i = 0; i < n; i += 4, p += 5, out += 4) {
        const auto bits = [p](int byte) {
            return static_cast<unsigned>(p[byte]) << 8 | p[byte + 1];
        };
        const std::uint16_t values[4] = {low10(bits(0) >> 6), low10(bits(1) >> 4),
                                         low10(bits(2) >> 2), low10(bits(3))};
        for (int k = 0; k < 4; ++k) out[k] = kDouble ? doubled(values[k]) : values[k];
    }
}

}  // namespace

const Unpacker kPortableUnpacker = {eleven, ten_bits<false>, ten_bits<true>, "portable"};

const Unpacker& best_unpacker() {
    static const bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
    return avx2 ? kAvx2Unpacker : kPortableUnpacker;
}

}  // namespace kino::kinect1
