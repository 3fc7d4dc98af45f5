#pragma once

#include "apps/bench/bench.h"
#include "viz/gpu/device.h"

namespace kino {

/// Part of `bench forward-plus`: what four samples a pixel cost and gain.
void bench_forward_samples(BenchContext& context, gpu::Device& device);

}  // namespace kino
