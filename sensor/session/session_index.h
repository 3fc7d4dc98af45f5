#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/camera_model.h"
#include "base/error.h"
#include "base/frame.h"
#include "sensor/session/byte_source.h"
#include "sensor/session/session_layout.h"
#include "sensor/source.h"

namespace kino {

/// One block: a frame or a line of text.
struct SessionEntry {
    std::size_t track = 0;    ///< index into SessionIndex::tracks
    std::size_t cluster = 0;  ///< index into SessionIndex::clusters
    StreamId id;              ///< for pictures, motion and bodies
    TimeNs time = 0;          ///< host time; of texts to 0.1 ms
    TimeNs device_time = 0;   ///< of pictures
    std::int64_t sequence = 0;
    std::uint64_t data = 0;  ///< offset in the file
    std::uint64_t data_size = 0;
    std::uint64_t note = 0;       ///< offset in the file
    std::uint64_t note_size = 0;  ///< 0: none
};

struct SessionCluster {
    std::uint64_t start = 0;
    std::uint64_t end = 0;
    std::optional<std::uint32_t> crc;  ///< as the file says
    std::uint64_t checked_from = 0;    ///< what the CRC covers, to the end
};

/// What a look through a session file finds, without a pixel. All offsets lie inside the file.
struct SessionIndex {
    SourceInfo source;
    RigParameters rig;
    TimeNs origin = 0;
    std::vector<SessionTrack> tracks;
    std::vector<SessionCluster> clusters;
    std::vector<SessionEntry> entries;  ///< in the order of the file
    bool closed = false;                ///< the Segment's size was filled in
    std::int64_t bad_clusters = 0;      ///< skipped
    std::uint64_t skipped_bytes = 0;    ///< between sound elements
    /// Behind the last sound element: of a cluster that was never finished.
    std::uint64_t cut_bytes = 0;
    std::uint64_t missing_bytes = 0;    ///< that a closed file should have and has not
    std::uint64_t sound_end = 0;        ///< offset behind the last sound cluster
    std::vector<std::string> findings;  ///< what a user must be told, whole sentences without stop
};

/// Elements larger than this are not read, whatever the file says.
constexpr std::uint64_t kMaxElement = std::uint64_t{256} << 20;

enum class CheckClusters : std::uint8_t {
    all,
    /// All of files that were not closed or are below 512 MB; a sum that is wrong elsewhere is
    /// found when the frame is read.
    where_cheap
};

/// Fails for files that are not sessions, and where nothing before the first cluster makes sense.
[[nodiscard]] Result<SessionIndex> index_session(const ByteSource& bytes, const std::string& where,
                                                 CheckClusters check);

/// Whether the bytes begin as a session does: EBML, "matroska", and our tag.
[[nodiscard]] bool looks_like_session(const ByteSource& bytes);

}  // namespace kino
