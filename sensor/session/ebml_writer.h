#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "sensor/session/ebml_ids.h"

namespace kino {

/// EBML elements (RFC 8794) laid one after another in memory. Numbers take as few bytes as they
/// need; masters are built as a writer of their own and put in whole, so sizes are always known.
class EbmlWriter {
  public:
    void put_unsigned(ebml::Id id, std::uint64_t value);
    void put_signed(ebml::Id id, std::int64_t value);  ///< always 8 bytes (DateUTC)
    void put_float(ebml::Id id, double value);         ///< always 8 bytes
    void put_text(ebml::Id id, std::string_view text);
    void put_binary(ebml::Id id, std::span<const std::uint8_t> bytes);
    void put_master(ebml::Id id, const EbmlWriter& content) { put_binary(id, content.bytes()); }
    /// As put_master, a CRC-32 of the content going first.
    void put_checked_master(ebml::Id id, const EbmlWriter& content);
    /// A Void of `size` bytes in all, 2 or more.
    void put_void(std::size_t size);
    /// The head of an element whose `size` content bytes are put next.
    void put_head(ebml::Id id, std::uint64_t size);
    void put_raw(std::span<const std::uint8_t> bytes);
    void put_byte(std::uint8_t byte) { bytes_.push_back(byte); }
    void put_big_endian(std::uint64_t value, int bytes);

    [[nodiscard]] std::size_t size() const { return bytes_.size(); }
    [[nodiscard]] std::span<const std::uint8_t> bytes() const { return bytes_; }
    void clear() { bytes_.clear(); }
    [[nodiscard]] std::vector<std::uint8_t> take() { return std::move(bytes_); }

  private:
    void put_id(ebml::Id id);
    void put_size(std::uint64_t size);

    std::vector<std::uint8_t> bytes_;
};

}  // namespace kino
