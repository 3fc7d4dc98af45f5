#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "apps/calibration_option.h"
#include "apps/checked_words.h"
#include "apps/commands.h"
#include "apps/exit_codes.h"
#include "apps/interrupt.h"
#include "apps/pipeline/found_calibration.h"
#include "apps/pipeline/opened_source.h"
#include "apps/sources.h"
#include "apps/tell_error.h"
#include "apps/view_options.h"
#include "sensor/session/recorder.h"
#include "skeleton/gestures/gesture_json.h"

namespace kino {
namespace {

constexpr TimeNs kWait = 50 * kNsPerMs;
constexpr TimeNs kTellEvery = kNsPerSecond;
/// A device that brings nothing for so long is told about.
constexpr TimeNs kPatience = 5 * kNsPerSecond;

struct RecordOptions {
    std::string uri;
    std::filesystem::path out;
    std::optional<double> seconds;
    std::optional<std::int64_t> frames;
    SessionCodec codec = SessionCodec::ffv1;
    BodyOptions bodies;
    std::string calibration;
    bool json = false;
};

struct Recorded {
    RecorderStatus status;
    std::set<std::uint32_t> people;
    std::int64_t gestures = 0;
};

void tell(const RecorderStatus& status, const char* end) {
    fmt::print(stderr, "\r{:.1f} s, {} frames, {:.1f} MB, {} lost, queue {:.0f} %{}",
               to_seconds(status.duration), status.frames, static_cast<double>(status.bytes) / 1e6,
               status.dropped, 100 * status.queue_fill, end);
}

/// Whether the device's own clock decides when frames come; a recording is read as fast as it can
/// be written.
bool comes_by_itself(Source& source) {
    return source.timeline() == nullptr;
}

/// Bodies and gestures of each set, found beside the recording.
class BodyDesk {
  public:
    /// Null where bodies are off.
    static Result<std::unique_ptr<BodyDesk>> create(const BodyOptions& options, RigParameters rig) {
        if (options.mode == BodyMode::off) return nullptr;
        rig.color.reset();
        KINO_ASSIGN(Processor processor, Processor::create(rig));
        KINO_ASSIGN(auto stage, BodyStage::create(options, processor.rig()));
        return std::unique_ptr<BodyDesk>(new BodyDesk(std::move(processor), std::move(stage)));
    }

    Result<ProcessedFrame> find(const FrameSet& set) {
        FrameSet depth_only = set;
        depth_only.color.reset();
        KINO_ASSIGN(ProcessedFrame frame, processor_.process(std::move(depth_only)));
        stage_->process(frame);
        return frame;
    }

  private:
    BodyDesk(Processor processor, std::unique_ptr<BodyStage> stage)
        : processor_(std::move(processor)), stage_(std::move(stage)) {}
    Processor processor_;
    std::unique_ptr<BodyStage> stage_;
};

class RecordRun {
  public:
    RecordRun(const RecordOptions& options, Source& source, Recorder& recorder, BodyDesk* desk,
              Recorded& out)
        : options_(options), source_(source), recorder_(recorder), desk_(desk), out_(out) {}

    Result<void> run() {
        const bool tapped = source_.set_tap(
            [this](StreamId id, const StreamFrame& frame) { recorder_.put(id, frame); });
        const TimeNs began = now_ns();
        TimeNs told = began;
        TimeNs last_set = began;
        while (!interrupted() && !over(began) && recorder_.status().error.empty()) {
            auto set = source_.next(kWait);
            for (const Event& event : source_.take_events()) hear(event);
            if (!set) {
                tell_error(set.error());
            } else if (*set) {
                ++sets_;
                last_time_ = (*set)->time;
                if (first_time_ == 0) first_time_ = last_time_;
                last_set = now_ns();
                if (!tapped) put(**set);
                if (desk_ != nullptr) find_bodies(**set, tapped);
            } else if (ended_) {
                break;
            } else if (present_ && now_ns() - last_set > kPatience) {
                fmt::print(stderr, "\nkinoscope: nothing has come for {:.0f} s\n",
                           to_seconds(kPatience));
                last_set = now_ns();
            }
            if (now_ns() - told >= kTellEvery) {
                told = now_ns();
                tell(recorder_.status(), "");
            }
        }
        if (tapped) (void)source_.set_tap({});
        return {};
    }

  private:
    bool over(TimeNs began) const {
        if (options_.frames && sets_ >= *options_.frames) return true;
        if (!options_.seconds) return false;
        const TimeNs limit = from_seconds(*options_.seconds);
        const TimeNs passed =
            comes_by_itself(source_) ? now_ns() - began : last_time_ - first_time_;
        return passed >= limit;
    }

