#include "apps/demo_show/show_window.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "apps/demo_show/show_play.h"
#include "sensor/png_io.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace kino {
namespace {

/// Pictures come with the sensor's frames; without any they come this often.
constexpr TimeNs kIdlePicture = 50 * kNsPerMs;
constexpr TimeNs kMinimised = kNsPerSecond / 10;
constexpr TimeNs kLookForFrame = 2 * kNsPerMs;
constexpr TimeNs kNoteTime = 4 * kNsPerSecond;
/// Rather late than without edges: half the pixels with an eighth of the light is the least.
constexpr double kWorstError = 0.08;
constexpr int kWarmPart = 4;  ///< side of a picture that is drawn for its pipelines

FrameBudgetOptions budget_of(const ShowOptions& options) {
    if (options.lod) {
        return {.mode = GovernorMode::fixed, .target_ms = options.target_ms, .lod = *options.lod};
    }
    return {.mode = GovernorMode::automatic,
            .target_ms = options.target_ms,
            .worst_error = kWorstError};
}

/// "kinoscope-NNN.png" that is not there yet.
std::filesystem::path unused_file(const char* extension) {
    for (int i = 1;; ++i) {
        std::filesystem::path path = fmt::format("kinoscope-{:03}.{}", i, extension);
        std::error_code error;
        if (!std::filesystem::exists(path, error) || i >= 999) return path;
    }
}

}  // namespace

ShowWindow::ShowWindow(const ShowOptions& options, const ShowHelp& help, Window& window,
                       gpu::Device& device)
    : options_(options),
      help_(help),
      window_(window),
      renderer_(device),
      budget_(budget_of(options)) {}

void ShowWindow::say(std::string text) {
    note_ = std::move(text);
    note_until_ = now_ns() + kNoteTime;
}

Result<void> ShowWindow::open() {
    SourceDeskOptions desk;
    const auto runner_of = [this](const std::string& uri,
                                  LoopMode loop) -> Result<std::unique_ptr<LiveRunner>> {
        KINO_ASSIGN(OpenedSource opened, open_for_playing(uri, show_play_options(options_, loop)));
        return std::make_unique<LiveRunner>(std::move(opened));
    };
    desk.waits = options_.uri.empty();
    desk.open_live = [this, runner_of]() -> Result<std::unique_ptr<LiveRunner>> {
        std::string uri = options_.uri;
        if (uri.empty()) {
            KINO_ASSIGN(uri, help_.find_device());
        }
        return runner_of(uri, LoopMode::loop);
    };
    desk.open_performance = [runner_of] { return runner_of(performance_uri(), LoopMode::loop); };
    KINO_ASSIGN(desk_, SourceDesk::create(std::move(desk)));
    KINO_ASSIGN(DemoPlay play, make_play(options_));
    play_.emplace(std::move(play));
    scene_name_ = play_->scene_name();
    KINO_ASSIGN(painter_,
                ScreenPainter::create(renderer_.device(), window_.handle(), options_.height));
    return {};
}

void ShowWindow::toggle_recording() {
    LiveRunner* runner = desk_->runner();
    if (runner == nullptr) return;
    if (runner->status().is_recording) {
        runner->stop_recording();
        return say("recording ended");
    }
    const auto file = unused_file("mkv");
    const auto started = runner->start_recording(file, SessionCodec::ffv1);
    say(started ? "recording into " + file.string() : started.error().to_string());
}

void ShowWindow::toggle_fullscreen() {
    GLFWwindow* window = window_.handle();
    if (windowed_) {
        glfwSetWindowMonitor(window, nullptr, windowed_->x, windowed_->y, windowed_->z,
                             windowed_->w, 0);
        windowed_.reset();
        return;
    }
    GLFWmonitor* monitor = glfwGetPrimaryMonitor();
    const GLFWvidmode* mode = monitor != nullptr ? glfwGetVideoMode(monitor) : nullptr;
    if (mode == nullptr) return;
    glm::ivec4 place(0);
    glfwGetWindowPos(window, &place.x, &place.y);
    glfwGetWindowSize(window, &place.z, &place.w);
    windowed_ = place;
    glfwSetWindowMonitor(window, monitor, 0, 0, mode->width, mode->height, mode->refreshRate);
}

void ShowWindow::act(ShowAction action) {
    switch (action) {
        case ShowAction::help:
            keys_ = !keys_;
            break;
        case ShowAction::pause:
            paused_ = !paused_;
            if (LiveRunner* runner = desk_->runner()) {
                paused_ ? runner->pause() : runner->resume();
            }
            break;
        case ShowAction::next_scene:
            play_->next_scene();
            break;
        case ShowAction::record:
            toggle_recording();
            break;
        case ShowAction::fullscreen:
            toggle_fullscreen();
            break;
        case ShowAction::stats:
            stats_ = !stats_;
            break;
        case ShowAction::screenshot:
            screenshot_ = true;
            break;
        case ShowAction::quit:
            window_.close();
            break;
    }
}

void ShowWindow::take(SourceDesk::Shown shown, TimeNs now) {
    mode_ = shown.mode;
    if (shown.cut) {
        play_->reset();
        feed_.reset();
        renderer_.cut();
        heard_.clear();
        fresh_.reset();
        paused_ = false;
        opened_ = now;
    }
    for (GestureEvent& event : shown.gestures) {
        heard_.push_back(std::move(event));
    }
    if (shown.fresh) {
        feed_.show(*shown.fresh);
        fresh_ = std::move(shown.fresh);
    }
}

