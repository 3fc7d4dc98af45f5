#pragma once

#include <atomic>
#include <memory>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "sensor/source.h"

namespace kino::test {

constexpr TimeNs kFrameTime = kNsPerSecond / 10;

/// What a test looks at from outside while a runner owns the source.
struct CountingLog {
    std::atomic<int> reads{0};
};

/// A recording without files: frame i is 8x6 pixels, all at 1 m + i mm, a tenth of a second after
/// the last one.
class CountingSource final : public Source, public Timeline {
  public:
    struct Options {
        std::int64_t frames = 10;
        std::set<std::int64_t> unreadable;
        TimeNs reading_time = 0;
        bool with_timeline = true;
        bool with_color = false;
        std::set<std::int64_t> without_color;  ///< frames that have no colour of their own
    };

    explicit CountingSource(Options options,
                            std::shared_ptr<CountingLog> log = std::make_shared<CountingLog>())
        : options_(std::move(options)), log_(std::move(log)) {
        info_.uri = "counting:";
        info_.name = "counting";
        info_.streams = {{.id = {0, StreamKind::depth}, .width = 8, .height = 6, .nominal_hz = 10}};
        rig_.depth = {.width = 8, .height = 6, .fx = 8, .fy = 8, .cx = 3.5, .cy = 2.5};
        if (options_.with_color) rig_.color = rig_.depth;
    }

    const SourceInfo& info() const override { return info_; }
    Result<RigParameters> calibration() const override { return rig_; }
    Result<void> subscribe(StreamId) override { return {}; }
    void unsubscribe(StreamId) override {}
    std::vector<Event> take_events() override { return std::exchange(events_, {}); }
    Timeline* timeline() override { return options_.with_timeline ? this : nullptr; }

    Result<std::optional<FrameSet>> next(TimeNs) override {
        if (options_.reading_time > 0) {
            std::this_thread::sleep_for(std::chrono::nanoseconds(options_.reading_time));
        }
        if (position_ >= options_.frames) {
            events_.push_back({EventKind::ended, 0, {}});
            return std::nullopt;
        }
        const std::int64_t index = position_++;
        ++log_->reads;
        if (options_.unreadable.contains(index)) return fail("unreadable", "counting:");
        return make_frame(index);
    }

    std::int64_t frame_count() const override { return options_.frames; }
    TimeNs time_of(std::int64_t index) const override { return index * kFrameTime; }
    TimeNs last_frame_duration() const override { return kFrameTime; }
    std::int64_t position() const override { return position_; }
    Result<void> seek(std::int64_t index) override {
        if (index < 0 || index >= options_.frames) return fail("outside");
        position_ = index;
        return {};
    }

  private:
    FrameSet make_frame(std::int64_t index) const {
        FrameSet set;
        set.index = index;
        auto depth = std::make_shared<DepthFrame>();
        depth->raw = Image<std::uint16_t>(8, 6, static_cast<std::uint16_t>(1000 + index));
        set.depth = depth;
        if (options_.with_color && !options_.without_color.contains(index)) {
            auto color = std::make_shared<ColorFrame>();
            color->width = 8;
            color->height = 6;
            color->pitch = 32;
            color->bytes.assign(8 * 6 * 4, 200);
            set.color = color;
            set.color_paired = true;
        }
        return set;
    }

    Options options_;
    std::shared_ptr<CountingLog> log_;
    SourceInfo info_;
    RigParameters rig_;
    std::vector<Event> events_;
    std::int64_t position_ = 0;
};

}  // namespace kino::test
