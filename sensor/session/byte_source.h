#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "base/error.h"

namespace kino {

/// Bytes that can be read anywhere: a file, or memory in tests.
class ByteSource {
  public:
    virtual ~ByteSource() = default;
    [[nodiscard]] virtual std::uint64_t size() const = 0;
    /// Fills `out` from `offset`; false where that is not all there or the disk fails.
    [[nodiscard]] virtual bool read(std::uint64_t offset, std::span<std::uint8_t> out) const = 0;
};

/// Only regular files. The size is that at the time of opening.
[[nodiscard]] Result<std::unique_ptr<ByteSource>> open_byte_source(
    const std::filesystem::path& path);
[[nodiscard]] std::unique_ptr<ByteSource> memory_byte_source(std::span<const std::uint8_t> bytes);

/// A small moving window over a source, so that stepping through a file's elements does not ask
/// the system for every few bytes.
class ByteWindow {
  public:
    explicit ByteWindow(const ByteSource& source) : source_(source) {}
    /// `count` bytes from `offset`, or as many as there are; valid until the next call. Empty at
    /// the end and where the disk fails.
    [[nodiscard]] std::span<const std::uint8_t> at(std::uint64_t offset, std::size_t count);
    [[nodiscard]] std::uint64_t size() const { return source_.size(); }

  private:
    const ByteSource& source_;
    std::vector<std::uint8_t> bytes_;
    std::uint64_t start_ = 0;
};

}  // namespace kino
