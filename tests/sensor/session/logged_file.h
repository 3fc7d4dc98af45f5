#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "sensor/session/recording_file.h"
#include "tests/support/random.h"

namespace kino::test {

/// What a recorder did to its file, step by step.
struct FileStep {
    enum class Kind : std::uint8_t { append, overwrite, truncate, sync };
    Kind kind = Kind::append;
    std::uint64_t offset = 0;  ///< of the bytes; for truncate the new size
    std::vector<std::uint8_t> bytes;
};

struct FileLog {
    std::vector<FileStep> steps;
    std::vector<std::uint8_t> content;  ///< as it is read without a power cut
};

/// A disk in memory that keeps a log and can be full or broken.
class LoggedFile final : public RecordingFile {
  public:
    /// `log` outlives the file. The disk has room for `capacity` bytes.
    explicit LoggedFile(FileLog& log,
                        std::uint64_t capacity = std::numeric_limits<std::uint64_t>::max())
        : log_(log), capacity_(capacity) {}

    Result<void> append(std::span<const std::uint8_t> bytes) override;
    Result<void> overwrite(std::uint64_t offset, std::span<const std::uint8_t> bytes) override;
    Result<void> sync() override;
    Result<void> truncate(std::uint64_t size) override;
    [[nodiscard]] std::uint64_t size() const override { return log_.content.size(); }

    /// Syncs from now on fail as a broken disk's do.
    void break_sync() { broken_ = true; }

  private:
    FileLog& log_;
    std::uint64_t capacity_;
    bool broken_ = false;
};

/// What may be on the disk after a power cut when `steps` steps were done: everything up to the
/// last sync, and of the steps since then a random choice in which each write is there whole, in
/// part (an append up to some byte; an overwrite of one 512-byte sector is all or nothing) or not
/// at all, whatever became of those before it. Missing bytes below existing ones read as zero.
[[nodiscard]] std::vector<std::uint8_t> after_power_cut(const FileLog& log, std::size_t steps,
                                                        Random& random);
/// The size that the last sync before `steps` vouches for.
[[nodiscard]] std::uint64_t synced_size(const FileLog& log, std::size_t steps);

}  // namespace kino::test
