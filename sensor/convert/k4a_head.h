#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/camera_model.h"
#include "base/error.h"
#include "base/time.h"
#include "sensor/convert/k4a_calibration.h"
#include "sensor/session/ebml_writer.h"

namespace kino {

constexpr std::uint64_t kK4aColorTrack = 1;
constexpr std::uint64_t kK4aDepthTrack = 2;
constexpr std::uint64_t kK4aInfraredTrack = 3;

struct K4aColorTrack {
    PixelSize size;
    std::string fourcc;  ///< "MJPG", "YUY2" or "BGRA"
};

/// What stands before the frames of an Azure Kinect recording.
struct K4aHeadInput {
    RigParameters rig;
    int hz = 30;              ///< 5, 15 or 30
    TimeNs start_offset = 0;  ///< device time of the file's start
    PixelSize depth;
    std::string depth_mode;  ///< empty: a size of no mode, the track becomes a custom one
    std::string depth_unit;  ///< of a custom track, see K4aFile
    std::optional<K4aColorTrack> color;
    std::optional<PixelSize> infrared;
};

/// Offsets in the file of what is filled in at the end.
struct K4aHeadPlaces {
    std::uint64_t segment_size = 0;     ///< 8 bytes
    std::uint64_t segment_content = 0;  ///< positions in the file's tables count from here
    std::uint64_t seek_head = 0;        ///< a Void of kK4aSeekHeadBytes
    std::uint64_t duration = 0;         ///< 8 bytes of a double
    std::uint64_t info = 0, tracks = 0, attachments = 0, tags = 0;
};
constexpr std::size_t kK4aSeekHeadBytes = 1024;

/// Fails where the rig is not valid.
[[nodiscard]] Result<K4aHeadPlaces> write_k4a_head(EbmlWriter& out, const K4aHeadInput& input);

struct K4aCuePoint {
    std::uint64_t time = 0;  ///< ticks of 1000 ns
    std::uint64_t track = 0;
    std::uint64_t position = 0;  ///< of the cluster, from the segment's content on
};
void write_k4a_cues(EbmlWriter& out, const std::vector<K4aCuePoint>& points);

struct K4aPatch {
    std::uint64_t offset = 0;
    std::vector<std::uint8_t> bytes;
};
/// What to write over the head when the file is whole. `duration` in ticks.
[[nodiscard]] std::vector<K4aPatch> k4a_patches(const K4aHeadPlaces& places, std::uint64_t cues,
                                                std::uint64_t file_size, double duration);

}  // namespace kino
