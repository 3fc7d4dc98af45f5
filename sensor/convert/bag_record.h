#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace kino {

/// Little-endian values off the front of bytes; past the end it gives zeros and turns bad.
class BagCursor {
  public:
    explicit BagCursor(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

    [[nodiscard]] std::uint64_t number(std::size_t bytes);
    [[nodiscard]] std::uint8_t u8() { return static_cast<std::uint8_t>(number(1)); }
    [[nodiscard]] std::uint32_t u32() { return static_cast<std::uint32_t>(number(4)); }
    [[nodiscard]] float f32();
    [[nodiscard]] double f64();
    /// A length in 4 bytes, and as much.
    [[nodiscard]] std::span<const std::uint8_t> counted();
    [[nodiscard]] std::string text();
    [[nodiscard]] std::span<const std::uint8_t> take(std::size_t count);
    [[nodiscard]] std::size_t left() const { return bytes_.size(); }
    [[nodiscard]] bool good() const { return good_; }

  private:
    std::span<const std::uint8_t> bytes_;
    bool good_ = true;
};

/// The fields of a record's header that are known here.
struct BagHeader {
    std::uint8_t op = 0;
    std::optional<std::uint32_t> connection;
    std::optional<std::uint64_t> time;  ///< seconds in the low half, nanoseconds in the high one
    std::optional<std::uint64_t> index_position;
    std::uint32_t count = 0;
    std::uint32_t size = 0;
    std::string topic;
    std::string compression;
};

namespace bag {
constexpr std::uint8_t kMessage = 2;
constexpr std::uint8_t kFileHeader = 3;
constexpr std::uint8_t kIndex = 4;
constexpr std::uint8_t kChunk = 5;
constexpr std::uint8_t kChunkInfo = 6;
constexpr std::uint8_t kConnection = 7;
constexpr std::string_view kMagic = "#ROSBAG V2.0\n";
constexpr std::size_t kMaxHeader = std::size_t{1} << 20;
}  // namespace bag

/// None where the bytes are no fields "name=value", or say no op.
[[nodiscard]] std::optional<BagHeader> read_bag_header(std::span<const std::uint8_t> bytes);

/// A record in memory.
struct BagRecord {
    BagHeader header;
    std::span<const std::uint8_t> data;
    std::size_t size = 0;  ///< of the whole record
};
[[nodiscard]] std::optional<BagRecord> read_bag_record(std::span<const std::uint8_t> bytes);

/// The record's time in ns; at most 2^63 by its format.
[[nodiscard]] std::int64_t bag_time(std::uint64_t stamp);

}  // namespace kino
