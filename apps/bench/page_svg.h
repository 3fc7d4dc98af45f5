#pragma once

#include <cstddef>
#include <string>

#include "apps/bench/page_plot.h"

namespace kino::bench {

/// The plot as an <svg> element for a page: colours are the classes s0 .. s7 and currentColor, so
/// the page's style decides. Ids are not used.
[[nodiscard]] std::string svg_of(const PagePlot& plot);

/// The mark of a plot's n-th case, for a key.
[[nodiscard]] std::string series_mark(std::size_t series);
/// A mark as plots have it, for an explanation.
[[nodiscard]] std::string sample_mark(bool filled, bool ring);

}  // namespace kino::bench
