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

/// A picture of `metric` against time (or, where rows have no times, against the knob).
struct PagePlot {
    std::string knob;
    std::string metric;
    bool against_time = true;
    bool higher_is_better = false;
    std::vector<PlotPoint> points;
};

/// The plots of one table: one for every knob and metric whose rows have a time and an error, then
/// those of knobs that are numbers without times. `defaults`: see page_defaults.h.
[[nodiscard]] std::vector<PagePlot> plots_of(std::string_view bench,
                                             std::span<const BenchRow> rows);

/// True for metrics of which more is better: decibels, ratios, shares of what was found.
[[nodiscard]] bool higher_is_better(std::string_view metric);

/// Marks the points that no other point of the same case dominates.
void mark_front(PagePlot& plot);

/// The plot as an <svg> element for a page: colours are the classes s0 .. s7 and currentColor, so
/// the page's style decides. Ids are not used.
[[nodiscard]] std::string svg_of(const PagePlot& plot);

/// The mark of a plot's n-th case, for a key.
[[nodiscard]] std::string series_mark(std::size_t series);

/// Text for HTML and attributes.
[[nodiscard]] std::string escape_html(std::string_view text);

}  // namespace kino::bench
