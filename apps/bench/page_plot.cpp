#include "apps/bench/page_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "apps/bench/page_defaults.h"
#include "apps/bench/page_text.h"

namespace kino::bench {
namespace {

/// Times of a knob's levels that differ by less than this are the same but for noise.
constexpr double kSameTime = 1.25;

/// Noise of equal times would draw a tangle: then error against the knob says more.
void turn_to_knob(PagePlot& plot) {
    std::map<std::string, std::pair<double, double>> ranges;
    double least = plot.points.front().x, most = least;
    for (const PlotPoint& point : plot.points) {
        if (!number_of(point.level) || !(point.x > 0)) return;
        auto& [low, high] = ranges.try_emplace(point.case_name, point.x, point.x).first->second;
        low = std::min(low, point.x);
        high = std::max(high, point.x);
        if (high > kSameTime * low) return;
        least = std::min(least, point.x);
        most = std::max(most, point.x);
    }
    if (ranges.size() == plot.points.size()) return;
    plot.against_time = false;
    plot.same_time = fmt::format("{} to {} ms", short_number(least), short_number(most));
    for (PlotPoint& point : plot.points) point.x = *number_of(point.level);
}

struct Price {
    std::string_view bench, knob, metric;
};
/// Smooth joints are paid for with lag, not with time.
constexpr std::array kPrices = {
    Price{"joint-filters", "preset", "lag, ms"},
    Price{"joint-filters", "times the default", "lag, ms"},
    Price{"skeleton", "filter", "ms lag of a swiping hand at 2 m"},
};

std::string_view price_of(std::string_view bench, std::string_view knob) {
    for (const Price& price : kPrices) {
        if (price.bench == bench && price.knob == knob) return price.metric;
    }
    return {};
}

double paid_by(std::span<const BenchRow> rows, const BenchRow& of, std::string_view metric) {
    for (const BenchRow& row : rows) {
        if (row.case_name == of.case_name && row.knob == of.knob && row.level == of.level &&
            row.metric == metric) {
            return row.error;
        }
    }
    return kNotMeasured;
}

}  // namespace

bool higher_is_better(std::string_view metric) {
    const auto has = [&](std::string_view word) {
        return metric.find(word) != std::string_view::npos;
    };
    return has("PSNR") || has("SSIM") || metric.starts_with("ratio") || has("share within") ||
           metric.ends_with("/s");
}

void mark_front(PagePlot& plot) {
    const double sign = plot.higher_is_better ? -1 : 1;
    for (PlotPoint& a : plot.points) {
        a.on_front = std::none_of(plot.points.begin(), plot.points.end(), [&](const PlotPoint& b) {
            const double worse = sign * (b.y - a.y);
            return b.case_name == a.case_name && b.x <= a.x && worse <= 0 &&
                   (b.x < a.x || worse < 0);
        });
    }
}

std::vector<PagePlot> plots_of(std::string_view bench, std::span<const BenchRow> rows) {
    std::vector<PagePlot> plots;
    for (const BenchRow& row : rows) {
        if (!std::isfinite(row.error)) continue;
        const bool timed = std::isfinite(row.ms_median);
        const auto level = number_of(row.level);
        const std::string_view price = timed ? "" : price_of(bench, row.knob);
        if (!price.empty() && row.metric == price) continue;
        const double paid = price.empty() ? kNotMeasured : paid_by(rows, row, price);
        const bool named = !timed && !level && price.empty();
        const auto same = std::find_if(plots.begin(), plots.end(), [&](const PagePlot& plot) {
            return plot.knob == row.knob && plot.metric == row.metric && plot.against_time == timed;
        });
        PagePlot& plot =
            same != plots.end()
                ? *same
                : plots.emplace_back(PagePlot{.knob = row.knob,
                                              .metric = row.metric,
                                              .against_time = timed,
                                              .higher_is_better = higher_is_better(row.metric),
                                              .points = {},
                                              .price = std::string(price)});
        plot.named = plot.named || named;
        plot.points.push_back(
            // A case a level: they are one series.
            {.case_name = row.case_name == row.level ? row.knob : row.case_name,
             .level = row.level,
             .x = timed                 ? row.ms_median
                  : std::isfinite(paid) ? paid
                                        : level.value_or(0),
             .y = row.error,
             .is_default = is_default_level(bench, row.knob, row.level, row.case_name)});
    }
    // One point alone compares nothing.
    std::erase_if(plots, [](const PagePlot& plot) { return plot.points.size() < 2; });
    for (PagePlot& plot : plots) {
        if (plot.against_time) turn_to_knob(plot);
        if (plot.against_time || !plot.price.empty()) mark_front(plot);
    }
    return plots;
}

}  // namespace kino::bench
