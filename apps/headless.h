#pragma once

#include "apps/replay_options.h"
#include "base/error.h"

namespace kino {

/// Plays every source stepped, without a window, into options.headless: pictures
/// (frame-00000.png ...; in a folder a source where there are several), video.mp4 of all, and
/// summary.json. Two runs give the same pictures and the same "deterministic" part of the summary.
/// Returns an ExitCode; errors were told on standard error.
[[nodiscard]] int replay_headless(const ReplayOptions& options);

}  // namespace kino
