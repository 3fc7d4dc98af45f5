#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "base/frame.h"
#include "base/image.h"
#include "base/time.h"
#include "skeleton/gestures/gesture_event.h"
#include "skeleton/tracking/body_tracker.h"
#include "viz/scene/scene.h"

namespace kino {

/// Host time each stage took for one frame.
struct StageTimes {
    TimeNs read = 0;          ///< the source: file, decoding of depth; of a device: waiting for it
    TimeNs color = 0;         ///< colour conversion
    TimeNs filter = 0;        ///< depth filters
    TimeNs registration = 0;  ///< depth to metres, colour into the depth grid
    TimeNs bodies = 0;        ///< people, joints and gestures
};

/// A frame set on its way from the source to the scene. Immutable and shared by count.
struct ProcessedFrame {
    FrameSet set;
    /// Null where the set has no depth: there are only pictures to show.
    std::shared_ptr<const DepthSurface> surface;
    /// The colour picture as the camera saw it; null where the source has none. The last known one
    /// if this depth frame has no partner (`color_paired` of the set).
    std::shared_ptr<const Image<Rgba8>> color;
    std::int64_t valid_points = 0;  ///< depth pixels with a reading
    /// Of the bodies of `set`: what they decided in this frame, or what was recorded with it.
    std::vector<GestureEvent> gestures;
    std::uint32_t primary_id = 0;           ///< who is in control; 0: nobody, or not known
    bool bodies_are_new = false;            ///< computed for this very frame
    std::optional<TrackingTimes> tracking;  ///< of bodies that were found in the depth
    StageTimes times;
    TimeNs arrived = 0;         ///< host clock: the source handed the set over
    TimeNs ready = 0;           ///< host clock: this frame was made
    std::uint64_t version = 0;  ///< differs from frame to frame
};

}  // namespace kino
