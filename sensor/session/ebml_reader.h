#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "sensor/session/byte_source.h"
#include "sensor/session/ebml_ids.h"

namespace kino {

/// The head of an element; any bytes are safe to read as one.
struct EbmlHead {
    std::uint32_t id = 0;
    std::uint64_t size = 0;      ///< of the content
    bool unknown_size = false;   ///< size is then 0
    std::size_t head_bytes = 0;  ///< of ID and size
};

/// None where the bytes are no head (IDs of up to 4 bytes, sizes of up to 8) or end within it.
[[nodiscard]] std::optional<EbmlHead> read_ebml_head(std::span<const std::uint8_t> bytes);

/// A child in memory.
struct EbmlChild {
    std::uint32_t id = 0;
    std::span<const std::uint8_t> content;

    /// Big-endian; none for more than 8 bytes.
    [[nodiscard]] std::optional<std::uint64_t> number() const;
    [[nodiscard]] std::string text() const;  ///< up to the first zero byte
};

/// The children of a master in memory, one after another.
class EbmlWalk {
  public:
    explicit EbmlWalk(std::span<const std::uint8_t> content) : rest_(content) {}
    /// None at the end, or where the rest is no element that fits: sound() tells which.
    [[nodiscard]] std::optional<EbmlChild> next();
    [[nodiscard]] bool sound() const { return sound_; }

  private:
    std::span<const std::uint8_t> rest_;
    bool sound_ = true;
};

/// Where an element lies in a file.
struct EbmlPlace {
    std::uint32_t id = 0;
    std::uint64_t start = 0;
    std::uint64_t content = 0;
    std::uint64_t end = 0;
};

/// The element at `offset`; none where there is none, its size is not known, or it ends behind
/// `end`.
[[nodiscard]] std::optional<EbmlPlace> ebml_at(ByteWindow& window, std::uint64_t offset,
                                               std::uint64_t end);

}  // namespace kino
