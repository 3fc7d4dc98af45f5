#pragma once

#include <span>
#include <string>
#include <string_view>

#include "apps/bench/pages.h"

namespace kino::bench {

/// What trades accuracy for time in the program, or seems to.
struct Knob {
    std::string_view area;
    std::string_view name;      ///< what it is, for a reader
    std::string_view where;     ///< the option, key or field that turns it, as code
    std::string_view standard;  ///< its value if nobody turns it
    std::string_view bench{};   ///< stem of the table with its curve
    std::string_view column{};  ///< `knob` in that table
    /// What else is to be said; of a knob without a curve, why it has none.
    std::string_view remark{};
};
/// All of them, by area. A new knob belongs here, and its curve into a bench.
[[nodiscard]] std::span<const Knob> knobs();

/// Knobs of tables that are no knobs of the program: rivals, findings, parts of a result.
[[nodiscard]] bool is_finding(std::string_view bench, std::string_view column);

/// The HTML id of the first plot of a knob, "filters-spatial-radius-px".
[[nodiscard]] std::string plot_id(std::string_view bench, std::string_view column);

/// True if the entry's table has rows with an error for the knob.
[[nodiscard]] bool has_curve(std::span<const PageEntry> entries, std::string_view bench,
                             std::string_view column);

/// docs/accuracy/README.md: the table of knobs, where each one's curve is, and the claims that do
/// not hold.
[[nodiscard]] std::string knobs_page(std::span<const PageEntry> entries);

}  // namespace kino::bench
