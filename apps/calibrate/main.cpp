#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cstdlib>
#include <exception>
#include <optional>
#include <string>

#include "apps/calibrate/board_depth.h"
#include "apps/calibrate/guide_window.h"
#include "apps/calibrate/guided_capture.h"
#include "apps/calibrate/outputs.h"
#include "apps/calibrate/session_check.h"
#include "apps/calibrate/session_shots.h"
#include "apps/calibrate/still_scene.h"
#include "apps/checked_words.h"
#include "apps/exit_codes.h"
#include "apps/interrupt.h"
#include "apps/sources.h"
#include "calibration/boards/gather.h"
#include "calibration/files/calibration_store.h"
#include "sensor/source.h"

namespace kino {
namespace {

constexpr int kCheckFrames = 100;

struct Options {
    std::string images;
    std::string pairs;
    std::string names;
    std::string session;
    std::string uri;
    std::string board = "chess:9x6:25";
    std::string model = "auto";
    std::string serial;
    std::string depth;
    std::string check;
    std::string wall;
    std::string drift;
    bool keep = false;
    std::array<double, 2> depth_shift = {0, 0};
    bool squared = false;
    bool json = false;
    int views = 30;
    std::optional<std::int64_t> frames;
    std::optional<double> seconds;
    bool no_window = false;
    Outputs outputs;
};

void say(std::string_view line) {
    fmt::print(stderr, "{}\n", line);
}

bool has_display() {
    const auto is_set = [](const char* name) {
        const char* value = std::getenv(name);
        return value != nullptr && *value != 0;
    };
    return is_set("DISPLAY") || is_set("WAYLAND_DISPLAY");
}

Result<Shots> gather(const Options& options, const Board& board, std::vector<ViewDepth>& depth,
                     std::vector<std::string>& notes) {
    if (!options.images.empty()) {
        KINO_ASSIGN(const PictureSet set, pictures_in(options.images));
        return shots_of_pictures(set, board, notes, say);
    }
    if (!options.pairs.empty()) {
        KINO_ASSIGN(const PictureSet set, picture_pairs_in(options.pairs, options.names));
        return shots_of_pictures(set, board, notes, say);
    }
    if (!options.session.empty()) {
        return shots_of_session(options.session, board, {.views = options.views}, depth, notes,
                                say);
    }
    std::string uri = options.uri;
    if (uri.empty()) {
        KINO_ASSIGN(uri, first_device());
    }
    GuidedCaptureOptions how;
    how.guide.views = options.views;
    if (options.frames) how.frames = *options.frames;
    if (options.seconds) how.duration = static_cast<TimeNs>(*options.seconds * kNsPerSecond);
    // The window is gone before the solve begins.
    if (!options.no_window && has_display()) {
        auto window = GuideWindow::open(board);
        if (window) return guided_shots(uri, board, how, **window, depth, notes);
        say("no window: " + window.error().to_string());
    }
    GuideLinesScreen lines(say);
    return guided_shots(uri, board, how, lines, depth, notes);
}

// What a session knows besides its cameras: serial, range, disparity.
RigParameters base_rig(const Options& options) {
    RigParameters rig;
    const std::string& uri = options.session.empty() ? options.uri : options.session;
    if (!uri.empty()) {
        if (const auto source = open_source(uri)) {
            if (auto known = (*source)->calibration()) rig = std::move(*known);
            if (rig.serial.empty()) rig.serial = (*source)->info().serial;
        }
    }
    if (!options.serial.empty()) rig.serial = options.serial;
    return rig;
}

void tell(const Report& report) {
    const Calibration& c = report.calibration;
    for (const std::string& note : report.notes) say("note: " + note);
    for (const std::string& note : c.notes) say("note: " + note);
    for (const CameraResult& camera : c.cameras) {
        fmt::print("{}: {}x{}, {}, RMS {:.3f} px", camera.name, camera.camera.width,
                   camera.camera.height, name(camera.model), camera.rms_px);
        for (const LensScore& score : camera.scores) {
            if (score.model == camera.model) fmt::print(", held out {:.3f} px", score.held_out_px);
        }
        fmt::print("\n");
        for (const SolvedNumber& n : camera.numbers) {
            fmt::print("  {} {:12.6g} {}\n", n.name, n.value,
                       n.held ? std::string("held") : fmt::format("+- {:.2g}", n.sigma));
        }
    }
    for (const SolvedNumber& n : c.rig) {
        fmt::print("  {} {:10.4f} +- {:.2g} {}\n", n.name, n.value, n.sigma, n.unit);
    }
    fmt::print("{} views, RMS {:.3f} px\n", c.views.size(), c.rms_px);
}

// From --depth's recording, else from the middle one of the views.
Result<void> show_overlays(const Options& options, const std::vector<ViewDepth>& depth,
                           const RigParameters& before, const RigParameters& after,
                           Report& report) {
    if (!options.depth.empty()) {
        RigParameters own;
        KINO_ASSIGN(const FramePair pair, first_pair(options.depth, own));
        if (pair.color) add_overlays(*pair.depth, *pair.color, own, after, report);
        return {};
    }
    if (depth.empty()) return {};
    const ViewDepth& middle = depth[depth.size() / 2];
    if (middle.color) add_overlays(*middle.frame, *middle.color, before, after, report);
    return {};
}

// --drift and --wall also go alone.
bool needs_no_board(const Options& o) {
    return (!o.drift.empty() || !o.wall.empty()) && o.images.empty() && o.pairs.empty() &&
           o.session.empty() && o.uri.empty();
}

Result<void> run_without_board(const Options& options) {
    Report report;
    report.title = "Depth of a still scene";
    if (!options.wall.empty()) {
        KINO_ASSIGN(const BiasFit fit, bias_of_wall(options.wall, kCheckFrames));
        report.notes.push_back(bias_text(fit));
        KINO_ASSIGN(const auto source, open_source(options.wall));
        const std::string serial = options.serial.empty() ? source->info().serial : options.serial;
        // Beside the calibration that the recording was made with, whose file this is to be.
        if (!options.outputs.rig.empty()) {
            KINO_TRY(write_bias_beside(options.outputs.rig, fit.bias, serial));
        }
        if (options.keep) {
            if (serial.empty()) {
                return fail("the device has no serial number to keep its bias under", options.wall,
                            "state one with --serial");
            }
            KINO_ASSIGN(const auto folder, calibration_folder());
            KINO_TRY(write_bias_beside(calibration_file(folder, serial), fit.bias, serial));
        }
    }
    if (!options.drift.empty()) {
        KINO_ASSIGN(report.drift, drift_of(options.drift));
        report.notes.push_back("drift " + drift_text(*report.drift));
    }
    if (!options.outputs.report.empty()) KINO_TRY(write_report(options.outputs.report, report));
    if (options.json) {
        fmt::print("{}", report_json(report));
    } else {
        for (const std::string& note : report.notes) fmt::print("{}\n", note);
    }
    return {};
}

Result<void> run(const Options& options) {
    if (!options.check.empty()) {
        KINO_ASSIGN(const SessionCheck check, check_session(options.check, kCheckFrames));
        fmt::print("{}", check_text(check));
        return {};
    }
    if (needs_no_board(options)) return run_without_board(options);
    KINO_ASSIGN(const Board board, parse_board(options.board));
    CalibrateOptions how;
    how.progress = say;
    if (options.squared) how.bundle.huber_sigmas = 0;
    if (options.model != "auto") {
        std::optional<LensModel> known;
        for (const LensModel model : kLensModels) {
            if (name(model) == options.model) known = model;
        }
        if (!known) {
            return fail(fmt::format("\"{}\" is no lens model", options.model), "--model",
                        "auto, pinhole, brown4, brown5 or rational8");
        }
        how.models = {*known};
    }
    Report report;
    std::vector<ViewDepth> depth;
    KINO_ASSIGN(const Shots shots, gather(options, board, depth, report.notes));
    KINO_ASSIGN(report.calibration, calibrate(shots, how));
    report.board = board_text(board);
    report.title = "Calibration";
    for (const CameraResult& camera : report.calibration.cameras) {
        report.title +=
            (&camera == &report.calibration.cameras[0] ? " of " : " and ") + camera.name;
    }
    if (!options.depth.empty()) {
        KINO_ASSIGN(SessionCheck check, check_session(options.depth, kCheckFrames));
        report.planes = std::move(check.planes);
    }
    if (!options.drift.empty()) {
        KINO_ASSIGN(report.drift, drift_of(options.drift));
    }
    const RigParameters before = base_rig(options);
    RigParameters rig =
        rig_of(report.calibration, before, {options.depth_shift[0], options.depth_shift[1]});
    // The board stands where the infrared camera, which is the depth camera, saw it.
    const bool from_infrared =
        report.calibration.cameras[0].name == stream_name(StreamKind::infrared);
    std::optional<BiasFit> fit;
    if (from_infrared) {
        fit = use_board_depth(report.calibration, board, depth, rig, report.notes);
    }
    std::optional<DepthBias> bias;
    if (fit) bias = fit->bias;
    if (!options.wall.empty()) {
        KINO_ASSIGN(const BiasFit wall, bias_of_wall(options.wall, kCheckFrames));
        report.notes.push_back(bias_text(wall));
        bias = wall.bias;
    }
    KINO_TRY(show_overlays(options, depth, before, rig, report));
    KINO_TRY(write_outputs(options.outputs, report, rig, bias));
    if (options.keep) {
        KINO_ASSIGN(const auto folder, calibration_folder());
        KINO_ASSIGN(const auto file, store_calibration(folder, rig));
        KINO_TRY(write_bias_beside(file, bias, rig.serial));
        say("kept as " + file.string());
    }
    if (options.json) {
        fmt::print("{}", report_json(report));
    } else {
        tell(report);
    }
    return {};
}

void add_options(CLI::App& app, Options& o) {
    auto* images = app.add_option("--images", o.images, "folder of pictures by one camera");
    auto* pairs = app.add_option("--pairs", o.pairs,
                                 "folder of pictures by two cameras, paired by "
                                 "name (infrared01 and color01, left01 and right01)");
    app.add_option("--names", o.names, "what the pairs' names begin with: first,second");
    auto* session = app.add_option("--session", o.session, "session with the board in it");
    auto* uri = app.add_option("uri", o.uri,
                               "device, or a recording played as one, for a guided capture; "
                               "without any of these, the first device found");
    images->excludes(pairs)->excludes(session)->excludes(uri);
    pairs->excludes(session)->excludes(uri);
    session->excludes(uri);
    app.add_option("--board", o.board,
                   "chess:9x6:25 (inner corners, mm) or charuco:14x9:40:30:6 (squares, mm, marker "
                   "mm, dictionary)")
        ->capture_default_str();
    app.add_option("--model", o.model, "auto, pinhole, brown4, brown5 or rational8")
        ->capture_default_str();
    app.add_flag("--squared", o.squared, "plain squares instead of the robust loss");
    app.add_option("--views", o.views, "how many views to take from a session or device")
        ->check(CLI::Range(3, 200))
        ->capture_default_str();
    app.add_option("--frames", o.frames, "guided capture: look at no more frames than these")
        ->check(CLI::PositiveNumber);
    app.add_option("--seconds", o.seconds, "guided capture: end after this time")
        ->check([](const std::string& word) { return check_number(word, 0.001, 1e9); });
    app.add_flag("--no-window", o.no_window, "guided capture in lines of text");
    app.add_option("--depth-shift", o.depth_shift,
                   "x y: px from the depth image to the infrared one (Kinect v1: 4.8 3.9)");
    app.add_option("--serial", o.serial, "serial number to write into the result");
    app.add_flag("--keep", o.keep, "keep the calibration for the device of this serial number");
    app.add_option("--check", o.check,
                   "no board: depth error of flat parts and how far colour lies from depth, in a "
                   "session or device")
        ->excludes(images)
        ->excludes(pairs)
        ->excludes(session)
        ->excludes(uri);
    app.add_option("--wall", o.wall,
                   "session or device before a flat wall: bias of each part of the depth picture; "
                   "written beside --out or, with --keep, beside the device's calibration");
    app.add_option("--drift", o.drift,
                   "long session of a still scene: how its depth drifts while the sensor warms up");
    app.add_option("--depth", o.depth, "session whose flat parts show the depth error by distance");
    app.add_option("--out", o.outputs.rig, "calibration as Kinoscope reads it (JSON)");
    app.add_option("--report", o.outputs.report, "folder for report.html and report.json");
    app.add_option("--ros", o.outputs.ros, "folder for ROS camera_info, one file a camera");
    app.add_option("--opencv", o.outputs.opencv, "OpenCV YAML");
    app.add_option("--k4a", o.outputs.k4a, "Azure Kinect JSON (only at that sensor's sizes)");
    app.add_option("--tum", o.outputs.tum, "folder for TUM intrinsics, one file a camera");
    app.add_flag("--json", o.json, "the report as JSON on stdout");
    app.footer(
        "Exit status: 0 done, 1 no calibration could be found or a file or device not be used, 2 "
        "wrong usage.");
}

}  // namespace
}  // namespace kino

int main(int argc, char** argv) {
    using namespace kino;
    CLI::App app("Finds the cameras of a sensor from pictures of a board, and says how well.",
                 "kinoscope calibrate");
    Options options;
    add_options(app, options);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? kExitDone : kExitUsage;
    }
    try {
        register_sources();
        catch_interrupts();
        const auto done = run(options);
        if (done) return kExitDone;
        fmt::print(stderr, "kinoscope calibrate: {}\n", done.error().to_string());
    } catch (const std::exception& thrown) {
        fmt::print(stderr, "kinoscope calibrate: {}\n", thrown.what());
    }
    return kExitFailed;
}
