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
#include "apps/headless/frame_feed.h"
#include "apps/headless/kept_pictures.h"
#include "apps/headless/run_report.h"
#include "apps/interrupt.h"
#include "apps/stage_source.h"
#include "apps/summary.h"
#include "apps/tell_error.h"
#include "apps/viewer/budget_log.h"
#include "apps/viewer/frame_budget.h"
#include "apps/viewer/scene_builder.h"
#include "apps/viewer/true_error.h"
#include "apps/viewer/window_camera.h"
#include "sensor/file_bytes.h"
#include "sensor/png_io.h"
#include "viz/frame/learning/light_learning.h"
#include "viz/frame/renderer.h"

namespace kino {
namespace {

namespace fs = std::filesystem;

constexpr int kDefaultWidth = 1280;
constexpr int kDefaultHeight = 720;
/// A short recording is shown this long, so that a video of it can be looked at.
constexpr TimeNs kLeastLength = 4 * kNsPerSecond;

constexpr std::int64_t kTrueErrorEvery = 30;
/// About as many of a source's pictures are learned from.
constexpr std::int64_t kLearningPoses = 8;

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
    if (timeline == nullptr) return kDeviceFrames;
    const std::int64_t round = std::max<std::int64_t>(1, stepper.round());
    if (stepper.opened().mode == LoopMode::once) return round;
    const TimeNs length =
        timeline->time_of(timeline->frame_count() - 1) + timeline->last_frame_duration();
    const TimeNs mean = std::max<TimeNs>(kNsPerMs, length / timeline->frame_count());
    return std::max(round, (kLeastLength + mean - 1) / mean);
}

class HeadlessRun {
  public:
    HeadlessRun(const ReplayOptions& options, gpu::Device& device, Summary& summary)
        : options_(options),
          renderer_(device),
          summary_(summary),
          quality_(options.quality(nullptr)),
          budget_(quality_.budget),
          chooser_({}),
          video_(options.headless) {}

    /// Fails where the scene of the options cannot be had.
    Result<void> set_stage();
    Result<void> play(const std::string& uri, const fs::path& folder);
    Result<void> finish();

