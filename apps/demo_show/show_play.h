#pragma once

#include "apps/demo/demo_play.h"
#include "apps/demo_show/show_options.h"
#include "apps/pipeline/opened_source.h"

namespace kino {

/// The play that the options ask for, its avatar opened.
[[nodiscard]] Result<DemoPlay> make_play(const ShowOptions& options);

/// How a source is opened for the demo: in a loop, bodies found in its depth.
[[nodiscard]] PlayOptions show_play_options(const ShowOptions& options, LoopMode loop);

}  // namespace kino
