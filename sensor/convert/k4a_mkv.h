#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/time.h"
#include "sensor/session/byte_source.h"
#include "sensor/source.h"

namespace kino {

enum class K4aRole : std::uint8_t { depth, color, infrared, motion };

/// How the pixels of a track lie in the file.
enum class K4aPixels : std::uint8_t {
    b16g,  ///< 16 bits, big-endian
    mjpg,
    nv12,
    yuy2,
    bgra,
    imu  ///< 40 bytes a sample: u64 ns, f32[3] acceleration, u64 ns, f32[3] turning
};

struct K4aTrack {
    std::uint64_t number = 0;
    K4aRole role = K4aRole::depth;
    K4aPixels pixels = K4aPixels::b16g;
    std::string name;
    int width = 0;
    int height = 0;
    TimeNs frame_distance = 0;  ///< as stated; 0: not stated
};

struct K4aBlock {
    std::size_t track = 0;   ///< index into K4aFile::tracks
    TimeNs time = 0;         ///< since the start of the file
    std::uint64_t data = 0;  ///< offset in the file
    std::uint64_t size = 0;
};

/// What a look through the file finds, without a pixel. All offsets lie inside the file.
struct K4aFile {
    std::vector<K4aTrack> tracks;
    std::vector<K4aBlock> blocks;
    /// Those named K4A_... and KINOSCOPE_...: KINOSCOPE_DEPTH_UNIT is "kinect_disparity11" or the
    /// metres of a count.
    std::map<std::string, std::string> tags;
    std::optional<std::string> calibration;  ///< calibration.json
    std::optional<std::string> own_rig;      ///< kinoscope_rig.json, in files that we wrote
    TimeNs start_offset = 0;                 ///< device time of the file's start
    std::vector<std::string> findings;       ///< what a user must be told
};

/// Fails for what is no Azure Kinect recording, and where a track is of a kind that it cannot have.
[[nodiscard]] Result<K4aFile> index_k4a(const ByteSource& bytes, const std::string& where);
/// EBML, "matroska", and in the first 64 KiB a tag or track that only such files have.
[[nodiscard]] bool looks_like_k4a(const ByteSource& bytes);

/// Plays depth (raw millimetres), colour as the file holds it (NV12 as YUYV), infrared and the
/// accelerometer: one motion frame for each block of samples, their mean.
[[nodiscard]] Result<std::unique_ptr<Source>> make_k4a_source(std::unique_ptr<ByteSource> bytes,
                                                              const std::string& uri);

/// Matroska files of k4arecorder and of `convert --to k4a`.
[[nodiscard]] SourceOpener k4a_opener();

}  // namespace kino
