#pragma once

#include "apps/bench/bench.h"

namespace kino {

/// A head before a window, replayed: how far what is shown is from where it should be, from no
/// prediction to the depth warp.
void bench_zoom_heads(BenchContext& context);

}  // namespace kino