/// While the curtain hides the stage, the next scene's pipelines are made by a small picture.
Result<void> ShowWindow::warm(const View& view) {
    warmed_ = false;
    const Scene* next = play_->scene_to_warm();
    if (next == nullptr) return {};
    FrameOptions options;
    View small =
        play_->view(std::max(16, view.width / kWarmPart), std::max(16, view.height / kWarmPart));
    small.id = 1;
    if (budget_.choice().lod > 1) options.lod = FramebufferLodOptions{.r = budget_.choice().lod};
    KINO_TRY(renderer_.render_to_image(*next, small, options));
    warmed_ = true;
    return {};
}

void ShowWindow::hear_play() {
    for (const DemoEvent& event : play_->take_events()) {
        if (options_.verbose) {
            fmt::print(stderr, "{:.2f} s: {} {}\n", to_seconds(event.time), event.what,
                       event.detail);
        }
    }
}

Result<void> ShowWindow::draw(TimeNs now) {
    const TimeNs began = now_ns();
    KINO_ASSIGN(const std::optional<PictureTarget> target, window_.begin_picture());
    if (!target) return {};
    const double dt_s =
        paused_ || last_step_ == 0 ? 0 : std::min(0.1, to_seconds(now - last_step_));
    last_step_ = now;
    play_->step(feed_.moment(dt_s, heard_, mode_ == ShowMode::lost));
    feed_.hear(heard_);
    heard_.clear();
    hear_play();
    scene_name_shown_s_ += dt_s;
    if (play_->scene_name() != scene_name_) {
        scene_name_ = play_->scene_name();
        scene_name_shown_s_ = 0;
    }
    const Scene& scene = play_->scene();
    const View view = play_->view(static_cast<int>(target->extent.width),
                                  static_cast<int>(target->extent.height));
    const glm::ivec2 size(view.width, view.height);
    const bool resized = std::exchange(size_, size) != size;
    FrameOptions options;
    (void)budget_.begin_frame(scene, view, options);
    painter_->prepare(screen(now), view, dt_s, options);
    if (std::exchange(screenshot_, false)) {
        auto drawn = renderer_.render_to_image(scene, view, options);
        const auto path = unused_file("png");
        const auto written = drawn ? write_png_rgba8(path, std::as_const(drawn->picture).view())
                                   : Result<void>(fail(drawn.error()));
        say(written ? "picture written: " + path.string() : written.error().to_string());
    }
    KINO_ASSIGN(const FrameResult drawn, renderer_.render(scene, view, *target, options));
    KINO_TRY(painter_->result());
    KINO_TRY(window_.present());
    const TimeNs presented = now_ns();
    budget_.frame_took(drawn, to_ms(presented - began), resized || warmed_ || pictures_ < 3);
    picture_times_.add(presented - began);
    ++pictures_;
    if (last_draw_ != 0) {
        const double rate = 1 / std::max(1e-3, to_seconds(now - last_draw_));
        pictures_per_s_ += (pictures_per_s_ == 0 ? 1 : 0.1) * (rate - pictures_per_s_);
    }
    last_draw_ = now;
    if (fresh_) {
        latencies_.add(latency_of(*fresh_, desk_->shows_device(), began, presented));
        if (first_picture_ == 0) first_picture_ = presented;
    }
    fresh_.reset();
    return warm(view);
}

Result<void> ShowWindow::run(TimeNs began) {
    KINO_TRY(open());
    opened_ = now_ns();
    TimeNs next_picture = opened_;
    while (!window_.should_close() && !help_.interrupted() &&
           (!options_.frames || pictures_ < *options_.frames)) {
        // A fresh frame does not end the waiting, so it is kept short.
        const WindowInput input =
            window_.poll(std::clamp<TimeNs>(next_picture - now_ns(), 0, kLookForFrame));
        for (const KeyPress& key : input.keys) {
            if (key.control || key.repeat) continue;
            if (const auto action = show_action_of(key.key)) act(*action);
        }
        const TimeNs now = now_ns();
        take(desk_->step(now), now);
        if (fresh_ || now >= next_picture) {
            KINO_TRY(draw(now));
            next_picture = now + (window_.minimised() ? kMinimised : kIdlePicture);
        }
    }
    if (first_picture_ != 0) first_picture_ -= began;
    desk_.reset();
    return {};
}

std::string ShowWindow::report() const {
    const auto target = static_cast<TimeNs>(options_.target_ms * static_cast<double>(kNsPerMs));
    const TimeSeries& times = picture_times_;
    if (options_.json) {
        return fmt::format(
            "{{\"pictures\": {}, \"ms_median\": {:.2f}, \"ms_p95\": {:.2f}, \"ms_p99\": {:.2f}, "
            "\"share_within_target\": {:.4f}, \"first_picture_ms\": {:.0f}, {}}}",
            times.count(), times.median_ms(), times.p95_ms(), times.quantile_ms(0.99),
            times.share_within(target), to_ms(first_picture_), latencies_.to_json_members());
    }
    return fmt::format(
        "{} pictures; ms each: median {:.1f}, 95 % {:.1f}, 99 % {:.1f}; share within {:.1f} ms "
        "{:.3f}; first after {:.0f} ms\n{}",
        times.count(), times.median_ms(), times.p95_ms(), times.quantile_ms(0.99),
        options_.target_ms, times.share_within(target), to_ms(first_picture_),
        latencies_.to_text());
}

}  // namespace kino
