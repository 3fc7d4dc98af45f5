#pragma once

#include <glm/vec2.hpp>
#include <optional>
#include <string>
#include <vector>

#include "apps/pipeline/controls_desk.h"
#include "apps/pipeline/live_runner.h"
#include "apps/viewer/latency.h"
#include "apps/viewer/measure.h"
#include "apps/window/panes.h"
#include "skeleton/gestures/gesture_event.h"
#include "viz/graph/executor.h"
#include "viz/scene/view.h"

namespace kino {

/// What the overlay says; gathered by the viewer, drawn by draw_overlay().
struct OverlayText {
    std::string name;
    std::string note;
    std::vector<std::string> streams;
    double pictures_per_s = 0;
    double frames_per_s = 0;
    double frame_ms = 0;  ///< device time of the last picture
    std::vector<graph::GroupTime> groups;
    StageTimes stages;
    std::string people;  ///< who is seen; empty: bodies are off and none are recorded
    std::optional<TrackingTimes> tracking;
    Latency latency;
    std::string alignment;  ///< LiveAlignment::words()
    std::string recording;  ///< empty: none
    std::int64_t points = 0;
    std::vector<std::string> passes;
    std::int64_t device_bytes = 0;
    std::int64_t dropped = 0;
    std::int64_t errors = 0;
    std::string last_error;
    std::string mode;  ///< "orbit view, mesh, captured colour"
};
void draw_overlay(const OverlayText& text);

/// The sensor's images, top right.
void draw_panes(const Panes& panes);

/// What the user did to the time line.
struct TimelineRequest {
    std::optional<std::int64_t> seek;
    bool toggle_pause = false;
};
/// At the bottom; `now` and `length` in recorded time.
[[nodiscard]] TimelineRequest draw_timeline(const LiveStatus& status, TimeNs now, TimeNs length);

/// A device's knobs, on the left; empty `knobs` draws nothing. What the user moved is set.
void draw_controls(ControlsDesk& desk);

/// A line that stays: the device is away.
void draw_banner(const std::string& words);

/// The keys, in the middle. False once it was closed.
[[nodiscard]] bool draw_help();

/// Metres beside the pointer.
void draw_cursor_depth(const glm::dvec2& cursor_px, float depth_m);

/// The measured points, the line between them, its length.
void draw_measure(const Measure& measure, const View& view, bool active);

/// The number of each person over their head, in the colour of their joints, with a star for the
/// one in control.
void draw_body_labels(const ProcessedFrame& frame, const View& view);

/// What people did, newest at the bottom; each line fades within three seconds.
class GestureLines {
  public:
    void add(const GestureEvent& event, TimeNs now);
    void draw(TimeNs now);

  private:
    struct Line {
        GestureEvent event;
        TimeNs since = 0;
    };
    std::vector<Line> lines_;
};

/// A line that goes away by itself, above the time line.
void draw_message(const std::string& text);

}  // namespace kino
