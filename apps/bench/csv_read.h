#pragma once

#include <string_view>
#include <vector>

#include "apps/bench/bench.h"

namespace kino::bench {

/// Rows of a table that csv_lines() wrote, with its header. Fails for another header, for rows with
/// another number of fields, and for numbers that are none; empty numbers are kNotMeasured. The
/// bench's name is not in the rows.
[[nodiscard]] Result<std::vector<BenchRow>> read_csv(std::string_view text);

}  // namespace kino::bench
