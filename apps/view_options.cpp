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

/// `out`: a Value, or an optional one.
template <class Value, class Out>
void add_choice(CLI::App& app, const char* name, Out& out, std::map<std::string, Value> choices,
                const char* help) {
    std::string words;
    for (const auto& [word, value] : choices) words += (words.empty() ? "" : "|") + word;
    app.add_option_function<std::string>(
           name, [&out, choices](const std::string& word) { out = choices.at(word); }, help)
        ->check(CLI::IsMember(choices))
        ->type_name(words);
}

/// Rates of parts of the light, and tiles.
void add_light_options(CLI::App& app, const std::shared_ptr<ReplayOptions>& options) {
    const auto rate = [](const std::string& word) { return check_number(word, 1, 8); };
    app.add_option("--plain-lod", options->part_rates.plain,
                   "with --scene: as --lod R, for lights that cast no shadows by rays")
        ->check(rate)
        ->type_name("R");
    app.add_option("--bounce-lod", options->part_rates.bounced, "and for bounced light")
        ->check(rate)
        ->type_name("R");
    app.add_option_function<double>(
           "--regions",
           [options](double limit) {
               options->regions = RegionLodOptions{.limit = static_cast<float>(limit)};
           },
           "with --scene: light up to four times coarser than --lod in tiles where it changes by "
           "less than this from one coarse pixel to the next, 0.01 to 1")
        ->check([](const std::string& word) { return check_number(word, 0.01, 1); })
        ->type_name("LIMIT");
    app.add_option("--learn", options->learn,
                   "with --scene and --headless: write what its light costs, part by part, and "
                   "loses when it is coarser, as JSON")
        ->type_name("FILE");
}

void add_zoom_options(CLI::App& app, const std::shared_ptr<ReplayOptions>& options) {
    static const std::map<std::string, SceneZoomBy> kChoosers = {
        {"reactive", SceneZoomBy::reactive},
        {"predictive", SceneZoomBy::predictive},
        {"head", SceneZoomBy::head}};
    app.add_option_function<std::string>(
           "--zoom",
           [options](const std::string& word) {
               const auto chooser = kChoosers.find(word);
               options->zoom_by = chooser != kChoosers.end() ? chooser->second : SceneZoomBy::fixed;
               options->zoom.reset();
               if (word == "auto") options->lod_auto = true;
               if (word != "auto" && chooser == kChoosers.end()) options->zoom = std::stoi(word);
           },
           "whole pictures Z times coarser, enlarged by copying, 1 to 8; with --lod auto: at most, "
           "default 2; in a window as --target-ms asks for by the last frame (reactive) or by "
           "counted work (predictive); as quick as the viewer moves (head); auto: as --lod auto")
        ->check([](const std::string& word) {
            if (word == "auto" || kChoosers.count(word) > 0) return std::string();
            int z = 0;
            const bool fits = CLI::detail::lexical_cast(word, z) && z >= 1 && z <= kMaxZoom;
            return fits ? std::string()
                        : word + " is not 1 to 8, reactive, predictive, head or auto";
        })
        ->type_name("Z|reactive|predictive|head|auto");
    app.add_option("--most-zoom", options->most_zoom,
                   "at most, where --zoom names who chooses, default 4")
        ->check(CLI::Range(1, kMaxZoom))
        ->type_name("Z");
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
               options->lod_auto = options->lod_auto || word == "auto";
               options->lod_log = names_log(word) ? word : "";
               const bool number = word != "auto" && word != "off" && !names_log(word);
               if (word != "auto") options->lod = number ? std::stod(word) : 1;
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
    add_light_options(app, options);
    add_zoom_options(app, options);
    app.add_option("--fix", options->fix_share,
                   "with --lod: shade anew what no coarse pixel resembles, at most this share of "
                   "the picture, 0 (default) to 0.5")
        ->check([](const std::string& word) { return check_number(word, 0, 0.5); })
        ->type_name("SHARE");
    app.add_option("--samples", options->samples,
                   "a pixel of a scene's meshes, 1 (default) or 4: smooth edges, shaded or, with "
                   "--lod, from the light that is there")
        ->check(CLI::IsMember({1, 4}))
        ->type_name("N");
    app.add_flag("--true-error", options->true_error,
                 "compare a picture in thirty with the same one in full: PSNR and FLIP");
    add_target_option(
        app, [options](double ms) { options->target_ms = ms; },
        "time of a picture that --lod auto or --zoom hold, default 33.3");
    add_choice<PresentMode>(
        app, "--sync", options->sync,
        {{"fifo", PresentMode::fifo},
         {"mailbox", PresentMode::mailbox},
         {"immediate", PresentMode::immediate}},
        "when a window shows a picture that is done: at the next retrace (default), the newest at "
        "the next retrace, or at once; fifo where the display has no other");
    add_output_options(
        app,
        {options->headless, options->frames, options->pictures, options->json, options->verbose},
        {.headless = "no window: pictures, video.mp4 and summary.json into OUT",
         .frames = "end after N frames (of each URI)",
         .pictures = "headless: at most N pictures of each URI as PNG, default 12; -1: all",
         .verbose = "a line a frame"});
    add_body_options(app, options->bodies);
    add_calibration_option(app, options->calibration);
    add_scene_option(app,
                     "put people on this stage: a name (--list-scenes) or a scene file "
                     "(docs/scenes.md); looks for bodies where none are recorded",
                     [options](const std::string& name) { options->scene = name; });
    app.add_flag_callback(
        "--list-scenes",
        [] {
            fmt::print("{}", list_of_scenes());
            throw CLI::Success();
        },
        "what --scene knows");
    add_picture_options(
        app,
        [options](int width, int height) {
            options->width = width;
            options->height = height;
        },
        options->device);
    app.parse_complete_callback([&app, options] {
        options->bodies_asked = app.count("--bodies") > 0;
        if (const std::string problem = options->contradiction(); !problem.empty()) {
            throw CLI::ValidationError(problem);
        }
    });
}

