#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/camera_model.h"
#include "base/time.h"
#include "sensor/session/stream_format.h"
#include "sensor/source.h"

/// The parts of a session file that do not hold frames. docs/session-format.md is the contract.
namespace kino {

constexpr TimeNs kNsPerTick = 100'000;     ///< TimestampScale
constexpr std::size_t kFirstSector = 512;  ///< what is overwritten at the end, in one piece
/// Times of frames lie between minus and plus this.
constexpr TimeNs kMaxSessionTime = TimeNs{1} << 62;
constexpr int kMaxTracks = 100;
constexpr const char* kProfileTag = "KINO_SESSION";
constexpr const char* kProfileVersion = "1";
constexpr const char* kOriginTag = "KINO_ORIGIN_NS";
constexpr const char* kFormatTag = "KINO_FORMAT";
constexpr const char* kCalibrationFile = "calibration.json";
constexpr const char* kSourceFile = "source.json";
constexpr const char* kOwnFormatCodec = "S_KINO/FRAME";

enum class TrackRole : std::uint8_t {
    picture,  ///< frames of one StreamFormat
    motion,
    bodies,
    poses,
    events,
    frames  ///< pictures that bring their own format
};

struct SessionTrack {
    int number = 0;  ///< 1 to kMaxTracks
    TrackRole role = TrackRole::picture;
    int device = 0;                          ///< of motion and bodies
    StreamFormat format;                     ///< of pictures
    std::vector<std::uint8_t> private_data;  ///< of pictures
    double nominal_hz = 0;                   ///< 0 if not known
};

/// Offsets count from the start of the file.
struct SessionPlaces {
    std::uint64_t tracks = 0;
    std::uint64_t attachments = 0;
    std::uint64_t tags = 0;
    std::optional<std::uint64_t> cues;  ///< of a closed file
};

/// What the first sector says.
struct SessionHead {
    std::int64_t date_ns = 0;  ///< since 2001-01-01 UTC
    SessionPlaces places;
    std::optional<std::uint64_t> file_size;  ///< of a closed file
    std::optional<TimeNs> duration;          ///< of a closed file
};

struct SessionCue {
    std::int64_t tick = 0;
    int track = 0;
    std::uint64_t cluster = 0;  ///< offset in the file
};

/// EBML head, Segment, SeekHead and Info; exactly kFirstSector bytes.
[[nodiscard]] std::vector<std::uint8_t> first_sector(const SessionHead& head);

/// Everything before the first Cluster. `head.places` is filled in.
[[nodiscard]] std::vector<std::uint8_t> session_start(SessionHead& head, const SourceInfo& source,
                                                      const RigParameters& rig,
                                                      std::span<const SessionTrack> tracks,
                                                      TimeNs origin);

[[nodiscard]] std::vector<std::uint8_t> session_cues(std::span<const SessionCue> cues);

/// Where the Segment's content starts; positions inside it count from here.
[[nodiscard]] std::uint64_t segment_content_start();

/// Where Info starts; it ends with the first sector.
[[nodiscard]] std::size_t info_start();

/// What the KINO_FORMAT tag of the track says.
[[nodiscard]] std::string track_tag(const SessionTrack& track);

}  // namespace kino
