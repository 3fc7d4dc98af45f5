#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>

#include "apps/checked_words.h"
#include "apps/commands.h"
#include "apps/exit_codes.h"
#include "apps/interrupt.h"
#include "apps/motion.h"
#include "apps/pipeline/opened_source.h"
#include "apps/sources.h"
#include "apps/tell_error.h"
#include "apps/view_options.h"
#include "calibration/color_in_depth.h"
#include "calibration/rig.h"
#include "sensor/color_conversion.h"
#include "sensor/convert/convert.h"
#include "sensor/convert/sinks.h"
#include "sensor/session/session_index.h"

namespace kino {
namespace {

namespace fs = std::filesystem;

struct ConvertOptions {
    std::string in;
    fs::path out;
    std::string to;
    SessionCodec codec = SessionCodec::ffv1;
    std::int64_t from = 0;
    std::optional<std::int64_t> count;
    std::optional<double> scale;
    MotionRequest motion;
    bool force = false;
    bool json = false;
};

/// Depth in metres and points in the world, by the Rig.
class RigGeometry final : public ConvertGeometry {
  public:
    explicit RigGeometry(Rig rig) : rig_(std::move(rig)) {}

    Result<void> metres(const DepthFrame& frame, Image<float>& out) override {
        KINO_TRY(rig_.register_depth(frame, registered_));
        std::swap(out, registered_.depth_m);
        return {};
    }

    Result<void> points(const FrameSet& set, std::vector<CloudPoint>& out) override {
        KINO_TRY(rig_.register_depth(*set.depth, registered_));
        const bool colored = set.color && rig_.parameters().color;
        if (colored) {
            KINO_TRY(to_rgba8(*set.color, color_));
            register_color(registered_.uv, color_, ColorSampling::bilinear, color_in_depth_);
        }
        out.clear();
        const Image<RayXy>& rays = rig_.depth_rays();
        for (std::size_t i = 0; i < rays.size(); ++i) {
            const double z = registered_.depth_m.data()[i];
            const RayXy ray = rays.data()[i];
            if (!(z > 0) || !std::isfinite(ray.x) || !std::isfinite(ray.y)) continue;
            const glm::dvec3 p = set.world_from_depth * glm::dvec3(ray.x * z, ray.y * z, z);
            constexpr Rgba8 kUnknown{150, 150, 150, 255};
            const Rgba8 seen = colored ? color_in_depth_.data()[i] : Rgba8{0, 0, 0, 0};
            out.push_back({static_cast<float>(p.x), static_cast<float>(p.y),
                           static_cast<float>(p.z), seen.a == 0 ? kUnknown : seen});
        }
        return {};
    }

  private:
    Rig rig_;
    RegisteredDepth registered_;
    Image<Rgba8> color_;
    Image<Rgba8> color_in_depth_;
};

/// What --to would be for a file of this name; empty where a name says nothing.
std::string kind_of(const fs::path& out) {
    const std::string extension = out.extension().string();
    if (extension == ".mkv") return "session";
    if (extension == ".oni") return "oni";
    if (extension == ".ply") return "ply";
    return {};
}

Result<std::unique_ptr<FrameSink>> make_sink(const std::string& kind, const fs::path& out,
                                             const ConvertInput& input,
                                             const SinkOptions& options) {
    if (kind == "session") return make_session_sink(out, input, options);
    if (kind == "oni") return make_oni_sink(out, input, options);
    if (kind == "ply") return make_ply_sink(out, input, options);
    if (kind == "png") return make_png_sink(out, input, options);
    if (kind == "k4a") return make_k4a_sink(out, input, options);
    return make_tum_sink(out, input, options);
}

/// The same recording frame by frame, if it is a session.
Result<std::unique_ptr<SessionReader>> session_of(const std::string& uri) {
    const auto bytes = open_byte_source(uri);
    if (!bytes || !looks_like_session(**bytes)) return nullptr;
    return SessionReader::open(uri);
}

class Progress {
  public:
    explicit Progress(bool quiet) : quiet_(quiet) {}
    void tell(std::int64_t done, std::int64_t total) {
        const TimeNs now = now_ns();
        if (quiet_ || now - told_ < kNsPerSecond / 2) return;
        told_ = now;
        shown_ = true;
        fmt::print(stderr, "\r{} of {} frames", done, total);
    }
    void end() const {
        if (shown_) fmt::print(stderr, "\n");
    }

