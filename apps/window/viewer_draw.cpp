#include <imgui.h>

#include <algorithm>
#include <chrono>
#include <thread>
#include <utility>

#include "apps/window/viewer.h"

namespace kino {
namespace {

/// Acquiring the picture, the user interface, handing it over.
constexpr double kBesideDrawingMs = 2;

}  // namespace

void smooth_rate(double& rate, TimeNs since_last) {
    if (since_last <= 0) return;
    const double now = 1 / to_seconds(since_last);
    const double part = rate == 0 ? 1 : std::min(1.0, 2 * to_seconds(since_last));
    rate += part * (now - rate);
}

void Viewer::draw_panels(const WindowInput& input) {
    if (settings_.show_overlay && !help_) draw_overlay(overlay_text());
    if (settings_.show_overlay && !help_ &&
        (builder_.director() != nullptr || budget_.mode() != GovernorMode::off))
        accuracy_.draw(budget_, chooser_);
    // In a small window the picture matters more.
    if (settings_.show_panes && !help_ && view_.width >= 760) draw_panes(panes_);
    LiveRunner& runner = playing_->runner();
    const LiveStatus status = runner.status();
    const TimelineRequest request =
        draw_timeline(status, playing_->time_of(status.position),
                      status.frame_count > 0 ? playing_->time_of(status.frame_count - 1) : 0);
    if (request.seek) runner.seek(*request.seek);
    if (request.toggle_pause) act_on_playing(Action::pause);
    if (frame_ && !help_) draw_body_labels(*frame_, view_);
    gesture_lines_.draw(now_ns());
    draw_measure(measure_, view_, measuring_);
    if (last_.depth_at_m && probed_) draw_cursor_depth(input.cursor_px, *last_.depth_at_m);
    if (show_controls_ && desk_) draw_controls(*desk_);
    if (!status.present) draw_banner("the device is gone; plugged in again, it goes on by itself");
    if (!message_.empty() && now_ns() < message_until_) draw_message(message_);
    if (help_) help_ = draw_help();
}

FrameOptions Viewer::picture_options(const WindowInput& input, ImDrawData& lists) {
    FrameOptions options;
    options.raster = options_.raster;
    options.samples = static_cast<std::uint32_t>(samples_);
    options.part_rates = options_.part_rates;
    options.regions = options_.regions;
    options.timing = settings_.show_overlay ? graph::Timing::one_group : graph::Timing::frame;
    probed_.reset();
    const glm::ivec2 cursor(input.cursor_px);
    if (!context_.wants_mouse() && cursor.x >= 0 && cursor.y >= 0 && cursor.x < view_.width &&
        cursor.y < view_.height) {
        probed_ = options.probe_px = cursor;
    }
    options.overlay = [this, &lists](graph::FrameGraph& graph, graph::TextureId picture) {
        auto drawn = ui_.add(graph, picture, lists);
        if (drawn) return *drawn;
        ui_error_ = drawn.error();
        return picture;
    };
    return options;
}

/// Until the user takes the camera.
bool Viewer::looks_through_window() const {
    return window_camera_ && camera_.kind == ViewKind::orbit && camera_.orbit.sways() &&
           builder_.director() != nullptr && builder_.director()->world_from_stage();
}

/// Draws the scene as the budget or the chooser says, and tells them what that took.
Result<void> Viewer::render(const PictureTarget& target, FrameOptions& options) {
    const Scene& scene = builder_.scene(draw_options_);
    const TimeNs began = now_ns();
    if (chooser_.on()) {
        const auto head_m_s =
            looks_through_window() ? std::optional(window_camera_->head_m_s(began)) : std::nullopt;
        budget_.set_zoom(chooser_.begin_frame(scene, view_, began, head_m_s, options));
    }
    budget_.begin_frame(scene, view_, options);
    KINO_ASSIGN(last_, renderer_.render(scene, view_, target, options));
    if (ui_error_) return fail(*std::exchange(ui_error_, std::nullopt));
    const glm::ivec2 size(view_.width, view_.height);
    const bool resized = std::exchange(last_size_, size) != size;
    const bool cut = std::exchange(scene_cut_, false);
    // Before three pictures are through, pipelines are still being made.
    const double took_ms = to_ms(now_ns() - began);
    const bool says_nothing = pictures_ < 3 || resized || cut;
    budget_.frame_took(last_, took_ms, says_nothing);
    chooser_.frame_took(last_, took_ms, says_nothing);
    if (accuracy_.true_error_due(pictures_)) {
        KINO_ASSIGN(const TrueError error, measure_true_error(renderer_, scene, view_, options));
        accuracy_.found(error);
        scene_cut_ = true;
    }
    return {};
}

bool Viewer::is_paced() const {
    const bool holds_rate = budget_.mode() == GovernorMode::automatic || options_.target_ms;
    return holds_rate && !playing_->is_stepped();
}

/// When to begin the next picture: as late as it can be, so that it shows what is newest.
TimeNs Viewer::next_turn() {
    pacer_.set_period(static_cast<TimeNs>(budget_.target_ms() * static_cast<double>(kNsPerMs)));
    const double expected_ms = budget_.expected_ms() + kBesideDrawingMs;
    return pacer_.begin_at(now_ns(),
                           static_cast<TimeNs>(expected_ms * static_cast<double>(kNsPerMs)));
}

TimeNs Viewer::wait_for_turn() {
    if (!is_paced()) return 0;
    const TimeNs ready = now_ns();
    std::this_thread::sleep_for(std::chrono::nanoseconds(pacer_.show_at(ready) - ready));
    const TimeNs shown = now_ns();
    pacer_.shown(shown);
    return shown - ready;
}

Result<void> Viewer::draw(const WindowInput& input, TimeNs now) {
    const TimeNs began = now_ns();
    KINO_ASSIGN(const std::optional<PictureTarget> target, window_.begin_picture());
    if (!target) return {};
    const TimeNs waited = now_ns() - began;
    const Pose world_from_depth = frame_ ? frame_->set.world_from_depth : world_from_camera_axes();
    camera_.orbit.set_time(to_seconds(now - started_));
    view_ = camera_.view(playing_->rig().depth, world_from_depth,
                         static_cast<int>(target->extent.width),
                         static_cast<int>(target->extent.height));
    if (looks_through_window()) {
        // For when the picture will be there, if it takes as long as the last one.
        view_ = window_camera_->view(*builder_.director()->world_from_stage(),
                                     now_ns() + last_.report.submit_to_fence, view_.width,
                                     view_.height);
    }
    if (std::exchange(screenshot_wanted_, false)) {
        take_screenshot();
        scene_cut_ = true;
    }
    context_.begin_frame();
    draw_panels(input);
    ImDrawData& lists = context_.end_frame();

    FrameOptions options = picture_options(input, lists);
    if (looks_through_window()) {
        options.deflect = window_camera_->deflection(*builder_.director()->world_from_stage(),
                                                     now_ns(), view_.width, view_.height, now_ns);
    }
    // Between pictures as the clock says; stepped, as the recording does; held while it pauses.
    const LiveStatus status = playing_->runner().status();
    const double shown_s = playing_->is_stepped() ? to_seconds(playing_->time_of(status.position))
                                                  : to_seconds(now - started_);
    const double passed_s = shown_s - std::exchange(stage_time_s_, shown_s);
    builder_.advance(status.paused ? 0 : passed_s);
    KINO_TRY(render(*target, options));
    const TimeNs paused = wait_for_turn();
    const TimeNs drawn = now_ns();
    KINO_TRY(window_.present());
    waits_.add(waited + now_ns() - drawn);
    ++pictures_;
    if (frame_) {
        const TimeNs presented = now_ns();
        picture_times_.add(presented - began - paused);
        if (std::exchange(frame_is_fresh_, false)) {
            latency_ = latency_of(*frame_, playing_->is_device(), began, presented);
            latencies_.add(latency_);
        }
        if (first_picture_after_ == 0) first_picture_after_ = now_ns() - started_;
    }
    playing_->picture_shown();
    const TimeNs shown_at = now_ns();
    if (last_picture_ != 0) {
        smooth_rate(pictures_per_s_, shown_at - last_picture_);
        intervals_.add(shown_at - last_picture_);
    }
    last_picture_ = shown_at;
    return {};
}

}  // namespace kino
