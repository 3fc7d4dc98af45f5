#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/pipeline/controls_desk.h"
#include "apps/pipeline/time_series.h"
#include "apps/replay_options.h"
#include "apps/viewer/frame_pacer.h"
#include "apps/viewer/keys.h"
#include "apps/viewer/latency.h"
#include "apps/viewer/measure.h"
#include "apps/viewer/scene_builder.h"
#include "apps/viewer/settings.h"
#include "apps/viewer/window_camera.h"
#include "apps/viewer/zoom_chooser.h"
#include "apps/window/accuracy_strip.h"
#include "apps/window/panels.h"
#include "apps/window/playing.h"
#include "apps/window/steering.h"
#include "calibration/live_alignment.h"
#include "viz/output/ui/ui_context.h"
#include "viz/output/window.h"

namespace kino {

/// Moves `rate`, 1/s, to the mean of the last second or so.
void smooth_rate(double& rate, TimeNs since_last);

/// The window's loop: takes the newest frame, steers the camera, draws the picture and the user
/// interface over it.
class Viewer {
  public:
    Viewer(const ReplayOptions& options, const Settings& settings, Window& window,
           gpu::Device& device, UiContext& context, UiRenderer& ui);

    /// Until the window closes or options.frames pictures were shown. `note`: shown at first.
    [[nodiscard]] Result<void> run(const std::string& note);
    /// As the user left them.
    [[nodiscard]] Settings settings() const;
    /// From the start of each picture to its hand-over to the window system.
    [[nodiscard]] const TimeSeries& picture_times() const { return picture_times_; }
    /// From run() to the first picture with a frame in it; 0: there was none.
    [[nodiscard]] TimeNs first_picture_after() const { return first_picture_after_; }
    [[nodiscard]] const LatencyLog& latencies() const { return latencies_; }
    /// How accurately pictures were drawn.
    [[nodiscard]] const FrameBudget& budget() const { return budget_; }
    [[nodiscard]] const ZoomChooser& chooser() const { return chooser_; }
    /// From hand-over to hand-over, and what of that begin_picture() and present() waited.
    [[nodiscard]] const TimeSeries& intervals() const { return intervals_; }
    [[nodiscard]] const TimeSeries& waits() const { return waits_; }

  private:
    Result<void> set_stage();
    Result<void> open(std::size_t index);
    void open_next_when_over();
    void show_frame(const ProcessedFrame& frame);
    void act(Action action);
    void act_on_playing(Action action);
    void act_on_look(Action action);
    void act_on_input(const WindowInput& input, double dt_s);
    Result<void> draw(const WindowInput& input, TimeNs now);
    [[nodiscard]] FrameOptions picture_options(const WindowInput& input, ImDrawData& lists);
    [[nodiscard]] bool looks_through_window() const;
    Result<void> render(const PictureTarget& target, FrameOptions& options);
    /// Pictures are shown at the target's rate rather than with the sensor's frames.
    [[nodiscard]] bool is_paced() const;
    [[nodiscard]] TimeNs next_turn();
    /// Until the picture's turn; returns how long.
    TimeNs wait_for_turn();
    void draw_panels(const WindowInput& input);
    [[nodiscard]] OverlayText overlay_text();
    void start_recording(const std::filesystem::path& file);
    void toggle_recording();
    void toggle_bodies();
    void hear_source();
    void click();
    void take_screenshot();
    void export_points();
    void say(std::string text);

    ReplayOptions options_;
    std::vector<std::string> uris_;
    Window& window_;
    UiContext& context_;
    UiRenderer& ui_;
    Renderer renderer_;
    Panes panes_;
    Settings settings_;
    DrawOptions draw_options_;
    CameraControl camera_;
    bool camera_placed_ = false;
    Steering steering_;
    std::optional<WindowCamera> window_camera_;  ///< of scenes whose screen is a window
    SceneBuilder builder_;
    double stage_time_s_ = 0;  ///< of the last picture, by the stage's clock

    std::size_t current_ = 0;
    std::unique_ptr<Playing> playing_;
    std::unique_ptr<ControlsDesk> desk_;  ///< goes before `playing_`, whose knobs it turns
    bool show_controls_ = false;
    std::int64_t heard_events_ = 0;
    std::string recording_trouble_;
    std::string bodies_trouble_;
    GestureLines gesture_lines_;
    std::optional<ProcessedFrame> frame_;
    bool frame_is_fresh_ = false;
    LiveAlignment alignment_;
    Latency latency_;
    LatencyLog latencies_;
    TimeNs opened_at_ = 0;

    View view_;
    FrameResult last_;
    FrameBudget budget_;
    ZoomChooser chooser_;
    int samples_ = 1;
    FramePacer pacer_{kNsPerSecond / 30};
    AccuracyStrip accuracy_;
    bool scene_cut_ = true;  ///< the next picture's time says nothing
    glm::ivec2 last_size_{0};
    TimeNs started_ = 0;
    std::int64_t pictures_ = 0;
    TimeSeries picture_times_, intervals_, waits_;
    TimeNs first_picture_after_ = 0;
    double pictures_per_s_ = 0;
    double frames_per_s_ = 0;
    TimeNs last_picture_ = 0;
    TimeNs last_frame_ = 0;

    bool help_ = false;
    bool measuring_ = false;
    Measure measure_;
    std::optional<glm::ivec2> probed_;
    bool screenshot_wanted_ = false;
    std::string message_;
    TimeNs message_until_ = 0;
    std::optional<Error> ui_error_;
};

}  // namespace kino
