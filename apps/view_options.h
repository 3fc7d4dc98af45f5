#pragma once

#include <memory>
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
/// How bodies are found: a part of add_body_options().
void add_tracking_options(CLI::App& app, BodyOptions& bodies);
/// Filters and keys, for the end of a help text.
[[nodiscard]] std::string view_footer();

/// Plays options.uris in a window, or into options.headless; into "out" where there is no display.
/// Returns an ExitCode. Sources are registered already.
[[nodiscard]] int run_view(const ReplayOptions& options);

}  // namespace kino
