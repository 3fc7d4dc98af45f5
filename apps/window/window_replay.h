#pragma once

#include <optional>

#include "apps/replay_options.h"

namespace kino {

/// Plays in a window until it is closed, or options.frames pictures of recorded frames were shown.
/// Returns an ExitCode. Empty: no window can be opened here, which was told on standard error.
[[nodiscard]] std::optional<int> replay_in_window(const ReplayOptions& options);

}  // namespace kino
