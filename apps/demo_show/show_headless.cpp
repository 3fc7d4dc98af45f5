#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "apps/demo_show/play_feed.h"
#include "apps/demo_show/screen_painter.h"
#include "apps/demo_show/show_play.h"
#include "apps/demo_show/show_summary.h"
#include "apps/exit_codes.h"
#include "apps/headless/frame_feed.h"
#include "apps/headless/kept_pictures.h"
#include "apps/headless/run_report.h"
#include "apps/tell_error.h"
#include "sensor/png_io.h"

namespace kino {
namespace {

namespace fs = std::filesystem;

/// The demo without clocks and windows: every frame in order, one picture each.
class SteppedShow {
  public:
    SteppedShow(const ShowOptions& options, const ShowHelp& help, gpu::Device& device,
                ShowSummary& summary)
        : options_(options),
          help_(help),
          renderer_(device),
          summary_(summary),
          video_(options.headless) {}

    Result<void> open();
    Result<void> run(TimeNs began);

  private:
    Result<FrameResult> draw(const ProcessedFrame& frame, double dt_s);
    void note(const ProcessedFrame& frame);

    const ShowOptions& options_;
    const ShowHelp& help_;
    Renderer renderer_;
    ShowSummary& summary_;
    std::unique_ptr<ScreenPainter> painter_;
    std::optional<DemoPlay> play_;
    std::optional<FrameFeed> frames_;
    RunVideo video_;
    PlayFeed feed_;
    std::string scene_name_;
    double scene_name_shown_s_ = 1e9;
};

Result<void> SteppedShow::open() {
    KINO_ASSIGN(DemoPlay play, make_play(options_));
    play_.emplace(std::move(play));
    scene_name_ = play_->scene_name();
    const std::string uri = options_.uri.empty() ? performance_uri() : options_.uri;
    KINO_ASSIGN(OpenedSource opened,
                open_for_playing(uri, show_play_options(options_, LoopMode::loop)));
    summary_.source = opened.source->info();
    Stepper stepper(std::move(opened));
    const std::int64_t round = stepper.round() > 0 ? stepper.round() : kDeviceFrames;
    const auto note_unreadable = [this](const Error& unreadable) {
        ++summary_.errors;
        if (summary_.first_error.empty()) summary_.first_error = unreadable.to_string();
    };
    frames_.emplace(std::move(stepper), options_.frames.value_or(round),
                    FrameFeed::Hooks{help_.interrupted, note_unreadable});
    KINO_ASSIGN(painter_, ScreenPainter::create(renderer_.device(), nullptr, options_.height));
    return {};
}

Result<FrameResult> SteppedShow::draw(const ProcessedFrame& frame, double dt_s) {
    const TimeNs began = now_ns();
    feed_.show(frame);
    play_->step(feed_.moment(dt_s, frame.gestures, false));
    scene_name_shown_s_ += dt_s;
    if (play_->scene_name() != scene_name_) {
        scene_name_ = play_->scene_name();
        scene_name_shown_s_ = 0;
    }
    const Scene& scene = play_->scene();
    const View view = play_->view(options_.width, options_.height);
    summary_.most_lights = std::max(summary_.most_lights, play_->local_lights());
    summary_.most_meshes = std::max(summary_.most_meshes, scene.meshes.size());
    FrameOptions frame_options;
    frame_options.read_picture = true;
    if (options_.lod && *options_.lod > 1) {
        frame_options.lod = FramebufferLodOptions{.r = *options_.lod};
    }
    ShowScreen screen;
    feed_.hear(frame.gestures);
    feed_.guide(*play_, options_.mirror, screen);
    screen.scene_name = scene_name_;
    screen.scene_name_shown_s = scene_name_shown_s_;
    painter_->prepare(screen, view, dt_s, frame_options);
    summary_.play.add(now_ns() - began);
    const TimeNs drawing = now_ns();
    KINO_ASSIGN(FrameResult drawn, renderer_.render_to_image(scene, view, frame_options));
    KINO_TRY(painter_->result());
    summary_.render.add(now_ns() - drawing);
    return drawn;
}

/// Which gestures and events this picture is the first to show.
void SteppedShow::note(const ProcessedFrame& frame) {
    for (const GestureEvent& event : frame.gestures) {
        // Nothing is between the frame and its picture; what a reordering would cost shows here.
        const TimeNs delay = frame.set.time - event.time;
        summary_.gestures.push_back({frame.set.index, summary_.frames, delay, event});
    }
    for (DemoEvent& event : play_->take_events()) {
        if (options_.verbose) {
            fmt::print(stderr, "{:.2f} s: {} {}\n", to_seconds(event.time), event.what,
                       event.detail);
        }
        summary_.events.push_back({summary_.frames, std::move(event)});
    }
}

Result<void> SteppedShow::run(TimeNs began) {
    summary_.pictures_hash = kHashStart;
    while (true) {
        KINO_ASSIGN(const std::optional<ProcessedFrame> frame, frames_->next());
        if (!frame) break;
        if (!frame->surface) {
            return fail("brings no depth, so nobody can be seen in it", summary_.source.uri);
        }
        const TimeNs duration = std::max<TimeNs>(kNsPerMs, frames_->stepper().duration());
        KINO_ASSIGN(const FrameResult drawn, draw(*frame, to_seconds(duration)));
        if (summary_.first_picture == 0) summary_.first_picture = now_ns() - began;
        note(*frame);
        summary_.pictures_hash = hash_picture(drawn.picture, summary_.pictures_hash);
        KINO_TRY(video_.add(drawn.picture, duration));
        if (keeps_picture(frames_->index(), frames_->most(), options_.pictures)) {
            KINO_TRY(write_png_rgba8(options_.headless / picture_name(frames_->index()),
                                     drawn.picture.view()));
        }
        summary_.read.add(frame->times.read);
        summary_.track.add(frame->times.bodies);
        summary_.passes = drawn.report.passes;
        summary_.device_bytes = renderer_.device().memory().current;
        ++summary_.frames;
    }
    summary_.video_codec = video_.codec();
    return video_.finish();
}

}  // namespace

int show_headless(const ShowOptions& options, const ShowHelp& help) {
    const TimeNs began = now_ns();
    int code = kExitDone;
    const auto device = begin_run(options.headless,
                                  {.device = options.device, .validation = help.validation}, code);
    if (!device) return code;
    ShowSummary summary{.options = options};
    summary.device = device->info();
    {
        SteppedShow show(options, help, *device, summary);
        if (const auto opened = show.open(); !opened) {
            tell_error(opened.error());
            return kExitFailed;
        }
        if (const auto ran = show.run(began); !ran) {
            tell_error(ran.error());
            code = kExitFailed;
        }
    }
    summary.interrupted = help.interrupted();
    summary.wall_s = to_seconds(now_ns() - began);
    return end_run(options.headless, to_json(summary), to_text(summary), options.json, code);
}

}  // namespace kino
