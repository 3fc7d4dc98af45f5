#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace kino::test {

struct ProgramResult {
    int exit_code = -1;  ///< 128 + signal where one ended it
    std::string out;
    std::string err;
};

struct ProgramCall {
    std::vector<std::string> arguments;
    /// "NAME=value" sets, "NAME" alone unsets.
    std::vector<std::string> environment;
    std::filesystem::path folder;                 ///< working directory; empty: this one
    std::vector<std::string> wrapper;             ///< in front of the program: "xvfb-run", "-a"
    int interrupt_when_exists_signal = 0;         ///< with the next: signal to send ...
    std::filesystem::path interrupt_when_exists;  ///< ... once this file is there
};

/// Runs the real kinoscope and waits for its end.
[[nodiscard]] ProgramResult run_program(const ProgramCall& call);

/// With nothing but arguments.
[[nodiscard]] inline ProgramResult run(std::vector<std::string> arguments) {
    return run_program({.arguments = std::move(arguments)});
}

/// A recording of the source tree, absolute: "office".
[[nodiscard]] std::string bundled(const std::string& name);

/// Writes a recording of `frames` frames, 32x24 pixels, with colour, and returns its folder.
std::filesystem::path write_tiny_recording(const std::filesystem::path& folder, int frames);

}  // namespace kino::test
