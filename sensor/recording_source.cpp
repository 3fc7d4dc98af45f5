#include "sensor/recording_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "base/check.h"

namespace kino {
namespace {

TimeNs median_distance(const std::vector<RecordedFrame>& frames) {
    if (frames.size() < 2) return kNsPerSecond / 30;
    std::vector<TimeNs> distances(frames.size() - 1);
    for (std::size_t i = 0; i + 1 < frames.size(); ++i) {
        distances[i] = frames[i + 1].time - frames[i].time;
    }
    const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
    std::nth_element(distances.begin(), middle, distances.end());
    return *middle;
}

class RecordingSource final : public Source, public Timeline {
  public:
    explicit RecordingSource(Recording recording)
        : recording_(std::move(recording)), subscribed_(recording_.info.streams.size(), false) {
        KINO_CHECK(!recording_.frames.empty());
        if (recording_.last_frame_duration <= 0) {
            recording_.last_frame_duration = median_distance(recording_.frames);
        }
    }

    const SourceInfo& info() const override { return recording_.info; }
    Result<RigParameters> calibration() const override { return recording_.rig; }
    Timeline* timeline() override { return this; }

    Result<void> subscribe(StreamId id) override {
        const std::optional<std::size_t> stream = find(id);
        if (!stream) {
            return fail(fmt::format("this recording has no {} stream of device {}",
                                    stream_name(id.kind), id.device),
                        recording_.info.uri);
        }
        subscribed_[*stream] = true;
        return {};
    }

    void unsubscribe(StreamId id) override {
        if (const auto stream = find(id)) subscribed_[*stream] = false;
    }

    Result<std::optional<FrameSet>> next(TimeNs) override {
        if (!std::exchange(started_, true)) add_event(EventKind::started);
        if (position_ >= frame_count()) {
            if (!std::exchange(ended_, true)) add_event(EventKind::ended);
            return std::nullopt;
        }
        // Moved first: an unreadable frame is an error once, then the next one comes.
        return read(position_++);
    }

    std::vector<Event> take_events() override { return std::exchange(events_, {}); }

    std::int64_t frame_count() const override {
        return static_cast<std::int64_t>(recording_.frames.size());
    }
    TimeNs time_of(std::int64_t index) const override {
        return frame(index).time - recording_.frames.front().time;
    }
    TimeNs last_frame_duration() const override { return recording_.last_frame_duration; }
    std::int64_t position() const override { return position_; }

    Result<void> seek(std::int64_t index) override {
        if (index < 0 || index >= frame_count()) {
            return fail(fmt::format("frame {} is outside 0 to {}", index, frame_count() - 1),
                        recording_.info.uri);
        }
        position_ = index;
        ended_ = false;
        return {};
    }

  private:
    const RecordedFrame& frame(std::int64_t index) const {
        KINO_CHECK_LE(0, index);
        KINO_CHECK_LT(index, frame_count());
        return recording_.frames[static_cast<std::size_t>(index)];
    }

    std::optional<std::size_t> find(StreamId id) const {
        for (std::size_t i = 0; i < recording_.info.streams.size(); ++i) {
            if (recording_.info.streams[i].id == id) return i;
        }
        return std::nullopt;
    }

    bool wants(StreamKind kind) const {
        const auto stream = find({0, kind});
        return stream && subscribed_[*stream];
    }

    Result<std::optional<FrameSet>> read(std::int64_t index) {
        const RecordedFrame& entry = frame(index);
        FrameSet set;
        set.index = index;
        set.time = time_of(index);
        if (entry.world_from_depth) {
            set.world_from_depth = *entry.world_from_depth;
            set.pose_origin = PoseOrigin::trajectory;
        }
        if (wants(StreamKind::depth)) {
            KINO_ASSIGN(set.depth, recording_.reader->depth(index));
        }
        if (wants(StreamKind::color) && entry.color >= 0) {
            KINO_ASSIGN(set.color, recording_.reader->color(entry.color));
            set.color_paired = entry.color_paired;
        }
        return set;
    }

    void add_event(EventKind kind) {
        const TimeNs end = recording_.frames.back().time - recording_.frames.front().time;
        const bool started = kind == EventKind::started;
        events_.push_back(
            {kind, started ? 0 : end + recording_.last_frame_duration, recording_.info.name});
    }

    Recording recording_;
    std::vector<bool> subscribed_;
    std::vector<Event> events_;
    std::int64_t position_ = 0;
    bool started_ = false;
    bool ended_ = false;
};

}  // namespace

std::unique_ptr<Source> make_recording_source(Recording recording) {
    return std::make_unique<RecordingSource>(std::move(recording));
}

}  // namespace kino
