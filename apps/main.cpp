#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <string>
#include <vector>

#include "apps/commands.h"
#include "apps/exit_codes.h"
#include "apps/nearest_word.h"
#include "apps/tell_error.h"

namespace kino {
namespace {

/// CLI11 says only that a command is wanted. Empty: the word is one, or none was given.
std::string wrong_command(const CLI::App& app, int argc, char** argv) {
    const std::string word = argc > 1 ? argv[1] : "";
    std::vector<std::string> known;
    for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
        known.push_back(command->get_name());
    }
    const bool is_known = std::find(known.begin(), known.end(), word) != known.end();
    if (word.empty() || word.front() == '-' || is_known) return {};
    const std::string meant = nearest_word(word, known);
    return fmt::format("there is no command \"{}\" ({}`kinoscope --help` lists them)", word,
                       meant.empty() ? "" : fmt::format("did you mean \"{}\"? ", meant));
}

/// At the end of every command's help.
void add_exit_codes(CLI::App& app) {
    for (CLI::App* command : app.get_subcommands([](CLI::App*) { return true; })) {
        const std::string footer = command->get_footer();
        if (footer.find(kExitCodesText) != std::string::npos) continue;
        command->footer(fmt::format("{}\n\n{}", footer.substr(0, footer.find_last_not_of('\n') + 1),
                                    kExitCodesText));
    }
}

/// Of a command that is done: output that could not be written is a failure.
int with_output_written(int code) {
    if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return code;
    // Who closed a pipe has seen enough.
    if (errno != EPIPE) {
        tell_error({std::strerror(errno), "standard output", {}});
    }
    return code == kExitDone ? kExitFailed : code;
}

}  // namespace
}  // namespace kino

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
    add_exit_codes(app);
    if (const std::string wrong = wrong_command(app, argc, argv); !wrong.empty()) {
        tell_error({wrong, {}, {}});
        return kExitUsage;
    }
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
        return with_output_written(commands[static_cast<std::size_t>(at)]());
    } catch (const std::exception& thrown) {
        fmt::print(stderr, "kinoscope: {}\n", thrown.what());
        return kExitFailed;
    }
}
