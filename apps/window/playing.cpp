#include "apps/window/playing.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "apps/stage_source.h"

namespace kino {

Result<std::unique_ptr<Playing>> Playing::open(const std::string& uri,
                                               const PlayingOptions& options) {
    KINO_ASSIGN(OpenedSource opened, open_with_people(uri,
                                                      {.mode = options.loop,
                                                       .filters = options.filters,
                                                       .bodies = options.bodies,
                                                       .calibration = options.calibration},
                                                      options.wants_people));
    std::unique_ptr<Playing> playing(new Playing());
    playing->info_ = opened.source->info();
    playing->rig_ = opened.processor.rig().parameters();
    // The timeline belongs to the runner's thread from here on, so what is needed is copied.
    if (const Timeline* timeline = opened.source->timeline()) {
        for (std::int64_t i = 0; i < timeline->frame_count(); ++i) {
            playing->times_.push_back(timeline->time_of(i));
        }
        playing->last_duration_ = timeline->last_frame_duration();
    }
    playing->stepped_ = options.stepped && !playing->times_.empty();
    LiveRunnerOptions live{.speed = options.speed};
    if (playing->stepped_) {
        playing->stepped_clock_ = std::make_shared<std::atomic<TimeNs>>(0);
        live.clock = [clock = playing->stepped_clock_] { return clock->load(); };
    }
    playing->runner_ = std::make_unique<LiveRunner>(std::move(opened), live);
    return playing;
}

std::optional<ProcessedFrame> Playing::take() {
    if (!stepped_) return runner_->take();
    const LiveStatus status = runner_->status();
    if (status.position == taken_ && !status.paused) return std::nullopt;
    constexpr TimeNs kPatience = kNsPerSecond;
    auto frame = status.paused ? runner_->take() : runner_->wait(kPatience);
    taken_ = status.position;
    return frame;
}

void Playing::picture_shown() {
    if (!stepped_) return;
    const LiveStatus status = runner_->status();
    if (status.paused || status.position != taken_) return;
    const auto i = static_cast<std::size_t>(status.position);
    const TimeNs duration = i + 1 < times_.size() ? times_[i + 1] - times_[i] : last_duration_;
    const double scaled = std::ceil(static_cast<double>(duration) / status.speed);
    stepped_clock_->fetch_add(static_cast<TimeNs>(scaled) + 1);
}

TimeNs Playing::time_of(std::int64_t index) const {
    const auto i = static_cast<std::size_t>(index);
    return i < times_.size() ? times_[i] : 0;
}

TimeNs Playing::round() const {
    if (times_.empty()) return 0;
    const TimeNs once = times_.back() + last_duration_;
    return runner_->status().mode == LoopMode::ping_pong ? 2 * once : once;
}

std::string Playing::stop() {
    runner_->stop();
    const LiveStatus status = runner_->status();
    if (!status.recording) return {};
    const RecorderStatus& recording = *status.recording;
    return fmt::format("recorded {} frames, {:.1f} MB{}{}", recording.frames,
                       static_cast<double>(recording.bytes) / 1e6,
                       recording.dropped > 0 ? fmt::format(", {} lost", recording.dropped) : "",
                       recording.error.empty() ? "" : "; " + recording.error);
}

}  // namespace kino
