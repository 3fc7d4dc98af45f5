#include "sensor/session/crc32.h"

#include <array>
#include <bit>
#include <cstddef>
#include <cstring>

namespace kino {
namespace {

// Table k advances a byte's remainder by k further zero bytes: eight bytes are then one step.
using Tables = std::array<std::array<std::uint32_t, 256>, 8>;

constexpr Tables make_tables() {
    Tables tables{};
    for (std::uint32_t byte = 0; byte < 256; ++byte) {
        std::uint32_t rest = byte;
        for (int bit = 0; bit < 8; ++bit) rest = (rest >> 1) ^ ((rest & 1) ? 0xEDB88320u : 0u);
        tables[0][byte] = rest;
    }
    for (std::size_t k = 1; k < tables.size(); ++k) {
        for (std::size_t byte = 0; byte < 256; ++byte) {
            const std::uint32_t rest = tables[k - 1][byte];
            tables[k][byte] = (rest >> 8) ^ tables[0][rest & 0xFF];
        }
    }
    return tables;
}

constexpr Tables kTables = make_tables();

}  // namespace

std::uint32_t crc32(std::span<const std::uint8_t> bytes, std::uint32_t so_far) {
    static_assert(std::endian::native == std::endian::little);
    std::uint32_t rest = ~so_far;
    std::size_t i = 0;
    for (; i + 8 <= bytes.size(); i += 8) {
        std::array<std::uint32_t, 2> words{};
        std::memcpy(words.data(), bytes.data() + i, 8);
        words[0] ^= rest;
        rest = kTables[7][words[0] & 0xFF] ^ kTables[6][words[0] >> 8 & 0xFF] ^
               kTables[5][words[0] >> 16 & 0xFF] ^ kTables[4][words[0] >> 24] ^
               kTables[3][words[1] & 0xFF] ^ kTables[2][words[1] >> 8 & 0xFF] ^
               kTables[1][words[1] >> 16 & 0xFF] ^ kTables[0][words[1] >> 24];
    }
    for (; i < bytes.size(); ++i) rest = (rest >> 8) ^ kTables[0][(rest ^ bytes[i]) & 0xFF];
    return ~rest;
}

}  // namespace kino
