#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "sensor/source.h"

namespace kino {

/// One kind of recording's pixels, asked for frame by frame and only for subscribed streams. The
/// same index gives the same pixels whenever it is asked for.
class FrameReader {
  public:
    virtual ~FrameReader() = default;
    virtual Result<std::shared_ptr<const DepthFrame>> depth(std::int64_t index) = 0;
    virtual Result<std::shared_ptr<const ColorFrame>> color(std::int64_t index) = 0;
};

struct RecordedFrame {
    TimeNs time = 0;          ///< of the depth frame, on the recording's own clock
    std::int64_t color = -1;  ///< index for FrameReader::color; -1 is none
    bool color_paired = false;
    std::optional<Pose> world_from_depth;
};

/// A recording taken apart: what an opener found out before any pixel is read.
struct Recording {
    SourceInfo info;
    RigParameters rig;
    std::vector<RecordedFrame> frames;  ///< at least one; times strictly rising
    TimeNs last_frame_duration = 0;     ///< 0: the median distance of the frames, or 1/30 s
    std::unique_ptr<FrameReader> reader;
};

/// Gives a recording the face of a Source with a Timeline. Host time is device time counted from
/// frame 0, so two runs are equal bit by bit.
[[nodiscard]] std::unique_ptr<Source> make_recording_source(Recording recording);

}  // namespace kino
