#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/demo_show/play_feed.h"
#include "apps/demo_show/screen_painter.h"
#include "apps/demo_show/show_keys.h"
#include "apps/demo_show/show_options.h"
#include "apps/demo_sources/source_desk.h"
#include "apps/pipeline/time_series.h"
#include "apps/viewer/frame_budget.h"
#include "apps/viewer/latency.h"
#include "viz/output/window.h"

namespace kino {

/// The demo's loop in a window: takes what the desk shows, lets it be played, draws it.
class ShowWindow {
  public:
    ShowWindow(const ShowOptions& options, const ShowHelp& help, Window& window,
               gpu::Device& device);

    /// Until the window closes or options.frames pictures were shown. `began`: of the program.
    [[nodiscard]] Result<void> run(TimeNs began);
    /// How it kept up, for a person or as JSON.
    [[nodiscard]] std::string report() const;

  private:
    Result<void> open();
    void act(ShowAction action);
    void take(SourceDesk::Shown shown, TimeNs now);
    void toggle_recording();
    void toggle_fullscreen();
    void say(std::string text);
    [[nodiscard]] ShowScreen screen(TimeNs now);
    [[nodiscard]] std::vector<std::string> stats() const;
    Result<void> draw(TimeNs now);
    Result<void> warm(const View& view);
    void hear_play();

    const ShowOptions& options_;
    const ShowHelp& help_;
    Window& window_;
    Renderer renderer_;
    FrameBudget budget_;
    std::unique_ptr<ScreenPainter> painter_;
    std::optional<DemoPlay> play_;
    std::unique_ptr<SourceDesk> desk_;
    PlayFeed feed_;

    ShowMode mode_ = ShowMode::live;
    std::vector<GestureEvent> heard_;      ///< gestures that no picture shows yet
    std::optional<ProcessedFrame> fresh_;  ///< that no picture shows yet
    bool paused_ = false, keys_ = false, stats_ = false, screenshot_ = false, warmed_ = false,
         told_why_ = false;
    std::optional<glm::ivec4> windowed_;  ///< place and size before the whole screen was filled
    std::string note_;
    TimeNs note_until_ = 0;
    TimeNs opened_ = 0, last_step_ = 0, last_draw_ = 0;
    std::string scene_name_;
    double scene_name_shown_s_ = 1e9;
    glm::ivec2 size_{0};

    std::int64_t pictures_ = 0, in_time_ = 0;
    TimeSeries picture_times_;
    LatencyLog latencies_;
    double pictures_per_s_ = 0;
    TimeNs first_picture_ = 0;
};

}  // namespace kino
