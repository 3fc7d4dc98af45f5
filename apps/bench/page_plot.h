#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "apps/bench/bench.h"

namespace kino::bench {

/// One point of a plot on the page.
struct PlotPoint {
    std::string case_name;
    std::string level;
    double x = 0, y = 0;
    bool on_front = false;    ///< no other of its case is better in one and not worse in the other
    bool is_default = false;  ///< what the program does if not asked
};

/// A picture of `metric` against time; against the knob where rows have no times, or where the knob
/// is a number and all its levels take the same time but for noise.
struct PagePlot {
    std::string knob;
    std::string metric;
    bool against_time = true;
    bool higher_is_better = false;
    std::vector<PlotPoint> points;
    std::string same_time{};  ///< "1.27 to 1.3 ms", where the knob does not change the time
    std::string price{};      ///< what is paid instead of time and goes across, e.g. "lag, ms"
    bool named = false;       ///< levels are words without times or price: a line of marks a level
};

/// The plots of one table: one for every knob and metric whose rows have a time and an error, then
/// those of knobs without times: against what else is paid, against the knob, or by level.
[[nodiscard]] std::vector<PagePlot> plots_of(std::string_view bench,
                                             std::span<const BenchRow> rows);

/// True for metrics of which more is better: decibels, ratios, shares of what was found.
[[nodiscard]] bool higher_is_better(std::string_view metric);

/// Marks the points that no other point of the same case dominates.
void mark_front(PagePlot& plot);

}  // namespace kino::bench
