#pragma once

#include "apps/bench/bench.h"
#include "viz/gpu/device.h"

namespace kino::bench {

/// Depth of a recording, reduced and brought back to full size with its colour picture for a guide,
/// and without.
void bench_guided_depth(BenchContext& context, gpu::Device& device);

}  // namespace kino::bench
