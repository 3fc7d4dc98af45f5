#include "apps/demo_show/play_feed.h"

#include "apps/viewer/scene_place.h"

namespace kino {

void PlayFeed::reset() {
    frame_.reset();
    middle_m_.reset();
    places_.reset();
}

void PlayFeed::show(const ProcessedFrame& frame) {
    frame_ = frame;
    if (!middle_m_ && frame.surface) middle_m_ = measure_place(frame).center;
}

void PlayFeed::hear(std::span<const GestureEvent> gestures) {
    for (const GestureEvent& event : gestures) places_.hear(event);
}

void PlayFeed::guide(const DemoPlay& play, bool mirror, ShowScreen& screen) const {
    screen.guidance = {&play.guidance(), play.second_guidance()};
    if (!frame_) return;
    for (std::size_t i = 0; i < screen.guidance.size(); ++i) {
        if (screen.guidance[i] == nullptr) continue;
        screen.praised_m[i] = places_.of(screen.guidance[i]->praised, frame_->set.bodies.get(),
                                         frame_->set.world_from_depth, mirror);
    }
}

DemoMoment PlayFeed::moment(double dt_s, std::span<const GestureEvent> gestures, bool lost) const {
    DemoMoment moment{.dt_s = dt_s, .gestures = gestures, .source_lost = lost};
    moment.world_from_depth = world_from_camera_axes();
    if (middle_m_) moment.middle_m = *middle_m_;
    if (!frame_) return moment;
    moment.time = frame_->set.time;
    moment.bodies = frame_->set.bodies.get();
    moment.world_from_depth = frame_->set.world_from_depth;
    moment.surface = frame_->surface;
    return moment;
}

}  // namespace kino
