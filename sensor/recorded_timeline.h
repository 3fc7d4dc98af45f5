#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "sensor/source.h"

namespace kino {

/// What every kind of recording is alike in: subscriptions, the position on the timeline, and the
/// events of its beginning and its end. A derived class reads the pixels.
class RecordedTimeline : public Source, public Timeline {
  public:
    /// `times` of the leading stream's frames, at least one, rising strictly; `started` and `ended`
    /// are told on the same clock. A `last_frame_duration` of 0 is the median distance of the
    /// frames, or 1/30 s.
    RecordedTimeline(SourceInfo info, std::vector<TimeNs> times, TimeNs last_frame_duration = 0);

    [[nodiscard]] const SourceInfo& info() const override { return info_; }
    [[nodiscard]] Timeline* timeline() override { return this; }
    Result<void> subscribe(StreamId id) override;
    void unsubscribe(StreamId id) override;
    [[nodiscard]] Result<std::optional<FrameSet>> next(TimeNs timeout) override;
    [[nodiscard]] std::vector<Event> take_events() override;

    [[nodiscard]] std::int64_t frame_count() const override;
    [[nodiscard]] TimeNs time_of(std::int64_t index) const override;
    [[nodiscard]] TimeNs last_frame_duration() const override { return last_frame_duration_; }
    [[nodiscard]] std::int64_t position() const override { return position_; }
    Result<void> seek(std::int64_t index) override;

  protected:
    /// Frame `index` with what is subscribed to.
    [[nodiscard]] virtual Result<std::optional<FrameSet>> read_set(std::size_t index) = 0;

    [[nodiscard]] const std::vector<TimeNs>& times() const { return times_; }
    /// Whether info().streams[stream] is subscribed to.
    [[nodiscard]] bool wants(std::size_t stream) const { return subscribed_[stream]; }
    void tell(Event event) { events_.push_back(std::move(event)); }

  private:
    SourceInfo info_;
    std::vector<TimeNs> times_;
    TimeNs last_frame_duration_;
    std::vector<bool> subscribed_;  ///< one a stream of info_
    std::vector<Event> events_;
    std::int64_t position_ = 0;
    bool started_ = false;
    bool ended_ = false;
};

}  // namespace kino