    /// A recording waits for the disk: nothing is lost by it.
    void put(const FrameSet& set) {
        constexpr double kFull = 0.5;
        while (!comes_by_itself(source_) && recorder_.status().queue_fill > kFull &&
               recorder_.status().error.empty() && !interrupted()) {
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
        if (desk_ == nullptr) return recorder_.put(set);
        // Those that are found go into the file instead.
        FrameSet pictures = set;
        pictures.bodies.reset();
        recorder_.put(pictures);
    }

    void find_bodies(const FrameSet& set, bool tapped) {
        if (!set.depth) return;
        const auto frame = desk_->find(set);
        if (!frame) return tell_error(frame.error());
        // Sets are put as of device 0.
        const std::vector<StreamInfo>& streams = source_.info().streams;
        const int device = tapped && !streams.empty() ? streams.front().id.device : 0;
        recorder_.put({device, StreamKind::bodies}, frame->set.bodies);
        for (const Body& body : frame->set.bodies->bodies) out_.people.insert(body.id);
        for (const GestureEvent& gesture : frame->gestures) {
            ++out_.gestures;
            recorder_.put_event(event_of(gesture));
            if (gesture.phase == GesturePhase::change) continue;
            fmt::print(stderr, "\r{:.2f} s: {}\n", to_seconds(gesture.time - first_time_),
                       gesture_text(gesture));
        }
    }

    void hear(const Event& event) {
        // Gestures of a recording make room for those that are found.
        if (event.kind != EventKind::gesture || desk_ == nullptr) recorder_.put_event(event);
        if (event.kind == EventKind::ended) ended_ = true;
        if (event.kind == EventKind::lost) present_ = false;
        if (event.kind == EventKind::back) present_ = true;
        if (event.kind == EventKind::lost || event.kind == EventKind::back) {
            fmt::print(stderr, "\n{}\n", event.text);
        }
    }

    const RecordOptions& options_;
    Source& source_;
    Recorder& recorder_;
    BodyDesk* desk_;
    Recorded& out_;
    std::int64_t sets_ = 0;
    TimeNs first_time_ = 0;
    TimeNs last_time_ = 0;
    bool ended_ = false;
    bool present_ = true;
};

Result<Recorded> record(const RecordOptions& options) {
    std::string uri = options.uri;
    if (uri.empty()) {
        KINO_ASSIGN(uri, first_device());
    }
    KINO_ASSIGN(const auto source, open_source(uri));
    KINO_ASSIGN(std::vector<StreamId> streams, subscribe_what_goes(*source));
    std::erase_if(streams, [](StreamId id) {
        return id.kind == StreamKind::bodies || id.kind == StreamKind::motion;
    });
    KINO_ASSIGN(const FoundCalibration calibration, find_calibration(*source, options.calibration));
    tell_of(calibration);
    const RigParameters& rig = calibration.rig;
    KINO_ASSIGN(const auto desk, BodyDesk::create(options.bodies, rig));
    KINO_ASSIGN(const auto recorder,
                Recorder::create(options.out, source->info(), rig,
                                 {.codec = options.codec, .streams = streams}));
    Recorded out;
    KINO_TRY(RecordRun(options, *source, *recorder, desk.get(), out).run());
    KINO_ASSIGN(out.status, recorder->close());
    return out;
}

int run_record(const RecordOptions& options) {
    register_sources();
    catch_interrupts();
    const auto recorded = record(options);
    if (!recorded) {
        tell_error(recorded.error());
        return kExitFailed;
    }
    const RecorderStatus* const status = &recorded->status;
    tell(*status, "\n");
    if (options.json) {
        const nlohmann::ordered_json out = {{"file", options.out.string()},
                                            {"frames", status->frames},
                                            {"lost", status->dropped},
                                            {"bytes", status->bytes},
                                            {"seconds", to_seconds(status->duration)},
                                            {"people", recorded->people},
                                            {"gestures", recorded->gestures},
                                            {"error", status->error}};
        fmt::print("{}\n",
                   out.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
    }
    if (!status->error.empty()) {
        tell_error({status->error, options.out.string(), "what was written before is in the file"});
        return kExitFailed;
    }
    return kExitDone;
}

}  // namespace

Command add_record(CLI::App& parent) {
    auto options = std::make_shared<RecordOptions>();
    CLI::App& app =
        *parent.add_subcommand("record", "writes a session file, without a window, until Ctrl-C");
    app.add_option("URI", options->uri,
                   "a device (the first there is by default), a recording or synthetic:");
    app.add_option("--out", options->out, "the session, a new .mkv file")
        ->required()
        ->type_name("FILE");
    app.add_option("--seconds", options->seconds, "end after so long")
        ->check([](const std::string& word) { return check_number(word, 0.001, 1e9); })
        ->type_name("N");
    app.add_option("--frames", options->frames, "end after so many depth frames")
        ->check(CLI::Range(std::int64_t{1}, std::int64_t{1} << 40))
        ->type_name("N");
    add_codec_option(app, options->codec);
    add_body_options(app, options->bodies);
    add_calibration_option(app, options->calibration);
    app.add_flag("--json", options->json, "print the outcome as JSON");
    app.footer(
        "Sessions are Matroska files (docs/session-format.md). Whatever happens to the "
        "machine, what was\nwritten up to half a second before stays readable; "
        "`kinoscope repair` makes it quick to open.");
    return [options] { return run_record(*options); };
}

}  // namespace kino
