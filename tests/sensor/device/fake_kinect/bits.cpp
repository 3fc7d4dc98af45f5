#include "tests/sensor/device/fake_kinect/bits.h"

namespace kino::fake {

std::vector<std::uint8_t> pack_bits(std::span<const std::uint16_t> values, int bits) {
    std::vector<std::uint8_t> bytes((values.size() * static_cast<std::size_t>(bits) + 7) / 8);
    std::size_t at = 0;
    std::uint32_t pending = 0;
    int held = 0;
    for (const std::uint16_t value : values) {
        pending = (pending << bits) | (value & ((1u << bits) - 1));
        held += bits;
        while (held >= 8) {
            held -= 8;
            bytes[at++] = static_cast<std::uint8_t>(pending >> held);
        }
        pending &= (1u << held) - 1;
    }
    if (held > 0) bytes[at] = static_cast<std::uint8_t>(pending << (8 - held));
    return bytes;
}

namespace {

std::uint64_t finish(std::uint64_t z) {
    z += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

}  // namespace

std::uint64_t mix(std::uint64_t a, std::uint64_t b, std::uint64_t c, std::uint64_t d) {
    return finish(finish(finish(finish(a) ^ b) ^ c) ^ d);
}

void put_u16(std::vector<std::uint8_t>& bytes, unsigned value) {
    bytes.push_back(static_cast<std::uint8_t>(value));
    bytes.push_back(static_cast<std::uint8_t>(value >> 8));
}

void put_u32(std::vector<std::uint8_t>& bytes, std::uint32_t value) {
    put_u16(bytes, value & 0xffff);
    put_u16(bytes, value >> 16);
}

std::uint16_t get_u16(std::span<const std::uint8_t> bytes, std::size_t offset) {
    return static_cast<std::uint16_t>(bytes[offset] | (bytes[offset + 1] << 8));
}

}  // namespace kino::fake
