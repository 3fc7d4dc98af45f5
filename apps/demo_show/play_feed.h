#pragma once

#include <glm/vec3.hpp>
#include <optional>
#include <span>

#include "apps/demo/demo_play.h"
#include "apps/demo_show/gesture_places.h"
#include "apps/demo_show/show_screen.h"
#include "apps/pipeline/processed_frame.h"

namespace kino {

/// Turns frames into moments of the play.
class PlayFeed {
  public:
    /// Another source: what was seen of the last is forgotten.
    void reset();
    void show(const ProcessedFrame& frame);
    /// `gestures` and what show() was given last must live until the moment was played.
    [[nodiscard]] DemoMoment moment(double dt_s, std::span<const GestureEvent> gestures,
                                    bool lost) const;
    /// Gestures of frames that show() was given; before guide().
    void hear(std::span<const GestureEvent> gestures);
    /// Puts what the play tells people onto the screen.
    void guide(const DemoPlay& play, bool mirror, ShowScreen& screen) const;
    [[nodiscard]] bool has_frame() const { return frame_.has_value(); }

  private:
    std::optional<ProcessedFrame> frame_;
    std::optional<glm::dvec3> middle_m_;
    GesturePlaces places_;
};

}  // namespace kino
