#include "apps/demo_sources/source_desk.h"

#include <fmt/format.h>

#include <utility>

namespace kino {

Result<std::unique_ptr<SourceDesk>> SourceDesk::create(SourceDeskOptions options) {
    std::unique_ptr<SourceDesk> desk(new SourceDesk(std::move(options)));
    if (desk->options_.waits) {
        desk->watch_ =
            std::make_unique<DeviceWatch>(desk->options_.open_live, desk->options_.look_every);
        desk->enter(ShowMode::attract);
        if (!desk->performance_) {
            KINO_ASSIGN(desk->performance_, desk->options_.open_performance());
        }
        return desk;
    }
    KINO_ASSIGN(desk->live_, desk->options_.open_live());
    desk->is_device_ = desk->live_->status().frame_count == 0;
    return desk;
}

LiveRunner* SourceDesk::runner() {
    return mode_ == ShowMode::attract && performance_ ? performance_.get() : live_.get();
}

void SourceDesk::enter(ShowMode mode) {
    if (mode_ == ShowMode::attract && mode != ShowMode::attract) performance_.reset();
    if (mode == ShowMode::attract && !performance_) {
        auto opened = options_.open_performance();
        // A demo without its performance waits before the sensor's picture.
        if (opened) performance_ = std::move(*opened);
    }
    // Back from being lost it is the same source, and those who played still do.
    cut_ = cut_ || (mode == ShowMode::attract) != (mode_ == ShowMode::attract);
    mode_ = mode;
    in_a_row_ = 0;
}

void SourceDesk::take_sensor(TimeNs now) {
    if (!watch_) return;
    auto found = watch_->take();
    if (!found) return;
    watch_.reset();
    live_ = std::move(found);
    is_device_ = live_->status().frame_count == 0;
    seen_ = now;
    enter(ShowMode::live);
}

void SourceDesk::watch_people(const ProcessedFrame& frame, TimeNs now) {
    const bool somebody = frame.set.bodies && !frame.set.bodies->bodies.empty();
    in_a_row_ = somebody ? in_a_row_ + 1 : 0;
    if (somebody) seen_ = now;
}

void SourceDesk::choose(TimeNs now) {
    if (!live_ || !is_device_) return;
    const LiveStatus status = live_->status();
    if (!status.present || status.finished) {
        if (mode_ != ShowMode::lost) enter(ShowMode::lost);
        return;
    }
    if (mode_ == ShowMode::lost) {
        seen_ = now;
        enter(ShowMode::live);
    } else if (mode_ == ShowMode::live && now - seen_ > options_.attract_after) {
        enter(ShowMode::attract);
    } else if (mode_ == ShowMode::attract && in_a_row_ >= options_.frames_to_return) {
        enter(ShowMode::live);
    }
}

SourceDesk::Shown SourceDesk::step(TimeNs now) {
    if (!std::exchange(started_, true)) seen_ = now;
    take_sensor(now);
    Shown shown;
    std::vector<GestureEvent> of_live;
    std::optional<ProcessedFrame> live_frame;
    if (live_) {
        live_frame = live_->take();
        of_live = live_->take_gestures();
        if (live_frame) watch_people(*live_frame, now);
    }
    choose(now);
    shown.mode = mode_;
    shown.cut = std::exchange(cut_, false);
    if (mode_ == ShowMode::attract && performance_) {
        shown.fresh = performance_->take();
        shown.gestures = performance_->take_gestures();
    } else {
        shown.fresh = std::move(live_frame);
        shown.gestures = std::move(of_live);
    }
    return shown;
}

}  // namespace kino
