#include "sensor/recorded_timeline.h"

#include <fmt/format.h>

#include <utility>

#include "base/check.h"
#include "sensor/pairing.h"

namespace kino {

RecordedTimeline::RecordedTimeline(SourceInfo info, std::vector<TimeNs> times,
                                   TimeNs last_frame_duration)
    : info_(std::move(info)),
      times_(std::move(times)),
      last_frame_duration_(last_frame_duration > 0 ? last_frame_duration : median_distance(times_)),
      subscribed_(info_.streams.size(), false) {
    KINO_CHECK(!times_.empty());
}

Result<void> RecordedTimeline::subscribe(StreamId id) {
    for (std::size_t i = 0; i < subscribed_.size(); ++i) {
        if (info_.streams[i].id != id) continue;
        subscribed_[i] = true;
        return {};
    }
    return fail(fmt::format("this recording has no {} stream of device {}", stream_name(id.kind),
                            id.device),
                info_.uri);
}

void RecordedTimeline::unsubscribe(StreamId id) {
    for (std::size_t i = 0; i < subscribed_.size(); ++i) {
        if (info_.streams[i].id == id) subscribed_[i] = false;
    }
}

Result<std::optional<FrameSet>> RecordedTimeline::next(TimeNs) {
    if (!std::exchange(started_, true)) {
        tell({EventKind::started, times_.front(), info_.name, {}});
    }
    if (position_ >= frame_count()) {
        if (!std::exchange(ended_, true)) {
            tell({EventKind::ended, times_.back() + last_frame_duration_, info_.name, {}});
        }
        return std::nullopt;
    }
    // Moved first: an unreadable frame is an error once, then the next one comes.
    return read_set(static_cast<std::size_t>(position_++));
}

std::vector<Event> RecordedTimeline::take_events() {
    return std::exchange(events_, {});
}

std::int64_t RecordedTimeline::frame_count() const {
    return static_cast<std::int64_t>(times_.size());
}

TimeNs RecordedTimeline::time_of(std::int64_t index) const {
    KINO_CHECK_LE(0, index);
    KINO_CHECK_LT(index, frame_count());
    return times_[static_cast<std::size_t>(index)] - times_.front();
}

Result<void> RecordedTimeline::seek(std::int64_t index) {
    if (index < 0 || index >= frame_count()) {
        return fail(fmt::format("frame {} is outside 0 to {}", index, frame_count() - 1),
                    info_.uri);
    }
    position_ = index;
    ended_ = false;
    return {};
}

}  // namespace kino
