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

int start_program(const std::string& called, const std::string& hint,
                  std::vector<std::string> arguments) {
    std::error_code error;
    const std::filesystem::path own = std::filesystem::read_symlink("/proc/self/exe", error);
    const std::filesystem::path program = own.parent_path() / called;
    if (error || !std::filesystem::exists(program, error)) {
        fmt::print(stderr, "kinoscope: {} is not there ({})\n", program.string(), hint);
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

Command add_program(CLI::App& parent, const char* name, const char* does, std::string hint) {
    const std::string called = fmt::format("kinoscope-{}", name);
    CLI::App& app = *parent.add_subcommand(name, fmt::format("{} ({})", does, called));
    // Everything behind the name, --help too, is the other program's.
    app.prefix_command();
    app.set_help_flag();
    return [&app, called, hint = std::move(hint)] {
        return start_program(called, hint, app.remaining());
    };
}

}  // namespace

Command add_bench(CLI::App& parent) {
    return add_program(parent, "bench", "measures speed and accuracy",
                       "it is built with the tests: cmake --preset release");
}

Command add_calibrate(CLI::App& parent) {
    return add_program(
        parent, "calibrate", "finds the cameras of a sensor from pictures of a board",
        "it is built where libceres-dev, libopencv-dev and libopencv-contrib-dev are");
}

Command add_train(CLI::App& parent) {
    return add_program(parent, "train", "trains the forest of body parts", "build or install it");
}

}  // namespace kino
