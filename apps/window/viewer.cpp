#include "apps/window/viewer.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <utility>

#include "apps/interrupt.h"
#include "apps/viewer/budget_log.h"
#include "apps/viewer/ply.h"
#include "sensor/png_io.h"

namespace kino {
namespace {

constexpr TimeNs kPictureTime = kNsPerSecond / 60;
constexpr TimeNs kIdleTime = kNsPerSecond / 10;
constexpr TimeNs kLookForFrame = 2 * kNsPerMs;
constexpr TimeNs kMessageTime = 4 * kNsPerSecond;
/// With several recordings, each is shown at least this long before the next.
constexpr TimeNs kLeastShown = 10 * kNsPerSecond;

/// "kinoscope-NNN.png" that is not there yet.
std::filesystem::path fresh_file(const char* extension) {
    for (int i = 1;; ++i) {
        std::filesystem::path path = fmt::format("kinoscope-{:03}.{}", i, extension);
        std::error_code error;
        if (!std::filesystem::exists(path, error) || i >= 999) return path;
    }
}

}  // namespace

Viewer::Viewer(const ReplayOptions& options, const Settings& settings, Window& window,
               gpu::Device& device, UiContext& context, UiRenderer& ui)
    : options_(options),
      uris_(options.uris),
      window_(window),
      context_(context),
      ui_(ui),
      renderer_(device),
      panes_(ui),
      settings_(settings),
      budget_({}),
      chooser_({}) {
    accuracy_.want_true_error(options.true_error);
    draw_options_ = {
        .style = settings.style, .splat_px = settings.splat_px, .color = options.color};
    camera_.kind = settings.view;
}

Settings Viewer::settings() const {
    Settings settings = settings_;
    settings.style = draw_options_.style;
    settings.splat_px = draw_options_.splat_px;
    settings.view = camera_.kind;
    if (view_.width > 0) {
        settings.width = view_.width;
        settings.height = view_.height;
    }
    return settings;
}

void Viewer::say(std::string text) {
    message_ = std::move(text);
    message_until_ = now_ns() + kMessageTime;
}

Result<void> Viewer::open(std::size_t index) {
    KINO_ASSIGN(auto playing, Playing::open(uris_[index], {.loop = options_.loop,
                                                           .speed = options_.speed,
                                                           .filters = options_.filters,
                                                           .bodies = options_.bodies,
                                                           .wants_people = options_.wants_people(),
                                                           .calibration = options_.calibration,
                                                           .stepped = options_.stepped}));
    desk_.reset();
    playing_ = std::move(playing);
    if (Controls* controls = playing_->runner().controls()) {
        desk_ = std::make_unique<ControlsDesk>(*controls);
    }
    heard_events_ = 0;
    current_ = index;
    frame_.reset();
    builder_.reset();
    panes_.reset();
    alignment_.reset();
    measure_.clear();
    camera_placed_ = false;
    opened_at_ = now_ns();
    frames_per_s_ = 0;
    if (window_camera_) window_camera_->reset();
    renderer_.cut();
    scene_cut_ = true;
    window_.set_title(fmt::format("{} - Kinoscope", playing_->info().name));
    return {};
}

void Viewer::open_next_when_over() {
    if (uris_.size() < 2) return;
    const LiveStatus status = playing_->runner().status();
    const TimeNs shown = now_ns() - opened_at_;
    const auto round = static_cast<TimeNs>(static_cast<double>(playing_->round()) / status.speed);
    if (status.paused || shown < std::max(kLeastShown, round)) return;
    act(Action::next_source);
}

void Viewer::show_frame(const ProcessedFrame& frame) {
    builder_.show(frame);
    if (window_camera_) {
        // A recording's times are no times of this clock.
        window_camera_->see(playing_->is_device() ? frame.set.time : now_ns(),
                            frame.set.bodies.get());
    }
    const bool moved = builder_.advance(0) && camera_.orbit.sways();
    if (!frame.surface) {
        // Nothing to stand anywhere: only pictures.
    } else if (!std::exchange(camera_placed_, true) || moved) {
        camera_.reset(*builder_.place());
    } else if (builder_.director() == nullptr && frame.set.pose_origin == PoseOrigin::trajectory) {
        camera_.orbit.follow(measure_place(frame).center, to_seconds(now_ns() - last_frame_));
    }
    if (settings_.show_panes) {
        if (const auto shown = panes_.show(frame); !shown) say(shown.error().to_string());
    }
    if (settings_.show_overlay && frame.surface && frame.color && frame.set.color_paired) {
        alignment_.look(frame.surface->depth_m, *frame.surface->rays, *frame.color,
                        playing_->rig());
    }
    const TimeNs now = now_ns();
    if (last_frame_ != 0) smooth_rate(frames_per_s_, now - last_frame_);
    last_frame_ = now;
    frame_ = frame;
    frame_is_fresh_ = true;
}

void Viewer::act(Action action) {
    switch (action) {
        case Action::measure:
            measuring_ = !measuring_;
            if (measuring_) camera_.orbit.hold_still();
            measure_.clear();
            break;
        case Action::screenshot:
            screenshot_wanted_ = true;
            break;
        case Action::export_ply:
            export_points();
            break;
        case Action::record:
            toggle_recording();
            break;
        case Action::toggle_controls:
            if (!desk_) say("this source has no knobs");
            show_controls_ = !show_controls_;
            break;
        case Action::toggle_bodies:
            toggle_bodies();
            break;
        case Action::toggle_overlay:
            settings_.show_overlay = !settings_.show_overlay;
            break;
        case Action::toggle_panes:
            settings_.show_panes = !settings_.show_panes;
            if (settings_.show_panes && frame_) (void)panes_.show(*frame_);
            break;
        case Action::toggle_help:
            help_ = !help_;
            break;
        case Action::quit:
            window_.close();
            break;
        case Action::next_source:
            if (const auto opened = open((current_ + 1) % uris_.size()); !opened) {
                say(opened.error().to_string());
                opened_at_ = now_ns();
            }
            break;
        default:
            act_on_playing(action);
            act_on_look(action);
    }
}

void Viewer::act_on_playing(Action action) {
    LiveRunner& runner = playing_->runner();
    const LiveStatus status = runner.status();
    switch (action) {
        case Action::pause:
            status.paused || status.finished ? runner.resume() : runner.pause();
            break;
        case Action::step_forward:
            runner.step(1);
            break;
        case Action::step_back:
            runner.step(-1);
            break;
        case Action::faster:
            runner.set_speed(status.speed * std::sqrt(2.0));
            break;
        case Action::slower:
            runner.set_speed(status.speed / std::sqrt(2.0));
            break;
        case Action::normal_speed:
            runner.set_speed(1);
            break;
        case Action::to_start:
            runner.seek(0);
            break;
        case Action::next_loop_mode:
            runner.set_mode(status.mode == LoopMode::loop        ? LoopMode::ping_pong
                            : status.mode == LoopMode::ping_pong ? LoopMode::once
                                                                 : LoopMode::loop);
            break;
        default:
            break;
    }
}

void Viewer::act_on_look(Action action) {
    const ColorMode color = builder_.color_mode(draw_options_);
    switch (action) {
        case Action::toggle_style:
            draw_options_.style =
                draw_options_.style == DepthStyle::mesh ? DepthStyle::cloud : DepthStyle::mesh;
            break;
        case Action::larger_splats:
            draw_options_.splat_px = std::min(32, draw_options_.splat_px + 1);
            break;
        case Action::smaller_splats:
            draw_options_.splat_px = std::max(1, draw_options_.splat_px - 1);
            break;
        case Action::next_color_mode:
            draw_options_.color = color == ColorMode::captured ? ColorMode::mixed
                                  : color == ColorMode::mixed  ? ColorMode::relit
                                                               : ColorMode::captured;
            break;
        case Action::sensor_view:
            camera_.choose(ViewKind::sensor, view_.world_from_view);
            break;
        case Action::orbit_view:
            camera_.choose(ViewKind::orbit, view_.world_from_view);
            break;
        case Action::fly_view:
            camera_.choose(ViewKind::fly, view_.world_from_view);
            break;
        case Action::reset_camera:
            if (builder_.director() != nullptr && builder_.place()) {
                camera_.reset(*builder_.place());
            } else if (frame_ && frame_->surface) {
                camera_.reset(measure_place(*frame_));
            }
            break;
        default:
            break;
    }
}

void Viewer::act_on_input(const WindowInput& input, double dt_s) {
    for (const KeyPress& key : input.keys) {
        if (context_.wants_keyboard() || key.control) continue;
        // In flight these letters move the camera.
        const bool flies =
            camera_.kind == ViewKind::fly &&
            std::string("WASDQE").find(static_cast<char>(key.key)) != std::string::npos &&
            key.key < 128;
        if (flies) continue;
        if (const auto action = action_of(key.key, key.repeat)) act(*action);
    }
    for (const std::filesystem::path& path : input.dropped) {
        std::error_code error;
        // A file of a recording stands for its folder.
        const bool folder = std::filesystem::is_directory(path, error);
        uris_.push_back(folder ? path.string() : path.parent_path().string());
        if (const auto opened = open(uris_.size() - 1); !opened) {
            uris_.pop_back();
            say(opened.error().to_string());
        }
    }
    steering_.steer(window_, input, context_.wants_mouse(), dt_s, camera_);
    if (steering_.take_click()) click();
}

void Viewer::click() {
    if (!measuring_ || !last_.depth_at_m || !probed_) return;
    measure_.add(point_at(view_, glm::dvec2(*probed_), *last_.depth_at_m));
}

void Viewer::take_screenshot() {
    FrameOptions options;
    options.raster = options_.raster;
    options.samples = static_cast<std::uint32_t>(samples_);
    options.read_picture = true;
    auto drawn = renderer_.render_to_image(builder_.scene(draw_options_), view_, options);
    if (!drawn) return say(drawn.error().to_string());
    const std::filesystem::path path = fresh_file("png");
    const auto written = write_png_rgba8(path, std::as_const(drawn->picture).view());
    say(written ? "picture written: " + path.string() : written.error().to_string());
}

void Viewer::export_points() {
    if (!frame_ || !frame_->surface) return;
    const std::filesystem::path path = fresh_file("ply");
    const auto written = write_ply(path, *frame_->surface, frame_->set.world_from_depth);
    say(written ? fmt::format("{} points written: {}", *written, path.string())
                : written.error().to_string());
}

void Viewer::start_recording(const std::filesystem::path& file) {
    const auto started = playing_->runner().start_recording(file, options_.codec);
    say(started ? "recording into " + file.string() : started.error().to_string());
}

void Viewer::toggle_recording() {
    LiveRunner& runner = playing_->runner();
    if (!runner.status().is_recording) return start_recording(fresh_file("mkv"));
    runner.stop_recording();
    say("recording ended");
}

void Viewer::toggle_bodies() {
    const bool on = !playing_->runner().status().bodies;
    // A trouble that stays is told again.
    bodies_trouble_.clear();
    playing_->runner().set_bodies(on);
    say(on ? "looking for bodies" : "bodies off");
}

/// What the source and the recorder said since last asked.
void Viewer::hear_source() {
    const LiveStatus status = playing_->runner().status();
    // The first event of all says that it has started, which everybody can see.
    if (status.events > heard_events_ && heard_events_ > 0) say(status.last_event);
    heard_events_ = std::max(heard_events_, status.events);
    const std::string trouble = status.recording ? status.recording->error : std::string();
    if (!trouble.empty() && trouble != recording_trouble_) say("recording: " + trouble);
    recording_trouble_ = trouble;
    if (!status.bodies_error.empty() && status.bodies_error != bodies_trouble_) {
        say(status.bodies_error);
    }
    bodies_trouble_ = status.bodies_error;
    for (const GestureEvent& gesture : playing_->runner().take_gestures()) {
        gesture_lines_.add(gesture, now_ns());
    }
}

/// The stage, and how accurately it is drawn.
Result<void> Viewer::set_stage() {
    std::optional<SceneFile> scene;
    if (!options_.scene.empty()) {
        KINO_ASSIGN(StageSet stage, open_stage(options_.scene));
        const SceneLive& live = stage.file.live;
        if (!options_.style) draw_options_.style = live.style;
        if (!options_.splat_px) draw_options_.splat_px = live.splat_px;
        if (stage.file.camera.window) window_camera_.emplace(*stage.file.camera.window);
        scene = stage.file;
        builder_.put_on_stage(std::make_unique<Director>(std::move(stage)));
    }
    const PictureQuality quality = options_.quality(scene ? &*scene : nullptr);
    budget_ = FrameBudget(quality.budget);
    chooser_.set(quality.zoom);
    samples_ = quality.samples;
    if (!options_.lod_log.empty()) {
        KINO_ASSIGN(auto log, read_budget_log(options_.lod_log));
        budget_.replay(std::move(log));
    }
    return {};
}

Result<void> Viewer::run(const std::string& note) {
    started_ = now_ns();
    if (!note.empty()) say(note);
    KINO_TRY(set_stage());
    KINO_TRY(open(0));
    if (!options_.record.empty()) start_recording(options_.record);
    TimeNs next_picture = started_;
    TimeNs last_loop = started_;
    while (!window_.should_close() && !interrupted() &&
           (!options_.frames || pictures_ < *options_.frames)) {
        // A fresh frame does not end the waiting, so it is kept short.
        const WindowInput input =
            window_.poll(std::clamp<TimeNs>(next_picture - now_ns(), 0, kLookForFrame));
        const TimeNs now = now_ns();
        act_on_input(input, std::min(0.1, to_seconds(now - last_loop)));
        last_loop = now;
        std::optional<ProcessedFrame> fresh = playing_->take();
        if (fresh) show_frame(*fresh);
        hear_source();
        if (now >= next_picture || (fresh && !is_paced())) {
            KINO_TRY(draw(input, now));
            // Between two sensor frames only pictures that are cheap: a dear one would delay the
            // next frame's own.
            const TimeNs spent = now_ns() - now;
            next_picture =
                now + (window_.minimised() ? kIdleTime : std::max(kPictureTime, 2 * spent));
            if (is_paced() && !window_.minimised()) next_picture = next_turn();
        }
        open_next_when_over();
    }
    if (const std::string recorded = playing_->stop(); !recorded.empty())
        fmt::print(stderr, "{}\n", recorded);
    return {};
}

}  // namespace kino
