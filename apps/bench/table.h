#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "apps/bench/bench.h"
#include "base/error.h"

namespace kino::bench {

/// The columns of every CSV file that the program writes.
[[nodiscard]] std::string_view csv_header();

/// One line per row of the entry, without the header, each ended by a newline. Fields with commas,
/// quotes or line ends are quoted as RFC 4180 has it; numbers not measured are empty.
[[nodiscard]] std::string csv_lines(const BenchContext& bench);

/// "holds: ..." or "missed: ...", a line a claim.
[[nodiscard]] std::string claim_lines(const BenchContext& bench);

/// The page of an entry: table, claims, notes, machine and command.
struct PageFacts {
    std::string_view description;
    std::string_view machine;
    std::string_view command;
    bool with_plot = false;
    std::string_view page{};  ///< stem of the files, where not the entry's name
};
[[nodiscard]] std::string markdown_page(const BenchContext& bench, const PageFacts& facts);

/// A number with `digits` significant digits, never in exponent form between 1e-4 and 1e6; empty
/// for NaN.
[[nodiscard]] std::string number_text(double value, int digits = 4);

/// Writes through a temporary name beside it, so that a reader never sees half a file.
[[nodiscard]] Result<void> write_text(const std::filesystem::path& path, std::string_view text);

}  // namespace kino::bench
