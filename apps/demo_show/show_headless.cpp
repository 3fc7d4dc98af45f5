#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>

#include "apps/demo_show/play_feed.h"
#include "apps/demo_show/screen_painter.h"
#include "apps/demo_show/show_play.h"
#include "apps/demo_show/show_summary.h"
#include "apps/exit_codes.h"
#include "apps/pipeline/stepper.h"
#include "sensor/png_io.h"
#include "viz/output/video_writer.h"

namespace kino {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kDeviceFrames = 300;
/// A stepper waits a second for a device; this often at most.
constexpr int kSilentWaits = 10;

/// FNV-1a, 64 bit (Fowler, Noll, Vo).
constexpr std::uint64_t kFnvStart = 0xcbf29ce484222325ull, kFnvPrime = 0x100000001b3ull;

std::uint64_t hashed(const Image<Rgba8>& picture, std::uint64_t hash) {
    for (const Rgba8& p : picture.pixels()) {
        for (const std::uint8_t byte : {p.r, p.g, p.b, p.a}) hash = (hash ^ byte) * kFnvPrime;
    }
    return hash;
}

/// Evenly over all frames, first and last among them; all for a negative `most`.
bool is_kept(std::int64_t i, std::int64_t frames, std::int64_t most) {
    if (most < 0 || frames <= most) return true;
    if (most < 2) return most == 1 && i == 0;
    most = std::min<std::int64_t>(most, 1'000'000);
    const std::int64_t k = (i * (most - 1) + frames - 2) / (frames - 1);
    return k * (frames - 1) / (most - 1) == i;
}

/// The demo without clocks and windows: every frame in order, one picture each.
class SteppedShow {
  public:
    SteppedShow(const ShowOptions& options, const ShowHelp& help, gpu::Device& device,
                ShowSummary& summary)
        : options_(options), help_(help), renderer_(device), summary_(summary) {}

    Result<void> open();
    Result<void> run(TimeNs began);

  private:
    Result<FrameResult> draw(const ProcessedFrame& frame, double dt_s);
    Result<void> keep(const Image<Rgba8>& picture, TimeNs duration, std::int64_t index);
    void note(const ProcessedFrame& frame);

    const ShowOptions& options_;
    const ShowHelp& help_;
    Renderer renderer_;
    ShowSummary& summary_;
    std::unique_ptr<ScreenPainter> painter_;
    std::optional<DemoPlay> play_;
    std::optional<Stepper> stepper_;
    std::optional<VideoWriter> video_;
    PlayFeed feed_;
    std::string scene_name_;
    double scene_name_shown_s_ = 1e9;
    std::int64_t frames_ = 0;  ///< that are to be drawn
};

Result<void> SteppedShow::open() {
    KINO_ASSIGN(DemoPlay play, make_play(options_));
    play_.emplace(std::move(play));
    scene_name_ = play_->scene_name();
    const std::string uri = options_.uri.empty() ? performance_uri() : options_.uri;
    KINO_ASSIGN(OpenedSource opened,
                open_for_playing(uri, show_play_options(options_, LoopMode::loop)));
    stepper_.emplace(std::move(opened));
    summary_.source = stepper_->opened().source->info();
    frames_ = options_.frames.value_or(stepper_->round() > 0 ? stepper_->round() : kDeviceFrames);
    KINO_ASSIGN(painter_, ScreenPainter::create(renderer_.device(), nullptr, options_.height));
    auto video =
        VideoWriter::create(options_.headless / "video.mp4", options_.width, options_.height);
    if (video) {
        video_.emplace(std::move(*video));
        summary_.video_codec = video_->codec();
    } else {
        // Pictures are worth having without a video.
        fmt::print(stderr, "kinoscope: no video: {}\n", video.error().to_string());
    }
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

Result<void> SteppedShow::keep(const Image<Rgba8>& picture, TimeNs duration, std::int64_t index) {
    summary_.pictures_hash = hashed(picture, summary_.pictures_hash);
    if (video_) KINO_TRY(video_->add(picture.view(), duration));
    if (!is_kept(index, frames_, options_.pictures)) return {};
    return write_png_rgba8(options_.headless / fmt::format("frame-{:05}.png", index),
                           picture.view());
}

Result<void> SteppedShow::run(TimeNs began) {
    summary_.pictures_hash = kFnvStart;
    int silent = 0;
    std::int64_t unreadable = 0;
    for (std::int64_t i = 0; i < frames_ && !help_.interrupted(); ++i) {
        auto frame = stepper_->next();
        if (!frame) {
            ++summary_.errors;
            if (summary_.first_error.empty()) summary_.first_error = frame.error().to_string();
            if (++unreadable >= std::max<std::int64_t>(1, stepper_->round()))
                return fail(frame.error());
            continue;
        }
        if (!*frame) {
            if (stepper_->round() > 0) break;
            if (++silent >= kSilentWaits) {
                return fail(fmt::format("nothing came for {} s", kSilentWaits),
                            summary_.source.uri);
            }
            --i;
            continue;
        }
        silent = 0;
        unreadable = 0;
        if (!(*frame)->surface) {
            return fail("brings no depth, so nobody can be seen in it", summary_.source.uri);
        }
        const TimeNs duration = std::max<TimeNs>(kNsPerMs, stepper_->duration());
        KINO_ASSIGN(const FrameResult drawn, draw(**frame, to_seconds(duration)));
        if (summary_.first_picture == 0) summary_.first_picture = now_ns() - began;
        note(**frame);
        KINO_TRY(keep(drawn.picture, duration, i));
        summary_.read.add((*frame)->times.read);
        summary_.track.add((*frame)->times.bodies);
        summary_.passes = drawn.report.passes;
        summary_.device_bytes = renderer_.device().memory().current;
        ++summary_.frames;
    }
    if (video_) KINO_TRY(video_->finish());
    return {};
}

}  // namespace

int show_headless(const ShowOptions& options, const ShowHelp& help) {
    const TimeNs began = now_ns();
    const auto complain = [](const Error& error) {
        fmt::print(stderr, "kinoscope: {}\n", error.to_string());
    };
    std::error_code error;
    fs::create_directories(options.headless, error);
    if (error) {
        complain({"could not be made: " + error.message(), options.headless.string(), {}});
        return kExitFailed;
    }
    auto device = gpu::Device::create({.device = options.device, .validation = help.validation});
    if (!device) {
        complain(device.error());
        return kExitNoVulkan;
    }
    ShowSummary summary{.options = options};
    summary.device = (*device)->info();
    int code = kExitDone;
    {
        SteppedShow show(options, help, **device, summary);
        if (const auto opened = show.open(); !opened) {
            complain(opened.error());
            return kExitFailed;
        }
        if (const auto ran = show.run(began); !ran) {
            complain(ran.error());
            code = kExitFailed;
        }
    }
    summary.interrupted = help.interrupted();
    summary.wall_s = to_seconds(now_ns() - began);
    if (const auto written = write_summary(options.headless / "summary.json", summary); !written) {
        complain(written.error());
        code = kExitFailed;
    }
    if (options.json) {
        fmt::print("{}\n", to_json(summary).dump(2, ' ', false,
                                                 nlohmann::ordered_json::error_handler_t::replace));
    } else {
        fmt::print("{}written into {}\n", to_text(summary), options.headless.string());
    }
    return code;
}

}  // namespace kino