void add_gestures_option(CLI::App& app, BodyOptions& bodies) {
    app.add_option("--gestures", bodies.gestures, "definitions of gestures as JSON")
        ->type_name("FILE");
}

void add_scene_option(CLI::App& app, std::string about,
                      std::function<void(const std::string&)> take) {
    app.add_option_function<std::string>("--scene", std::move(take), std::move(about))
        ->check([](const std::string& name) {
            if (bundled_scene(name)) return std::string();
            const auto read = read_scene_file(name);
            return read ? std::string()
                        : read.error().to_string() + "\nor one of:\n" + list_of_scenes();
        })
        ->type_name("NAME|FILE");
}

void add_target_option(CLI::App& app, std::function<void(double)> take, std::string about) {
    app.add_option_function<double>("--target-ms", std::move(take), std::move(about))
        ->check([](const std::string& word) { return check_number(word, 1, 1000); })
        ->type_name("T");
}

void add_picture_options(CLI::App& app, std::function<void(int width, int height)> take_size,
                         std::string& device) {
    app.add_option_function<std::string>(
           "--size",
           [take = std::move(take_size)](const std::string& text) {
               int width = 0, height = 0;
               if (const std::string problem = read_size(text, width, height); !problem.empty()) {
                   throw CLI::ValidationError(problem);
               }
               take(width, height);
           },
           "of the picture, default 1280x720")
        ->type_name("WxH");
    app.add_option("--device", device,
                   "Vulkan device: part of its name, or discrete, integrated, cpu")
        ->type_name("NAME");
}

void add_output_options(CLI::App& app, const OutputOptions& options, const OutputWords& words) {
    app.add_option("--headless", options.headless, words.headless)->type_name("OUT");
    app.add_option("--frames", options.frames, words.frames)
        ->check(CLI::Range(std::int64_t{1}, std::int64_t{1} << 40))
        ->type_name("N");
    app.add_option("--pictures", options.pictures, words.pictures)
        ->check(CLI::Range(-1, 1 << 30))
        ->type_name("N");
    app.add_flag("--json", options.json, "print the summary as JSON");
    app.add_flag("--verbose", options.verbose, words.verbose);
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
    add_gestures_option(app, bodies);
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
