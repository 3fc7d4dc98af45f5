#include <CLI/CLI.hpp>
#include <cstdlib>
#include <map>
#include <memory>
#include <string>

#include "apps/commands.h"
#include "apps/sources.h"
#include "apps/view_options.h"
#include "sensor/playback.h"

namespace kino {

Command add_replay(CLI::App& parent) {
    auto options = std::make_shared<ReplayOptions>();
    CLI::App& app = *parent.add_subcommand("replay", "plays recordings and synthetic scenes");
    app.add_option("URI", options->uris,
                   "recordings (sessions, ONI files, folders) or synthetic:[MOTION], played one "
                   "after the other; A+B plays depth of A with colour of B")
        ->required();
    app.add_option("--speed", options->speed, "0.1 to 8, default 1")
        ->check([](const std::string& text) {
            // CLI::Range lets "nan" through.
            const double speed = std::strtod(text.c_str(), nullptr);
            const bool fits = speed >= Playback::kMinSpeed && speed <= Playback::kMaxSpeed;
            return fits ? std::string() : text + " is not a speed from 0.1 to 8";
        })
        ->type_name("X");
    app.add_flag("--stepped", options->stepped,
                 "every frame in order, none dropped, the same bits every time; "
                 "--headless is always stepped");
    static const std::map<std::string, LoopMode> kLoops = {
        {"once", LoopMode::once}, {"loop", LoopMode::loop}, {"ping-pong", LoopMode::ping_pong}};
    app.add_option_function<std::string>(
           "--loop", [options](const std::string& word) { options->loop = kLoops.at(word); },
           "default: loop, ping-pong for less than two seconds")
        ->check(CLI::IsMember(kLoops))
        ->type_name("once|loop|ping-pong");
    add_view_options(app, options);
    app.footer(view_footer());
    return [options] {
        register_sources();
        return run_view(*options);
    };
}

}  // namespace kino
