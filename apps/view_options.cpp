#include "apps/view_options.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <map>
#include <string>

#include "apps/calibration_option.h"
#include "apps/checked_words.h"
#include "apps/exit_codes.h"
#include "apps/headless.h"
#include "apps/interrupt.h"
#include "apps/sources.h"
#include "apps/stage/bundled.h"
#include "apps/viewer/budget_log.h"
#include "apps/viewer/keys.h"
#include "apps/window/window_replay.h"
#include "sensor/filters/depth_filter_chain.h"
#include "skeleton/filters/body_filter.h"
#include "viz/scene/scene_file.h"

namespace kino {
namespace {

/// Of --lod: a run's summary, where it is nothing else.
bool names_log(const std::string& word) {
    std::error_code error;
    return word != "auto" && word != "off" && !check_number(word, 1, 8).empty() &&
           std::filesystem::is_regular_file(word, error);
}

template <class Value>
void add_choice(CLI::App& app, const char* name, std::optional<Value>& out,
                std::map<std::string, Value> choices, const char* help) {
    std::string words;
    for (const auto& [word, value] : choices) words += (words.empty() ? "" : "|") + word;
    app.add_option_function<std::string>(
           name, [&out, choices](const std::string& word) { out = choices.at(word); }, help)
        ->check(CLI::IsMember(choices))
        ->type_name(words);
}

}  // namespace

void add_view_options(CLI::App& app, const std::shared_ptr<ReplayOptions>& options) {
    app.add_option_function<std::string>(
           "--raster",
           [options](const std::string& word) {
               options->raster = word == "compute"     ? RasterPath::compute
                                 : word == "compute32" ? RasterPath::compute_32bit
                                                       : RasterPath::hardware;
           },
           "how depth becomes pixels")
        ->check(CLI::IsMember({"compute", "compute32", "hardware"}))
        ->type_name("compute|compute32|hardware");
    add_choice<DepthStyle>(app, "--style", options->style,
                           {{"cloud", DepthStyle::cloud}, {"mesh", DepthStyle::mesh}},
                           "points or a surface, default mesh");
    app.add_option("--splat", options->splat_px, "largest point size, 1 to 32")
        ->check(CLI::Range(1, 32))
        ->type_name("PX");
    add_choice<ViewKind>(
        app, "--view", options->view,
        {{"sensor", ViewKind::sensor}, {"orbit", ViewKind::orbit}, {"fly", ViewKind::fly}},
        "camera to start with, default orbit");
    add_choice<ColorMode>(app, "--color", options->color,
                          {{"captured", ColorMode::captured},
                           {"mixed", ColorMode::mixed},
                           {"relit", ColorMode::relit}},
                          "default: captured, or relit where there is depth only");
    app.add_option("--filter", options->filters,
                   "depth filters, as flying,spatial,temporal,holes; none by default")
        ->check([](const std::string& text) {
            const auto chain = DepthFilterChain::parse(text);
            return chain ? std::string() : chain.error().to_string();
        })
        ->type_name("SPEC");
    app.add_option_function<std::string>(
           "--lod",
           [options](const std::string& word) {
               options->lod_auto = word == "auto";
               options->lod_log = names_log(word) ? word : "";
               const bool number = word != "auto" && word != "off" && !names_log(word);
               options->lod = number ? std::stod(word) : 1;
           },
           "with --scene: light on a picture R times coarser, brought back along edges; auto: as "
           "--target-ms asks for, with --zoom where that does not do (in a window; headless: in "
           "full); FILE: as in the run that wrote this summary.json")
        ->check([](const std::string& word) {
            if (word == "off" || word == "auto") return std::string();
            if (!names_log(word)) return check_number(word, 1, 8);
            const auto log = read_budget_log(word);
            return log ? std::string() : log.error().to_string();
        })
        ->type_name("off|auto|R|FILE");
    app.add_option("--zoom", options->zoom,
                   "whole pictures Z times coarser, enlarged by copying, 1 to 8; with --lod auto: "
                   "at most, default 2")
        ->check(CLI::Range(1, kMaxZoom))
        ->type_name("Z");
    app.add_option("--fix", options->fix_share,
                   "with --lod: shade anew what no coarse pixel resembles, at most this share of "
                   "the picture, 0 (default) to 0.5")
        ->check([](const std::string& word) { return check_number(word, 0, 0.5); })
        ->type_name("SHARE");
    app.add_option("--samples", options->samples,
                   "a pixel of a scene's meshes, 1 (default) or 4: smooth edges; not with --lod")
        ->check(CLI::IsMember({1, 4}))
        ->type_name("N");
    app.add_flag("--true-error", options->true_error,
                 "compare a picture in thirty with the same one in full: PSNR and FLIP");
    app.add_option("--target-ms", options->target_ms, "time of a picture that --lod auto holds")
        ->check([](const std::string& word) { return check_number(word, 1, 1000); })
        ->type_name("T");
    app.add_option("--headless", options->headless,
                   "no window: pictures, video.mp4 and summary.json into OUT")
        ->type_name("OUT");
    app.add_option("--frames", options->frames, "end after N frames (of each URI)")
        ->check(CLI::Range(std::int64_t{1}, std::int64_t{1} << 40))
        ->type_name("N");
    app.add_option("--pictures", options->pictures,
                   "headless: at most N pictures of each URI as PNG, default 12; -1: all")
        ->check(CLI::Range(-1, 1 << 30))
        ->type_name("N");
    add_body_options(app, options->bodies);
    add_calibration_option(app, options->calibration);
    app.add_option("--scene", options->scene,
                   "put people on this stage: a name (--list-scenes) or a scene file "
                   "(docs/scenes.md); looks for bodies where none are recorded")
        ->check([](const std::string& name) {
            if (bundled_scene(name)) return std::string();
            const auto read = read_scene_file(name);
            return read ? std::string()
                        : read.error().to_string() + "\nor one of:\n" + list_of_scenes();
        })
        ->type_name("NAME|FILE");
    app.add_flag_callback(
        "--list-scenes",
        [] {
            fmt::print("{}", list_of_scenes());
            throw CLI::Success();
        },
        "what --scene knows");
    app.parse_complete_callback(
        [&app, options] { options->bodies_asked = app.count("--bodies") > 0; });
    app.add_option_function<std::string>(
           "--size",
           [options](const std::string& text) {
               int width = 0, height = 0;
               if (const std::string problem = read_size(text, width, height); !problem.empty()) {
                   throw CLI::ValidationError(problem);
               }
               options->width = width;
               options->height = height;
           },
           "of the picture, default 1280x720")
        ->type_name("WxH");
    app.add_option("--device", options->device,
                   "Vulkan device: part of its name, or discrete, integrated, cpu")
        ->type_name("NAME");
    app.add_flag("--json", options->json, "print the summary as JSON");
    app.add_flag("--verbose", options->verbose, "a line a frame");
}

void add_codec_option(CLI::App& app, SessionCodec& codec) {
    static const std::map<std::string, SessionCodec> kCodecs = {{"ffv1", SessionCodec::ffv1},
                                                                {"fast", SessionCodec::fast},
                                                                {"rvl", SessionCodec::rvl},
                                                                {"raw", SessionCodec::raw}};
    app.add_option_function<std::string>(
           "--codec", [&codec](const std::string& word) { codec = kCodecs.at(word); },
           "of recordings, all lossless: ffv1 (default) opens everywhere, fast is for slow "
           "machines")
        ->check(CLI::IsMember(kCodecs))
        ->type_name("ffv1|fast|rvl|raw");
}

void add_body_options(CLI::App& app, BodyOptions& bodies) {
    static const std::map<std::string, BodyMode> kModes = {
        {"off", BodyMode::off}, {"on", BodyMode::on}, {"recorded", BodyMode::recorded}};
    app.add_option_function<std::string>(
           "--bodies", [&bodies](const std::string& word) { bodies.mode = kModes.at(word); },
           "people, joints and gestures: found in the depth (on), gestures of recorded bodies "
           "(recorded), or only what was recorded (off, the default)")
        ->check(CLI::IsMember(kModes))
        ->type_name("off|on|recorded");
    app.add_option("--gestures", bodies.gestures, "definitions of gestures as JSON")
        ->type_name("FILE");
    add_tracking_options(app, bodies);
}

void add_tracking_options(CLI::App& app, BodyOptions& bodies) {
    app.add_flag("--seated", bodies.seated,
                 "bodies: ten joints, for people who sit; a recording may say so itself");
    app.add_flag("--moving-sensor", bodies.moving_sensor,
                 "bodies: the sensor may move, so the room is not learned");
    app.add_option("--filter-joints", bodies.joint_filter,
                   "none, holt, one-euro or kalman, as one-euro:calm; docs/gestures.md lists them")
        ->check([](const std::string& name) {
            const auto filter = make_body_filter(name);
            return filter ? std::string() : filter.error().to_string();
        })
        ->type_name("NAME");
    app.add_option("--forest", bodies.forest,
                   "body parts by this forest instead of the shipped one")
        ->type_name("FILE");
}

std::string view_footer() {
    return "Without a display, what --headless out does is done.\n\nScenes:\n" + list_of_scenes() +
           "\nDepth filters:\n" + DepthFilterChain::help() + "\nKeys in the window:\n" +
           keys_text();
}

int run_view(const ReplayOptions& options) {
    catch_interrupts();
    if (!options.headless.empty()) return replay_headless(options);
    const std::optional<int> code = replay_in_window(options);
    if (code) return *code;
    ReplayOptions fallback = options;
    fallback.headless = "out";
    fmt::print(stderr, "kinoscope: writing pictures into {} instead\n", fallback.headless.string());
    return replay_headless(fallback);
}

}  // namespace kino
