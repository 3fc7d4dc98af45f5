#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>

#include "base/error.h"

namespace kino {

/// All that a recorder asks of the disk. A call that fails may have happened in part.
class RecordingFile {
  public:
    virtual ~RecordingFile() = default;
    RecordingFile() = default;
    RecordingFile(const RecordingFile&) = delete;
    RecordingFile& operator=(const RecordingFile&) = delete;

    virtual Result<void> append(std::span<const std::uint8_t> bytes) = 0;
    /// Replaces bytes that are there.
    virtual Result<void> overwrite(std::uint64_t offset, std::span<const std::uint8_t> bytes) = 0;
    /// On return everything so far survives a power cut.
    virtual Result<void> sync() = 0;
    virtual Result<void> truncate(std::uint64_t size) = 0;
    [[nodiscard]] virtual std::uint64_t size() const = 0;
};

/// A new file; fails where it exists already.
[[nodiscard]] Result<std::unique_ptr<RecordingFile>> create_recording_file(
    const std::filesystem::path& path);
/// A file that is there, for adding to.
[[nodiscard]] Result<std::unique_ptr<RecordingFile>> open_recording_file(
    const std::filesystem::path& path);

}  // namespace kino
