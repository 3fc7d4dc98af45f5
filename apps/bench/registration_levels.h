#pragma once

#include "apps/bench/bench.h"

namespace kino {

/// The part of bench_registration() that turns knobs: which colour pixels a reading covers, and how
/// dense the table of rays is.
void bench_registration_levels(BenchContext& context);

}  // namespace kino
