#pragma once

#include "apps/bench/bench.h"
#include "viz/frame/renderer.h"

namespace kino {

/// Who chooses the zoom, on real frames: a heavy object that comes and goes, a load that stays,
/// and loads that no zoom helps, with fixed zooms beside them.
void bench_zoom_choosers(BenchContext& context, Renderer& renderer);

}  // namespace kino
