#include "sensor/playback.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/check.h"

namespace kino {
namespace {

std::vector<TimeNs> times_of(const Timeline& timeline) {
    std::vector<TimeNs> times(static_cast<std::size_t>(timeline.frame_count()));
    for (std::size_t i = 0; i < times.size(); ++i) {
        times[i] = timeline.time_of(static_cast<std::int64_t>(i));
    }
    return times;
}

}  // namespace

Playback::Playback(std::vector<TimeNs> times, TimeNs last_frame_duration, LoopMode mode,
                   TimeNs host_now)
    : times_(std::move(times)),
      last_frame_duration_(last_frame_duration),
      mode_(mode),
      anchor_host_(host_now) {
    KINO_CHECK(!times_.empty());
    KINO_CHECK_LT(0, last_frame_duration_);
    build_turns();
}

Playback::Playback(const Timeline& timeline, LoopMode mode, TimeNs host_now)
    : Playback(times_of(timeline), timeline.last_frame_duration(), mode, host_now) {}

void Playback::build_turns() {
    turns_.clear();
    const std::size_t n = times_.size();
    const auto add = [&](std::size_t i) {
        turns_.push_back({period_, static_cast<std::int64_t>(i)});
        period_ += i + 1 < n ? times_[i + 1] - times_[i] : last_frame_duration_;
    };
    period_ = 0;
    for (std::size_t i = 0; i < n; ++i) add(i);
    if (mode_ != LoopMode::ping_pong) return;
    for (std::size_t i = n; i-- > 2;) add(i - 1);
}

TimeNs Playback::media_time(TimeNs host_now) const {
    if (paused_) return anchor_media_;
    const TimeNs elapsed = std::max<TimeNs>(0, host_now - anchor_host_);
    return anchor_media_ + static_cast<TimeNs>(std::floor(static_cast<double>(elapsed) * speed_));
}

std::size_t Playback::turn_at(TimeNs media) const {
    if (mode_ != LoopMode::once) media %= period_;
    const auto after = std::upper_bound(turns_.begin(), turns_.end(), media,
                                        [](TimeNs t, const Turn& turn) { return t < turn.start; });
    return static_cast<std::size_t>(after - turns_.begin()) - 1;
}

void Playback::go_to(TimeNs media, TimeNs host_now) {
    anchor_media_ = media;
    anchor_host_ = std::max(anchor_host_, host_now);
}

std::int64_t Playback::due(TimeNs host_now) const {
    return turns_[turn_at(media_time(host_now))].index;
}

bool Playback::finished(TimeNs host_now) const {
    return mode_ == LoopMode::once && media_time(host_now) >= period_;
}

void Playback::pause(TimeNs host_now) {
    go_to(media_time(host_now), host_now);
    paused_ = true;
}

void Playback::resume(TimeNs host_now) {
    if (finished(host_now)) {
        go_to(0, host_now);
    } else if (paused_) {
        go_to(anchor_media_, host_now);
    }
    paused_ = false;
}

bool Playback::step(int direction, TimeNs host_now) {
    const std::size_t turn = turn_at(media_time(host_now));
    pause(host_now);
    const std::size_t count = turns_.size();
    const bool forward = direction > 0;
    if (mode_ == LoopMode::once && turn == (forward ? count - 1 : 0)) return false;
    const std::size_t next = (turn + (forward ? 1 : count - 1)) % count;
    go_to(turns_[next].start, host_now);
    return next != turn;
}

void Playback::seek(std::int64_t index, TimeNs host_now) {
    index = std::clamp<std::int64_t>(index, 0, frame_count() - 1);
    // The first n turns of every mode are the frames in order.
    go_to(turns_[static_cast<std::size_t>(index)].start, host_now);
}

void Playback::set_speed(double speed, TimeNs host_now) {
    go_to(media_time(host_now), host_now);
    speed_ = std::isfinite(speed) ? std::clamp(speed, kMinSpeed, kMaxSpeed) : 1.0;
}

void Playback::set_mode(LoopMode mode, TimeNs host_now) {
    if (mode == mode_) return;
    const TimeNs media = media_time(host_now);
    const Turn turn = turns_[turn_at(media)];
    const TimeNs into = mode_ == LoopMode::once ? media - turn.start : media % period_ - turn.start;
    mode_ = mode;
    build_turns();
    const auto i = static_cast<std::size_t>(turn.index);
    const TimeNs end =
        i + 1 < times_.size() ? turns_[i + 1].start : turns_[i].start + last_frame_duration_;
    go_to(std::min(turns_[i].start + into, end - 1), host_now);
}

LoopMode natural_loop(const Timeline& timeline) {
    const std::int64_t last = timeline.frame_count() - 1;
    const TimeNs length = timeline.time_of(last) + timeline.last_frame_duration();
    return last > 0 && length < 2 * kNsPerSecond ? LoopMode::ping_pong : LoopMode::loop;
}

}  // namespace kino
