#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/pipeline/body_stage.h"
#include "base/error.h"
#include "viz/frame/renderer.h"

namespace kino {

/// What `kinoscope demo` was asked for.
struct ShowOptions {
    std::string uri;          ///< empty: the first sensor, else the bundled performance
    std::string calibration;  ///< as find_calibration() reads it
    BodyOptions bodies{.mode = BodyMode::on};
    std::vector<std::string> scenes;  ///< in the order of swiping; empty: those that suit
    std::string avatar = "none";      ///< as open_avatar() reads it
    std::optional<bool> live_body;    ///< empty: unless there is an avatar
    [[nodiscard]] bool shows_body() const { return live_body.value_or(avatar == "none"); }
    bool mirror = true;
    std::optional<double> lod;  ///< fixed resizing of the light; empty: full, or as time asks for
    double target_ms = 1000.0 / 30;
    std::filesystem::path headless;  ///< empty: a window
    std::optional<std::int64_t> frames;
    int width = 1280, height = 720;
    int pictures = 12;  ///< most PNGs; 0: none, -1: every frame
    std::string device;
    bool json = false;
    bool verbose = false;
};

/// What the demo asks of the program it is in.
struct ShowHelp {
    std::function<bool()> interrupted;
    std::function<Result<std::string>()> find_device;  ///< URI of the first there is
    bool validation = false;                           ///< Vulkan calls are checked
};

/// The performance that is played where no sensor is: the bundled recording, looked for in the
/// working folder, beside the program's build or installation; else the same, computed.
[[nodiscard]] std::string performance_uri();

/// Both return an ExitCode; errors were told on standard error. Empty: no window could be opened.
[[nodiscard]] std::optional<int> show_in_window(const ShowOptions& options, const ShowHelp& help);
[[nodiscard]] int show_headless(const ShowOptions& options, const ShowHelp& help);

/// Keys of the window, a line each, for --help.
[[nodiscard]] std::string show_keys_text();

}  // namespace kino
