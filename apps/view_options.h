#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "apps/replay_options.h"

namespace CLI {
class App;
}

namespace kino {

/// What `replay` and `live` have in common: how things are drawn, and where to.
void add_view_options(CLI::App& app, const std::shared_ptr<ReplayOptions>& options);
void add_codec_option(CLI::App& app, SessionCodec& codec);
/// Where bodies come from, and what is made of them.
void add_body_options(CLI::App& app, BodyOptions& bodies);
/// --gestures.
void add_gestures_option(CLI::App& app, BodyOptions& bodies);
/// --scene: `take` gets what names a scene, bundled or a file. `about`: the beginning of its help.
void add_scene_option(CLI::App& app, std::string about,
                      std::function<void(const std::string&)> take);
/// --target-ms.
void add_target_option(CLI::App& app, std::function<void(double)> take, std::string about);
/// --size and --device.
void add_picture_options(CLI::App& app, std::function<void(int width, int height)> take_size,
                         std::string& device);
/// --headless, --frames, --pictures, --json and --verbose.
struct OutputOptions {
    std::filesystem::path& headless;
    std::optional<std::int64_t>& frames;
    int& pictures;
    bool& json;
    bool& verbose;
};
struct OutputWords {
    std::string headless, frames, pictures, verbose;  ///< help
};
void add_output_options(CLI::App& app, const OutputOptions& options, const OutputWords& words);
/// How bodies are found: a part of add_body_options().
void add_tracking_options(CLI::App& app, BodyOptions& bodies);
/// Filters and keys, for the end of a help text.
[[nodiscard]] std::string view_footer();

/// Plays options.uris in a window, or into options.headless; into "out" where there is no display.
/// Returns an ExitCode. Sources are registered already.
[[nodiscard]] int run_view(const ReplayOptions& options);

}  // namespace kino
