#pragma once

#include <filesystem>
#include <string>

#include "apps/bench/bench.h"
#include "base/error.h"

namespace kino::bench {

/// A gnuplot program that draws the entry into `svg`: error against time, one panel a metric. A
/// numeric knob gives a line per case, a named one a mark per row, coloured by level. Without any
/// error it is bars of the times. Where no row has a time, it is the error of rows with a numeric
/// knob against that knob; empty without those.
[[nodiscard]] std::string gnuplot_program(const BenchContext& bench,
                                          const std::filesystem::path& svg);

/// Runs gnuplot on it. Fails with a hint where gnuplot is not installed.
[[nodiscard]] Result<void> write_plot(const BenchContext& bench, const std::filesystem::path& svg);

}  // namespace kino::bench
