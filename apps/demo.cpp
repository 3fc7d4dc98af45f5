#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <string>

#include "apps/avatar/avatar_rig.h"
#include "apps/calibration_option.h"
#include "apps/checked_words.h"
#include "apps/commands.h"
#include "apps/demo_show/show_options.h"
#include "apps/exit_codes.h"
#include "apps/interrupt.h"
#include "apps/replay_options.h"
#include "apps/sources.h"
#include "apps/stage/bundled.h"
#include "apps/view_options.h"

namespace kino {
namespace {

/// The scene that was asked for, then the others.
std::vector<std::string> scenes_from(const std::string& first) {
    std::vector<std::string> names = {first};
    for (const BundledScene& scene : bundled_scenes()) {
        if (scene.name != first) names.emplace_back(scene.name);
    }
    return names;
}

void add_what_is_shown(CLI::App& app, const std::shared_ptr<ShowOptions>& options) {
    add_scene_option(app, "begin on this stage: a name or a scene file (docs/scenes.md)",
                     [options](const std::string& name) { options->scenes = scenes_from(name); });
    app.add_option("--avatar", options->avatar,
                   "a character that moves as people do: one of those below, or a glTF file")
        ->check([](const std::string& name) {
            if (name == "none") return std::string();
            const auto rig = open_avatar(name);
            return rig ? std::string()
                       : rig.error().to_string() + "\nor one of:\n" + list_of_avatars();
        })
        ->type_name("NAME|FILE|none");
    app.add_flag_function(
        "--body,!--no-body", [options](std::int64_t count) { options->live_body = count > 0; },
        "show the depth of people; default: unless an avatar stands for them");
    app.add_flag("--mirror,!--no-mirror", options->mirror, "as in a mirror, default yes");
    add_calibration_option(app, options->calibration);
    add_tracking_options(app, options->bodies);
    add_gestures_option(app, options->bodies);
}

void add_how_it_is_drawn(CLI::App& app, const std::shared_ptr<ShowOptions>& options) {
    app.add_option("--lod", options->lod,
                   "light on a picture R times coarser; default: full headless, in a window as "
                   "--target-ms asks for")
        ->check([](const std::string& word) { return check_number(word, 1, 8); })
        ->type_name("R");
    add_target_option(
        app, [options](double ms) { options->target_ms = ms; },
        "time of a picture that is kept in a window, default 33.3");
    add_picture_options(
        app,
        [options](int width, int height) {
            options->width = width;
            options->height = height;
        },
        options->device);
    add_output_options(
        app,
        {options->headless, options->frames, options->pictures, options->json, options->verbose},
        {.headless =
             "no window: pictures, video.mp4 and summary.json into OUT, the same bits every "
             "time",
         .frames = "end after N pictures",
         .pictures = "headless: at most N pictures as PNG, default 12; -1: all",
         .verbose = "a line an event"});
}

int run_demo(const ShowOptions& options) {
    register_sources();
    catch_interrupts();
    const ShowHelp help{
        .interrupted = interrupted, .find_device = first_device, .validation = wants_validation()};
    if (!options.headless.empty()) return show_headless(options, help);
    if (const std::optional<int> code = show_in_window(options, help)) return *code;
    ShowOptions fallback = options;
    fallback.headless = "out";
    fmt::print(stderr, "kinoscope: writing pictures into {} instead\n", fallback.headless.string());
    return show_headless(fallback, help);
}

}  // namespace

Command add_demo(CLI::App& parent) {
    auto options = std::make_shared<ShowOptions>();
    CLI::App& app = *parent.add_subcommand(
        "demo", "the gesture-controlled demo: paint with light, throw, turn the stage");
    app.add_option("URI", options->uri,
                   "a sensor or a recording; default: the first sensor there is, and while there "
                   "is none or nobody before it, a recorded performance");
    add_what_is_shown(app, options);
    add_how_it_is_drawn(app, options);
    app.footer(
        "Wave to begin; docs/demo.md says what each gesture does. Without a display, what "
        "--headless out\ndoes is done.\n\nScenes:\n" +
        list_of_scenes() + "\nAvatars:\n" + list_of_avatars() + "\nKeys in the window:\n" +
        show_keys_text());
    return [options] { return run_demo(*options); };
}

}  // namespace kino
