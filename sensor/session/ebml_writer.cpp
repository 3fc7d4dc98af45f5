#include "sensor/session/ebml_writer.h"

#include <array>
#include <bit>

#include "base/check.h"
#include "sensor/session/crc32.h"

namespace kino {
namespace {

int bytes_of_number(std::uint64_t value) {
    int bytes = 1;
    while (bytes < 8 && value >> (8 * bytes) != 0) ++bytes;
    return bytes;
}

}  // namespace

void EbmlWriter::put_big_endian(std::uint64_t value, int bytes) {
    for (int i = bytes - 1; i >= 0; --i) {
        bytes_.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
    }
}

void EbmlWriter::put_id(ebml::Id id) {
    put_big_endian(id, bytes_of_number(id));
}

void EbmlWriter::put_size(std::uint64_t size) {
    int bytes = 1;
    // All ones in a length means "unknown", so the last value of each length is left out.
    while (size >= (std::uint64_t{1} << (7 * bytes)) - 1) ++bytes;
    KINO_CHECK_LE(bytes, 8);
    put_big_endian(size | std::uint64_t{1} << (7 * bytes), bytes);
}

void EbmlWriter::put_head(ebml::Id id, std::uint64_t size) {
    put_id(id);
    put_size(size);
}

void EbmlWriter::put_unsigned(ebml::Id id, std::uint64_t value) {
    const int bytes = bytes_of_number(value);
    put_head(id, static_cast<std::uint64_t>(bytes));
    put_big_endian(value, bytes);
}

void EbmlWriter::put_signed(ebml::Id id, std::int64_t value) {
    put_head(id, 8);
    put_big_endian(static_cast<std::uint64_t>(value), 8);
}

void EbmlWriter::put_float(ebml::Id id, double value) {
    put_head(id, 8);
    put_big_endian(std::bit_cast<std::uint64_t>(value), 8);
}

void EbmlWriter::put_text(ebml::Id id, std::string_view text) {
    put_binary(id, {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

void EbmlWriter::put_binary(ebml::Id id, std::span<const std::uint8_t> bytes) {
    put_head(id, bytes.size());
    put_raw(bytes);
}

void EbmlWriter::put_checked_master(ebml::Id id, const EbmlWriter& content) {
    put_head(id, content.size() + 6);
    const std::uint32_t sum = crc32(content.bytes());
    std::array<std::uint8_t, 4> little{};
    for (std::size_t i = 0; i < 4; ++i) little[i] = static_cast<std::uint8_t>(sum >> (8 * i));
    put_binary(ebml::kCrc32, little);
    put_raw(content.bytes());
}

void EbmlWriter::put_void(std::size_t size) {
    KINO_CHECK_LE(std::size_t{2}, size);
    put_id(ebml::kVoid);
    if (size < 128) {
        bytes_.push_back(static_cast<std::uint8_t>(0x80 | (size - 2)));
        bytes_.resize(bytes_.size() + size - 2);
    } else {
        put_big_endian((size - 9) | std::uint64_t{1} << 56, 8);
        bytes_.resize(bytes_.size() + size - 9);
    }
}

void EbmlWriter::put_raw(std::span<const std::uint8_t> bytes) {
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
}

}  // namespace kino
