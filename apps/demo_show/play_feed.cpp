#include "apps/demo_show/play_feed.h"

#include "apps/viewer/scene_place.h"

namespace kino {

void PlayFeed::reset() {
    frame_.reset();
    middle_m_.reset();
}

void PlayFeed::show(const ProcessedFrame& frame) {
    frame_ = frame;
    if (!middle_m_ && frame.surface) middle_m_ = measure_place(frame).center;
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
