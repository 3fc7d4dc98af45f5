#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <exception>
#include <vector>

#include "apps/commands.h"
#include "apps/exit_codes.h"

int main(int argc, char** argv) {
    using namespace kino;
    // A reader that goes away is an error to report, not the end.
    std::signal(SIGPIPE, SIG_IGN);
    CLI::App app("Turns depth sensors into interactive pictures.", "kinoscope");
    app.set_version_flag("--version", "kinoscope " KINO_VERSION);
    app.require_subcommand(1);
    app.footer(kExitCodesText);
    const std::vector<Command> commands = {add_demo(app),    add_live(app),     add_replay(app),
                                           add_record(app),  add_convert(app),  add_repair(app),
                                           add_devices(app), add_compare(app),  add_bench(app),
                                           add_train(app),   add_calibrate(app)};
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? kExitDone : kExitUsage;
    }
    try {
        const std::vector<const CLI::App*> known = [&] {
            const auto all = app.get_subcommands([](const CLI::App*) { return true; });
            return std::vector<const CLI::App*>(all.begin(), all.end());
        }();
        const CLI::App* chosen = app.get_subcommands().front();
        const auto at = std::find(known.begin(), known.end(), chosen) - known.begin();
        return commands[static_cast<std::size_t>(at)]();
    } catch (const std::exception& thrown) {
        fmt::print(stderr, "kinoscope: {}\n", thrown.what());
        return kExitFailed;
    }
}
