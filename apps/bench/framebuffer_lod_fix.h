#pragma once

#include "apps/bench/bench.h"
#include "viz/gpu/device.h"

namespace kino::bench {

/// Thin wires before a wall, resized: what listing and shading doubtful pixels costs and mends,
/// by the limit of confidence and by the cap.
void bench_lod_fixes(BenchContext& context, gpu::Device& device);

}  // namespace kino::bench
