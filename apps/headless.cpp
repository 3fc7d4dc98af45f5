#include "apps/headless.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

#include "apps/exit_codes.h"
#include "apps/interrupt.h"
#include "apps/pipeline/stepper.h"
#include "apps/stage_source.h"
#include "apps/summary.h"
#include "apps/viewer/budget_log.h"
#include "apps/viewer/frame_budget.h"
#include "apps/viewer/scene_builder.h"
#include "apps/viewer/true_error.h"
#include "apps/viewer/window_camera.h"
#include "sensor/png_io.h"
#include "viz/frame/renderer.h"
#include "viz/output/video_writer.h"

namespace kino {
namespace {

namespace fs = std::filesystem;

constexpr int kDefaultWidth = 1280;
constexpr int kDefaultHeight = 720;
/// A short recording is shown this long, so that a video of it can be looked at.
constexpr TimeNs kLeastLength = 4 * kNsPerSecond;

constexpr std::int64_t kTrueErrorEvery = 30;

/// A stepper waits a second for a device; this often at most.
constexpr int kDeviceWaits = 10;

/// A name of a folder for a source: what a person would call it, without odd characters.
std::string slug(const std::string& uri) {
    std::string name = fs::path(uri).filename().string();
    if (name.empty()) name = uri;
    for (char& c : name) {
        if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '-';
    }
    while (!name.empty() && name.back() == '-') name.pop_back();
    return name;
}

std::int64_t natural_length(const Stepper& stepper) {
    const Timeline* timeline = stepper.opened().source->timeline();
    if (timeline == nullptr) return 300;
    const std::int64_t round = std::max<std::int64_t>(1, stepper.round());
    if (stepper.opened().mode == LoopMode::once) return round;
    const TimeNs length =
        timeline->time_of(timeline->frame_count() - 1) + timeline->last_frame_duration();
    const TimeNs mean = std::max<TimeNs>(kNsPerMs, length / timeline->frame_count());
    return std::max(round, (kLeastLength + mean - 1) / mean);
}

/// Whether picture `i` of `frames` is kept as a file: first and last, the others evenly between,
/// `most` in all; all of them for a negative `most`.
bool keeps_picture(std::int64_t i, std::int64_t frames, std::int64_t most) {
    if (most < 0 || frames <= most) return true;
    if (most < 2) return most == 1 && i == 0;
    // Small enough that the products below fit.
    most = std::min<std::int64_t>(most, 1'000'000);
    const std::int64_t k = (i * (most - 1) + frames - 2) / (frames - 1);
    return k * (frames - 1) / (most - 1) == i;
}

class HeadlessRun {
  public:
    HeadlessRun(const ReplayOptions& options, gpu::Device& device, Summary& summary)
        : options_(options), renderer_(device), summary_(summary), budget_(options.budget()) {}

    /// Fails where the scene of the options cannot be had.
    Result<void> set_stage();
    Result<void> play(const std::string& uri, const fs::path& folder);
    Result<void> finish();

  private:
    Result<FrameResult> draw(const ProcessedFrame& frame, const Stepper& stepper, double time_s);
    Result<void> keep(const Image<Rgba8>& picture, TimeNs duration, const fs::path& png);

