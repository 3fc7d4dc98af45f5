#include "apps/pipeline/stepper.h"

#include <utility>

namespace kino {

Stepper::Stepper(OpenedSource opened) : opened_(std::move(opened)) {
    if (const Timeline* timeline = opened_.source->timeline()) {
        order_.emplace(*timeline, opened_.mode, 0);
        order_->pause(0);
    }
}

std::int64_t Stepper::round() const {
    if (!order_) return 0;
    const std::int64_t n = order_->frame_count();
    return opened_.mode == LoopMode::ping_pong && n > 2 ? 2 * n - 2 : n;
}

Result<std::optional<ProcessedFrame>> Stepper::next() {
    if (!order_) {
        return read({});
    }
    if (std::exchange(started_, true) && !order_->step(1, 0) && opened_.mode == LoopMode::once) {
        return std::nullopt;
    }
    const std::int64_t index = order_->due(0);
    const Timeline& timeline = *opened_.source->timeline();
    duration_ = index + 1 < timeline.frame_count()
                    ? timeline.time_of(index + 1) - timeline.time_of(index)
                    : timeline.last_frame_duration();
    if (!shown_ || shown_->set.index != index) {
        return read(index);
    }
    // Shown again: it happens no second time.
    shown_->gestures.clear();
    shown_->bodies_are_new = false;
    return shown_;
}

Result<std::optional<ProcessedFrame>> Stepper::read(std::optional<std::int64_t> index) {
    shown_.reset();
    auto frame = read_frame(opened_, index, kNsPerSecond);
    const std::vector<Event> events = opened_.source->take_events();
    if (!frame) return frame;
    shown_ = std::move(*frame);
    if (shown_ && !opened_.bodies) shown_->gestures = gestures_in(events);
    return shown_;
}

}  // namespace kino
