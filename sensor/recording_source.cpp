#include "sensor/recording_source.h"

#include <utility>

#include "base/check.h"
#include "sensor/recorded_timeline.h"

namespace kino {
namespace {

/// From frame 0.
std::vector<TimeNs> times_from_start(const std::vector<RecordedFrame>& frames) {
    KINO_CHECK(!frames.empty());
    std::vector<TimeNs> times;
    times.reserve(frames.size());
    for (const RecordedFrame& frame : frames) times.push_back(frame.time - frames.front().time);
    return times;
}

class RecordingSource final : public RecordedTimeline {
  public:
    explicit RecordingSource(Recording recording)
        : RecordedTimeline(recording.info, times_from_start(recording.frames),
                           recording.last_frame_duration),
          rig_(std::move(recording.rig)),
          frames_(std::move(recording.frames)),
          reader_(std::move(recording.reader)) {}

    Result<RigParameters> calibration() const override { return rig_; }

  private:
    bool wants_kind(StreamKind kind) const {
        for (std::size_t i = 0; i < info().streams.size(); ++i) {
            if (info().streams[i].id == StreamId{0, kind}) return wants(i);
        }
        return false;
    }

    Result<std::optional<FrameSet>> read_set(std::size_t index) override {
        const RecordedFrame& entry = frames_[index];
        FrameSet set;
        set.index = static_cast<std::int64_t>(index);
        set.time = times()[index];
        if (entry.world_from_depth) {
            set.world_from_depth = *entry.world_from_depth;
            set.pose_origin = PoseOrigin::trajectory;
        }
        if (wants_kind(StreamKind::depth)) {
            KINO_ASSIGN(set.depth, reader_->depth(set.index));
        }
        if (wants_kind(StreamKind::color) && entry.color >= 0) {
            KINO_ASSIGN(set.color, reader_->color(entry.color));
            set.color_paired = entry.color_paired;
        }
        return set;
    }

    RigParameters rig_;
    std::vector<RecordedFrame> frames_;
    std::unique_ptr<FrameReader> reader_;
};

}  // namespace

std::unique_ptr<Source> make_recording_source(Recording recording) {
    return std::make_unique<RecordingSource>(std::move(recording));
}

}  // namespace kino