  private:
    bool quiet_;
    bool shown_ = false;
    TimeNs told_ = now_ns();
};

struct Outcome {
    std::string kind;
    std::string note;  ///< what the recording says of itself: "the bag is cut off"
    ConvertReport report;
    std::unique_ptr<FrameSink> sink;
};

Result<Outcome> convert(const ConvertOptions& options) {
    Outcome outcome;
    outcome.kind = options.to.empty() ? kind_of(options.out) : options.to;
    if (outcome.kind.empty()) {
        return fail(
            "the name does not say what to write", options.out.string(),
            "a name ending in .mkv, .oni or .ply, or --to tum|png|ply|k4a|oni|session; motion "
            "is asked for by --motion FILE");
    }
    std::error_code ignored;
    if (fs::equivalent(options.in, options.out, ignored)) {
        return fail("this is what is to be read", options.out.string(), "name another place");
    }
    KINO_ASSIGN(const auto source, open_source(options.in));
    KINO_TRY(subscribe_what_goes(*source));
    KINO_ASSIGN(const auto session, session_of(options.in));
    KINO_ASSIGN(const RigParameters parameters, source->calibration());
    KINO_ASSIGN(Rig rig, Rig::create(parameters));
    RigGeometry geometry(std::move(rig));
    ConvertInput input{source->info(), parameters, &geometry};
    // A session that becomes another one keeps the streams of all its devices.
    if (session && outcome.kind == "session") {
        input.source = session->index().source;
        input.rig = session->index().rig;
    }
    SinkOptions sink_options;
    sink_options.replace = options.force;
    sink_options.codec = options.codec;
    sink_options.depth_per_metre = options.scale;
    sink_options.first_index = options.from;
    KINO_ASSIGN(outcome.sink, make_sink(outcome.kind, options.out, input, sink_options));
    Progress progress(options.json);
    auto report = convert_recording(*source, session.get(), *outcome.sink,
                                    {.from = options.from, .count = options.count},
                                    [&](std::int64_t done, std::int64_t total) {
                                        progress.tell(done, total);
                                        return !interrupted();
                                    });
    progress.end();
    if (!report) {
        // The sink goes, and with it what it wrote.
        return fail(std::move(report).error(), options.out.string());
    }
    outcome.note = source->info().note;
    outcome.report = *std::move(report);
    return outcome;
}

constexpr std::array<StreamKind, 5> kKinds = {StreamKind::depth, StreamKind::color,
                                              StreamKind::infrared, StreamKind::motion,
                                              StreamKind::bodies};

void print_summary(const ConvertOptions& options, const Outcome& outcome) {
    std::string frames;
    for (const StreamKind kind : kKinds) {
        const std::int64_t count = outcome.sink->written(kind);
        if (count == 0) continue;
        frames += fmt::format("{}{} {}", frames.empty() ? "" : ", ", count, stream_name(kind));
    }
    fmt::print("{}: {} frames as {}\n", options.out.string(), frames, outcome.kind);
    if (!outcome.note.empty()) fmt::print("of {}: {}\n", options.in, outcome.note);
    for (const std::string& line : outcome.sink->losses().lines()) {
        fmt::print("not kept: {}\n", line);
    }
}

void print_motion(const ConvertOptions& options, const MotionOutcome& outcome) {
    const MotionSummary& s = outcome.summary;
    fmt::print("{}: person {} of {}, {} frames at {:.4g} Hz, bodies {}\n",
               options.motion.file.string(), s.person, outcome.people, s.frames, s.rate_hz,
               outcome.tracked ? "found in the depth" : "as recorded");
    const std::size_t joints = s.moments * kJointCount;
    if (s.joints_lost > 0) fmt::print("joints lost: {} of {}\n", s.joints_lost, joints);
    if (!s.never_seen.empty()) {
        std::string names;
        for (const Joint joint : s.never_seen) {
            names += fmt::format("{}{}", names.empty() ? "" : ", ", joint_name(joint));
        }
        fmt::print("never seen: {}\n", names);
    }
    if (s.max_error_mm > 0) {
        fmt::print("constant bones move joints by {:.1f} mm in the mean, {:.1f} mm at most\n",
                   s.mean_error_mm, s.max_error_mm);
    }
}

nlohmann::ordered_json motion_json(const ConvertOptions& options, const MotionOutcome& outcome) {
    const MotionSummary& s = outcome.summary;
    return {{"out", options.motion.file.string()},
            {"bodies", outcome.tracked ? "found" : "recorded"},
            {"people", outcome.people},
            {"person", s.person},
            {"moments", s.moments},
            {"frames", s.frames},
            {"rate_hz", s.rate_hz},
            {"duration_s", s.duration_s},
            {"joints_lost", s.joints_lost},
            {"bytes", s.bytes},
            {"mean_error_mm", s.mean_error_mm},
            {"max_error_mm", s.max_error_mm}};
}

nlohmann::ordered_json outcome_json(const ConvertOptions& options, const Outcome& outcome) {
    nlohmann::ordered_json out = {{"out", options.out.string()}, {"kind", outcome.kind}};
    for (const StreamKind kind : kKinds) {
        out["frames"][stream_name(kind)] = outcome.sink->written(kind);
    }
    out["note"] = outcome.note;
    out["not_kept"] = outcome.sink->losses().lines();
    out["unreadable"] = outcome.report.unreadable;
    return out;
}

void print_json(const nlohmann::ordered_json& out) {
    fmt::print("{}\n", out.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
}

int run_convert(const ConvertOptions& options) {
    register_sources();
    catch_interrupts();
    if (options.out.empty() && options.motion.file.empty()) {
        tell_error({"nothing is to be written", options.in, "name OUT, or --motion FILE"});
        return kExitUsage;
    }
    nlohmann::ordered_json out = nlohmann::ordered_json::object();
    std::optional<Outcome> outcome;
    if (!options.out.empty()) {
        auto converted = convert(options);
        if (!converted) {
            tell_error(converted.error());
            return kExitFailed;
        }
        outcome = std::move(*converted);
        out = outcome_json(options, *outcome);
        if (!options.json) print_summary(options, *outcome);
    }
    if (!options.motion.file.empty()) {
        MotionRequest request = options.motion;
        request.from = options.from;
        request.count = options.count;
        request.replace = options.force;
        Progress progress(options.json);
        const auto motion =
            export_motion(options.in, request, [&](std::int64_t done, std::int64_t total) {
                progress.tell(done, total);
                return !interrupted();
            });
        progress.end();
        if (!motion) {
            tell_error(motion.error());
            return kExitFailed;
        }
        out["motion"] = motion_json(options, *motion);
        if (!options.json) print_motion(options, *motion);
    }
    if (options.json) print_json(out);
    if (!outcome || outcome->report.unreadable == 0) return kExitDone;
    tell_error({fmt::format("{} frames could not be read and are left out, the first: {}",
                            outcome->report.unreadable, outcome->report.first_problem),
                options.in, ""});
    return kExitFailed;
}

}  // namespace

Command add_convert(CLI::App& parent) {
    auto options = std::make_shared<ConvertOptions>();
    CLI::App& app = *parent.add_subcommand("convert", "turns a recording into another format");
    app.add_option("IN", options->in,
                   "a session, a TUM folder, .oni, a k4a .mkv, a librealsense .bag, ... "
                   "(its content decides)")
        ->required();
    app.add_option("OUT", options->out,
                   "FILE.mkv, FILE.oni, FILE.ply (one frame) or cloud_%05d.ply; else say --to; "
                   "not needed with --motion");
    app.add_option("--to", options->to, "what to write where OUT's name does not say it")
        ->check(CLI::IsMember({"session", "tum", "png", "ply", "oni", "k4a"}))
        ->type_name("session|tum|png|ply|oni|k4a");
    add_codec_option(app, options->codec);
    app.add_option("--from", options->from, "the first frame to take, from 0 on")
        ->check(CLI::NonNegativeNumber)
        ->type_name("N");
    app.add_option("--count", options->count, "how many frames to take (default: all)")
        ->check(CLI::Range(std::int64_t{1}, std::int64_t{1} << 40))
        ->type_name("N");
    app.add_option("--motion", options->motion.file,
                   "the motion of one person: FILE.bvh, .glb, .csv or .c3d; of the recorded "
                   "bodies, or of those found in the depth where none were recorded")
        ->type_name("FILE");
    app.add_option("--person", options->motion.person, "motion: whose; default the longest seen")
        ->type_name("ID");
    app.add_option("--rate", options->motion.rate_hz, "motion: frames a second of BVH, GLB, C3D")
        ->check([](const std::string& word) { return check_number(word, 0.1, 1000); })
        ->type_name("HZ");
    static const std::map<std::string, BodyMode> kModes = {{"on", BodyMode::on},
                                                           {"recorded", BodyMode::recorded}};
    app.add_option_function<std::string>(
           "--bodies",
           [options](const std::string& word) { options->motion.bodies.mode = kModes.at(word); },
           "motion: of bodies found in the depth in any case (on), or never (recorded)")
        ->check(CLI::IsMember(kModes))
        ->type_name("on|recorded");
    add_tracking_options(app, options->motion.bodies);
    app.add_option("--scale", options->scale,
                   "counts a metre of TUM depth; default is the recording's own unit, which loses "
                   "nothing. Tools that read no calibration.json expect 5000")
        ->check([](const std::string& word) { return check_number(word, 1, 1e6); })
        ->type_name("N");
    app.add_flag("--force", options->force, "replace what is there");
    app.add_flag("--json", options->json, "print the outcome as JSON");
    app.footer(
        "The summary says what the new format cannot hold. OUT gets its name when it is whole: "
        "what is\ninterrupted or fails leaves nothing behind.");
    return [options] { return run_convert(*options); };
}

}  // namespace kino
