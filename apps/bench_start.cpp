#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

#include "apps/commands.h"
#include "apps/exit_codes.h"

namespace kino {
namespace {

int start_bench(std::vector<std::string> arguments) {
    std::error_code error;
    const std::filesystem::path own = std::filesystem::read_symlink("/proc/self/exe", error);
    const std::filesystem::path program = own.parent_path() / "kinoscope-bench";
    if (error || !std::filesystem::exists(program, error)) {
        fmt::print(stderr,
                   "kinoscope: {} is not there (it is built with the tests: cmake --preset "
                   "release)\n",
                   program.string());
        return kExitFailed;
    }
    std::string name = program.string();
    std::vector<char*> argv = {name.data()};
    for (std::string& argument : arguments) argv.push_back(argument.data());
    argv.push_back(nullptr);
    execv(name.c_str(), argv.data());
    fmt::print(stderr, "kinoscope: {} could not be started: {}\n", name, std::strerror(errno));
    return kExitFailed;
}

}  // namespace

Command add_bench(CLI::App& parent) {
    CLI::App& app =
        *parent.add_subcommand("bench", "measures speed and accuracy (kinoscope-bench)");
    // Everything behind "bench", --help too, is the other program's.
    app.prefix_command();
    app.set_help_flag();
    return [&app] { return start_bench(app.remaining()); };
}

}  // namespace kino
