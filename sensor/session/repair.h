#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "base/error.h"
#include "sensor/session/byte_source.h"
#include "sensor/session/recording_file.h"

namespace kino {

struct RepairReport {
    bool was_closed = false;         ///< nothing was changed
    std::int64_t frames = 0;         ///< readable, all streams
    std::int64_t clusters = 0;       ///< sound
    std::int64_t bad_clusters = 0;   ///< damaged; left where they are, readers pass over them
    std::uint64_t cut_bytes = 0;     ///< of an unfinished cluster at the end, taken off
    std::vector<std::string> lines;  ///< what was found and done, for a person
};

/// Ends a recording that was cut off: takes an unfinished cluster off its end, appends the index
/// and fills in the head, each on the disk before the next; no byte of a sound cluster is touched,
/// and being stopped at any moment leaves a file that can be repaired again. Fails for files that
/// are not sessions, have no sound cluster, or cannot be written.
[[nodiscard]] Result<RepairReport> repair_session(const std::filesystem::path& path);

/// The same over any file. `bytes` reads what `file` writes.
[[nodiscard]] Result<RepairReport> repair_session(const ByteSource& bytes, RecordingFile& file,
                                                  const std::string& where);

}  // namespace kino