    const ReplayOptions& options_;
    Renderer renderer_;
    Summary& summary_;
    SceneBuilder builder_;
    CameraControl camera_;
    std::optional<WindowCamera> window_;  ///< of scenes whose screen is one
    FrameBudget budget_;
    double last_time_s_ = 0;
    std::optional<VideoWriter> video_;
    bool video_tried_ = false;
};

Result<FrameResult> HeadlessRun::draw(const ProcessedFrame& frame, const Stepper& stepper,
                                      double time_s) {
    const bool first = !builder_.place();
    builder_.show(frame);
    const bool moved = builder_.advance(time_s - std::exchange(last_time_s_, time_s));
    if (first || moved) {
        camera_ = CameraControl{};
        camera_.kind = options_.view.value_or(ViewKind::orbit);
        camera_.reset(*builder_.place());
    }
    const Director* director = builder_.director();
    const SceneLive live = director != nullptr ? director->file().live : SceneLive{.splat_px = 1};
    const DrawOptions draw{.style = options_.style.value_or(live.style),
                           .splat_px = options_.splat_px.value_or(live.splat_px),
                           .color = options_.color};
    if (director == nullptr && frame.set.pose_origin == PoseOrigin::trajectory) {
        camera_.orbit.follow(measure_place(frame).center, to_seconds(stepper.duration()));
    }
    camera_.orbit.set_time(time_s);
    View view = camera_.view(stepper.opened().processor.rig().parameters().depth,
                             frame.set.world_from_depth, summary_.width, summary_.height);
    if (window_ && director->world_from_stage()) {
        // Recorded time: pictures are of the moment their frame was taken.
        window_->see(from_seconds(time_s), frame.set.bodies.get());
        view = window_->view(*director->world_from_stage(), from_seconds(time_s), summary_.width,
                             summary_.height);
    }
    FrameOptions frame_options;
    frame_options.raster = options_.raster;
    frame_options.samples = static_cast<std::uint32_t>(options_.samples);
    frame_options.read_picture = true;
    SourceSummary& source = summary_.sources.back();
    source.color = builder_.color_mode(draw);
    const Scene& scene = builder_.scene(draw);
    if (director != nullptr) source.stage = {director->local_lights(), scene.meshes.size()};
    budget_.begin_frame(scene, view, frame_options);
    if (source.true_error && source.frames % kTrueErrorEvery == 0) {
        KINO_ASSIGN(const TrueError error,
                    measure_true_error(renderer_, scene, view, frame_options));
        source.true_error->add(error);
    }
    return renderer_.render_to_image(scene, view, frame_options);
}

Result<void> HeadlessRun::keep(const Image<Rgba8>& picture, TimeNs duration, const fs::path& png) {
    if (!std::exchange(video_tried_, true)) {
        auto video =
            VideoWriter::create(options_.headless / "video.mp4", summary_.width, summary_.height);
        if (video) {
            video_.emplace(std::move(*video));
            summary_.video_codec = video_->codec();
        } else {
            // Pictures are worth having without a video.
            fmt::print(stderr, "kinoscope: no video: {}\n", video.error().to_string());
        }
    }
    if (video_) KINO_TRY(video_->add(picture.view(), duration));
    if (!png.empty()) KINO_TRY(write_png_rgba8(png, picture.view()));
    return {};
}

Result<void> HeadlessRun::set_stage() {
    if (options_.scene.empty()) return {};
    KINO_ASSIGN(StageSet stage, open_stage(options_.scene));
    if (stage.file.camera.window && !options_.view) window_.emplace(*stage.file.camera.window);
    builder_.put_on_stage(std::make_unique<Director>(std::move(stage)));
    return {};
}

Result<void> HeadlessRun::play(const std::string& uri, const fs::path& folder) {
    KINO_ASSIGN(OpenedSource opened, open_with_people(uri,
                                                      {.mode = options_.loop,
                                                       .filters = options_.filters,
                                                       .bodies = options_.bodies,
                                                       .calibration = options_.calibration},
                                                      options_.wants_people()));
    Stepper stepper(std::move(opened));
    const std::int64_t frames = options_.frames.value_or(natural_length(stepper));
    std::error_code error;
    fs::create_directories(folder, error);
    if (error) return fail("could not be made: " + error.message(), folder.string());

    SourceSummary& source = summary_.sources.emplace_back();
    source.info = stepper.opened().source->info();
    source.loop = stepper.opened().mode;
    source.pictures_hash = kHashStart;
    if (options_.true_error) source.true_error.emplace();
    // Each source is a run of its own. Levels must not depend on the clock.
    budget_ = FrameBudget(options_.budget());
    if (options_.lod_auto) budget_.set_mode(GovernorMode::off);
    if (!options_.lod_log.empty()) {
        KINO_ASSIGN(auto log, read_budget_log(options_.lod_log));
        budget_.replay(std::move(log));
    }
    builder_.reset();
    if (window_) window_->reset();
    last_time_s_ = 0;
    renderer_.cut();
    TimeNs shown = 0;
    std::int64_t in_a_row = 0;
    int silent_waits = 0;
    for (std::int64_t i = 0; i < frames && !interrupted(); ++i) {
        auto frame = stepper.next();
        if (!frame) {
            ++source.errors;
            if (source.first_error.empty()) source.first_error = frame.error().to_string();
            if (options_.verbose) {
                fmt::print(stderr, "kinoscope: {}\n", frame.error().to_string());
            }
            // With every frame of a round unreadable, there is nothing to show.
            if (++in_a_row >= std::max<std::int64_t>(1, stepper.round()))
                return fail(frame.error(), uri);
            continue;
        }
        if (!*frame) {
            if (stepper.round() > 0) break;
            // A device: it may be slow to start, or away for a while.
            if (++silent_waits >= kDeviceWaits) {
                return fail(fmt::format("nothing came for {} s", kDeviceWaits), uri);
            }
            --i;
            continue;
        }
        silent_waits = 0;
        if (!(*frame)->surface) {
            return fail("brings no depth, so there is nothing to draw in 3D", uri,
                        "a window shows its pictures");
        }
        in_a_row = 0;
        const TimeNs began = now_ns();
        KINO_ASSIGN(FrameResult drawn, draw(**frame, stepper, to_seconds(shown)));
        const TimeNs rendered = now_ns();
        const TimeNs duration = std::max<TimeNs>(
            kNsPerMs,
            static_cast<TimeNs>(static_cast<double>(stepper.duration()) / options_.speed));
        fs::path png;
        if (keeps_picture(i, frames, options_.pictures))
            png = folder / fmt::format("frame-{:05}.png", i);
        KINO_TRY(keep(drawn.picture, duration, png));
        const StageTimes& times = (*frame)->times;
        source.read.add(times.read);
        source.color_conversion.add(times.color);
        source.registration.add(times.registration);
        source.filter.add(times.filter);
        if (stepper.round() == 0) source.arrive.add((*frame)->arrived - (*frame)->set.time);
        source.render.add(rendered - began);
        source.render_device.add(drawn.report.submit_to_fence);
        source.write.add(now_ns() - rendered);
        source.pictures_hash = hash_picture(drawn.picture, source.pictures_hash);
        source.passes = drawn.report.passes;
        source.device_bytes = renderer_.device().memory().current;
        source.points = (*frame)->valid_points;
        source.bodies.add(**frame);
        source.levels = budget_.log();
        ++source.frames;
        shown += duration;
        if (options_.verbose) {
            fmt::print(stderr, "frame {} of {}: {} points, {:.1f} ms\n", i + 1, frames,
                       source.points, to_ms(rendered - began));
        }
    }
    return {};
}

Result<void> HeadlessRun::finish() {
    if (video_) return video_->finish();
    return {};
}

}  // namespace

int replay_headless(const ReplayOptions& options) {
    const auto complain = [](const Error& error) {
        fmt::print(stderr, "kinoscope: {}\n", error.to_string());
    };
    std::error_code error;
    fs::create_directories(options.headless, error);
    if (error) {
        complain({"could not be made: " + error.message(), options.headless.string(), {}});
        return kExitFailed;
    }
    auto device = gpu::Device::create({.device = options.device, .validation = wants_validation()});
    if (!device) {
        complain(device.error());
        return kExitNoVulkan;
    }
    const TimeNs began = now_ns();
    Summary summary{.device = (*device)->info(),
                    .options = options,
                    .width = options.width.value_or(kDefaultWidth),
                    .height = options.height.value_or(kDefaultHeight)};
    int code = kExitDone;
    {
        HeadlessRun run(options, **device, summary);
        if (const auto set = run.set_stage(); !set) {
            complain(set.error());
            return kExitFailed;
        }
        for (std::size_t i = 0; i < options.uris.size() && !interrupted(); ++i) {
            const std::string& uri = options.uris[i];
            const fs::path folder = options.uris.size() == 1
                                        ? options.headless
                                        : options.headless / fmt::format("{}-{}", i + 1, slug(uri));
            if (const auto played = run.play(uri, folder); !played) {
                complain(played.error());
                code = kExitFailed;
            }
        }
        if (const auto finished = run.finish(); !finished) {
            complain(finished.error());
            code = kExitFailed;
        }
    }
    summary.interrupted = interrupted();
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