  private:
    Result<FrameResult> draw(const ProcessedFrame& frame, const Stepper& stepper, double time_s);
    const ReplayOptions& options_;
    Renderer renderer_;
    Summary& summary_;
    SceneBuilder builder_;
    CameraControl camera_;
    std::optional<WindowCamera> window_;  ///< of scenes whose screen is one
    PictureQuality quality_;
    FrameBudget budget_;
    ZoomChooser chooser_;  ///< by the head's recorded motion; others depend on the clock
    double last_time_s_ = 0;
    RunVideo video_;
    LightLearning learning_;
    bool learns_now_ = false;
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
    frame_options.samples = static_cast<std::uint32_t>(quality_.samples);
    frame_options.part_rates = options_.part_rates;
    frame_options.regions = options_.regions;
    frame_options.read_picture = true;
    SourceSummary& source = summary_.sources.back();
    source.color = builder_.color_mode(draw);
    const Scene& scene = builder_.scene(draw);
    if (director != nullptr) source.stage = {director->local_lights(), scene.meshes.size()};
    if (learns_now_) KINO_TRY(learning_.add(renderer_, scene, view, frame_options));
    if (chooser_.on()) {
        const TimeNs now = from_seconds(time_s);
        const auto head_m_s = window_ ? std::optional(window_->head_m_s(now)) : std::nullopt;
        budget_.set_zoom(chooser_.begin_frame(scene, view, now, head_m_s, frame_options));
    }
    budget_.begin_frame(scene, view, frame_options);
    if (source.true_error && source.frames % kTrueErrorEvery == 0) {
        KINO_ASSIGN(const TrueError error,
                    measure_true_error(renderer_, scene, view, frame_options));
        source.true_error->add(error);
    }
    return renderer_.render_to_image(scene, view, frame_options);
}

Result<void> HeadlessRun::set_stage() {
    if (options_.scene.empty()) return {};
    KINO_ASSIGN(StageSet stage, open_stage(options_.scene));
    if (stage.file.camera.window && !options_.view) window_.emplace(*stage.file.camera.window);
    quality_ = options_.quality(&stage.file);
    // A window's `most_zoom` is for those who stand before it.
    const bool asks_head =
        options_.zoom_by == SceneZoomBy::head || stage.file.quality.zoom_by == SceneZoomBy::head;
    if (!asks_head && quality_.zoom.by == SceneZoomBy::head) quality_.zoom = {};
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
    std::error_code error;
    fs::create_directories(folder, error);
    if (error) return fail("could not be made: " + error.message(), folder.string());

    SourceSummary& source = summary_.sources.emplace_back();
    Stepper stepper(std::move(opened));
    source.info = stepper.opened().source->info();
    source.loop = stepper.opened().mode;
    source.pictures_hash = kHashStart;
    if (options_.true_error) source.true_error.emplace();
    // Each source is a run of its own. Levels must not depend on the clock.
    budget_ = FrameBudget(quality_.budget);
    if (quality_.budget.mode == GovernorMode::automatic) budget_.set_mode(GovernorMode::off);
    const bool by_head = quality_.zoom.by == SceneZoomBy::head;
    chooser_.set(by_head ? quality_.zoom : ZoomChooserOptions{});
    source.zoom_by = chooser_.options().by;
    if (!options_.lod_log.empty()) {
        KINO_ASSIGN(auto log, read_budget_log(options_.lod_log));
        budget_.replay(std::move(log));
    }
    builder_.reset();
    if (window_) window_->reset();
    last_time_s_ = 0;
    renderer_.cut();
    const auto note_unreadable = [&](const Error& unreadable) {
        ++source.errors;
        if (source.first_error.empty()) source.first_error = unreadable.to_string();
        if (options_.verbose) tell_error(unreadable);
    };
    const std::int64_t frames = options_.frames.value_or(natural_length(stepper));
    FrameFeed feed(std::move(stepper), frames,
                   {.interrupted = interrupted, .on_unreadable = note_unreadable});
    TimeNs shown = 0;
    while (true) {
        KINO_ASSIGN(const std::optional<ProcessedFrame> frame, feed.next());
        if (!frame) return {};
        if (!frame->surface) {
            return fail("brings no depth, so there is nothing to draw in 3D", uri,
                        "a window shows its pictures");
        }
        learns_now_ = !options_.learn.empty() &&
                      feed.index() % std::max<std::int64_t>(1, frames / kLearningPoses) == 0;
        const TimeNs began = now_ns();
        KINO_ASSIGN(const FrameResult drawn, draw(*frame, feed.stepper(), to_seconds(shown)));
        const TimeNs rendered = now_ns();
        const TimeNs duration = std::max<TimeNs>(
            kNsPerMs,
            static_cast<TimeNs>(static_cast<double>(feed.stepper().duration()) / options_.speed));
        KINO_TRY(video_.add(drawn.picture, duration));
        if (keeps_picture(feed.index(), frames, options_.pictures)) {
            KINO_TRY(write_png_rgba8(folder / picture_name(feed.index()), drawn.picture.view()));
        }
        const StageTimes& times = frame->times;
        source.read.add(times.read);
        source.color_conversion.add(times.color);
        source.registration.add(times.registration);
        source.filter.add(times.filter);
        if (feed.stepper().round() == 0) source.arrive.add(frame->arrived - frame->set.time);
        source.render.add(rendered - began);
        source.render_device.add(drawn.report.submit_to_fence);
        source.write.add(now_ns() - rendered);
        source.pictures_hash = hash_picture(drawn.picture, source.pictures_hash);
        source.passes = drawn.report.passes;
        source.device_bytes = renderer_.device().memory().current;
        source.points = frame->valid_points;
        source.bodies.add(*frame);
        source.levels = budget_.log();
        ++source.frames;
        shown += duration;
        if (options_.verbose) {
            fmt::print(stderr, "frame {} of {}: {} points, {:.1f} ms\n", feed.index() + 1, frames,
                       source.points, to_ms(rendered - began));
        }
    }
}

Result<void> HeadlessRun::finish() {
    if (!options_.learn.empty()) {
        const std::string table = light_table_to_json(learning_.table());
        KINO_TRY(write_file_bytes(options_.learn, table.data(), table.size()));
    }
    summary_.video_codec = video_.codec();
    return video_.finish();
}

}  // namespace

int replay_headless(const ReplayOptions& options) {
    // Asked for a window, got none: pictures instead of it would be a recording lost.
    if (!options.record.empty()) {
        tell_error({"not recorded: there is no window", options.record.string(),
                    "`kinoscope record URI --out FILE` records without one"});
        return kExitFailed;
    }
    int code = kExitDone;
    const auto device = begin_run(
        options.headless, {.device = options.device, .validation = wants_validation()}, code);
    if (!device) return code;
    const TimeNs began = now_ns();
    Summary summary{.device = device->info(),
                    .options = options,
                    .width = options.width.value_or(kDefaultWidth),
                    .height = options.height.value_or(kDefaultHeight)};
    const auto tell = [&code](const Result<void>& done) {
        if (done) return;
        tell_error(done.error());
        code = kExitFailed;
    };
    {
        HeadlessRun run(options, *device, summary);
        tell(run.set_stage());
        if (code != kExitDone) return code;
        for (std::size_t i = 0; i < options.uris.size() && !interrupted(); ++i) {
            const std::string& uri = options.uris[i];
            const fs::path folder = options.uris.size() == 1
                                        ? options.headless
                                        : options.headless / fmt::format("{}-{}", i + 1, slug(uri));
            tell(run.play(uri, folder));
        }
        tell(run.finish());
    }
    summary.interrupted = interrupted();
    summary.wall_s = to_seconds(now_ns() - began);
    // With nothing opened there is nothing to tell.
    if (summary.sources.empty() && code != kExitDone) return code;
    return end_run(options.headless, to_json(summary), to_text(summary), options.json, code);
}

}  // namespace kino
