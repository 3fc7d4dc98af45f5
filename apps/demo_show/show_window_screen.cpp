#include <fmt/format.h>

#include <utility>

#include "apps/demo_show/show_window.h"

namespace kino {
namespace {

constexpr TimeNs kSilence = kNsPerSecond;  ///< of a sensor, before it is told

}  // namespace

std::vector<std::string> ShowWindow::stats() const {
    const FrameChoice& choice = budget_.choice();
    std::vector<std::string> lines = {
        fmt::format("{:.1f} pictures a second, {:.1f} ms each (target {:.1f})", pictures_per_s_,
                    picture_times_.median_ms(), options_.target_ms),
        fmt::format("scene {}, {} lights", play_->scene_name(), play_->local_lights())};
    std::string levels;
    for (const std::string& level : choice.levels) levels += (levels.empty() ? "" : ", ") + level;
    lines.push_back("quality: " + (levels.empty() ? "full" : levels));
    return lines;
}

ShowScreen ShowWindow::screen(TimeNs now) {
    ShowScreen screen;
    feed_.guide(*play_, options_.mirror, screen);
    screen.scene_name = scene_name_;
    screen.scene_name_shown_s = scene_name_shown_s_;
    screen.keys = keys_;
    if (mode_ == ShowMode::lost) {
        screen.trouble = ShowScreen::Trouble{
            "The sensor is gone", "Check its cable and its power: it goes on by itself."};
    } else if (mode_ == ShowMode::attract) {
        if (desk_->has_sensor()) {
            screen.banner = "step in front of the sensor";
        } else if (const auto trouble = desk_->trouble()) {
            screen.banner = "no sensor: watching a recording";
            if (!std::exchange(told_why_, true)) {
                fmt::print(stderr, "kinoscope: {}\n", trouble->what);
            }
        }
    } else if (!feed_.has_frame() && now - opened_ > kSilence) {
        screen.banner = "waiting for the sensor";
    }
    if (paused_) screen.note = "paused";
    if (now < note_until_) screen.note = note_;
    if (stats_) screen.stats = stats();
    if (LiveRunner* runner = desk_->runner()) {
        const LiveStatus status = runner->status();
        screen.records = status.is_recording;
        if (status.recording && !status.recording->error.empty()) {
            screen.note = "recording: " + status.recording->error;
        }
        if (!status.bodies_error.empty()) screen.note = status.bodies_error;
    }
    return screen;
}

}  // namespace kino
