#include "apps/bench/page_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>

#include "apps/bench/page_defaults.h"
#include "apps/bench/table.h"

namespace kino::bench {
namespace {

constexpr double kPlotWidth = 440, kPlotHeight = 260;
constexpr double kLeft = 58, kRight = 14, kTop = 12, kBottom = 42;
constexpr std::size_t kSeries = 8;
/// With more points than this only the front's and the default's levels are written beside them.
constexpr std::size_t kMostLabels = 10;
constexpr std::size_t kMostLabelled = 24;
/// Values further apart than this need a logarithmic axis.
constexpr double kLogBeyond = 12;

std::optional<double> number_of(std::string_view text) {
    double value = 0;
    const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (code != std::errc{} || end != text.data() + text.size()) return std::nullopt;
    return value;
}

std::string short_number(double value) {
    if (value == 0) return "0";
    if (std::abs(value) >= 1000 && std::abs(value) < 1e6) return fmt::format("{:.0f}", value);
    return fmt::format("{:.3g}", value);
}

/// Where values lie along one side of a plot.
class PlotAxis {
  public:
    PlotAxis(std::vector<double> values, double from, double to) : from_(from), to_(to) {
        std::sort(values.begin(), values.end());
        least_ = values.front();
        most_ = values.back();
        log_ = least_ > 0 && most_ / least_ > kLogBeyond;
        if (log_) {
            least_ /= 1.15;
            most_ *= 1.15;
            return;
        }
        // From zero, unless that would squeeze all into a corner.
        const double room = most_ - least_;
        if (least_ > 0 && room > 0.2 * most_) least_ = 0;
        const double pad = room > 0 ? 0.06 * room : std::max(0.5 * std::abs(most_), 1e-9);
        most_ += pad;
        if (least_ != 0) least_ -= pad;
        step_ = nice_step((most_ - least_) / 4);
    }

    [[nodiscard]] double at(double value) const {
        const double t = log_ ? std::log(value / least_) / std::log(most_ / least_)
                              : (value - least_) / (most_ - least_);
        return from_ + t * (to_ - from_);
    }
    [[nodiscard]] std::vector<double> ticks() const {
        std::vector<double> ticks;
        if (!log_) {
            for (double v = std::ceil(least_ / step_) * step_; v <= most_; v += step_) {
                ticks.push_back(std::abs(v) < 1e-9 * step_ ? 0 : v);
            }
            return ticks;
        }
        const bool few = most_ / least_ > 1e4;
        for (double decade = std::pow(10, std::floor(std::log10(least_))); decade <= most_;
             decade *= 10) {
            for (const double m : {1.0, 2.0, 5.0}) {
                if (few && m != 1) continue;
                if (decade * m >= least_ && decade * m <= most_) ticks.push_back(decade * m);
            }
        }
        return ticks;
    }

  private:
    static double nice_step(double rough) {
        const double decade = std::pow(10, std::floor(std::log10(rough)));
        for (const double m : {1.0, 2.0, 5.0}) {
            if (decade * m >= rough) return decade * m;
        }
        return decade * 10;
    }
    double from_, to_;
    double least_ = 0, most_ = 1, step_ = 1;
    bool log_ = false;
};

std::vector<std::string> cases_of(const PagePlot& plot) {
    std::vector<std::string> cases;
    for (const PlotPoint& point : plot.points) {
        if (std::find(cases.begin(), cases.end(), point.case_name) == cases.end()) {
            cases.push_back(point.case_name);
        }
    }
    return cases;
}

/// A mark of a series: colours repeat after eight, shapes after four.
std::string mark(std::size_t series, double x, double y, double r, bool filled) {
    const std::string style = fmt::format("class=\"s{}{}\"", series % kSeries, filled ? " f" : "");
    switch ((series / kSeries + series) % 4) {
        case 0:
            return fmt::format("<circle {} cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:.1f}\"/>", style, x, y,
                               r);
        case 1:
            return fmt::format(
                "<rect {} x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\"/>", style,
                x - 0.9 * r, y - 0.9 * r, 1.8 * r, 1.8 * r);
        case 2:
            return fmt::format("<path {} d=\"M{:.1f} {:.1f}l{:.1f} {:.1f}h{:.1f}z\"/>", style, x,
                               y - 1.2 * r, 1.15 * r, 2.1 * r, -2.3 * r);
        default:
            return fmt::format(
                "<path {} d=\"M{:.1f} {:.1f}l{:.1f} {:.1f}l{:.1f} {:.1f}l{:.1f} "
                "{:.1f}z\"/>",
                style, x, y - 1.3 * r, 1.3 * r, 1.3 * r, -1.3 * r, 1.3 * r, -1.3 * r, -1.3 * r);
    }
}

std::string axes_of(const PagePlot& plot, const PlotAxis& x, const PlotAxis& y) {
    const double bottom = kPlotHeight - kBottom, right = kPlotWidth - kRight;
    std::string text;
    for (const double tick : x.ticks()) {
        text += fmt::format(
            "<path class=\"g\" d=\"M{0:.1f} {1}V{2}\"/><text x=\"{0:.1f}\" "
            "y=\"{3}\" text-anchor=\"middle\">{4}</text>",
            x.at(tick), kTop, bottom, bottom + 14, short_number(tick));
    }
    for (const double tick : y.ticks()) {
        text += fmt::format(
            "<path class=\"g\" d=\"M{1} {0:.1f}H{2}\"/><text x=\"{3}\" "
            "y=\"{4:.1f}\" text-anchor=\"end\">{5}</text>",
            y.at(tick), kLeft, right, kLeft - 6, y.at(tick) + 3.5, short_number(tick));
    }
    text += fmt::format("<path class=\"a\" d=\"M{} {}V{}H{}\"/>", kLeft, kTop, bottom, right);
    text += fmt::format("<text class=\"n\" x=\"{:.1f}\" y=\"{}\" text-anchor=\"middle\">{}</text>",
                        (kLeft + right) / 2, kPlotHeight - 6,
                        plot.against_time ? "ms, median" : escape_html(plot.knob));
    return text;
}

/// Lines through the points of a numeric knob, in its order.
std::string lines_of(const PagePlot& plot, const std::vector<std::string>& cases, const PlotAxis& x,
                     const PlotAxis& y) {
    const bool numeric =
        std::all_of(plot.points.begin(), plot.points.end(),
                    [](const PlotPoint& point) { return number_of(point.level).has_value(); });
    if (!numeric) return {};
    std::string text;
    for (std::size_t i = 0; i < cases.size(); ++i) {
        std::map<double, const PlotPoint*> in_order;
        for (const PlotPoint& point : plot.points) {
            if (point.case_name == cases[i]) in_order[*number_of(point.level)] = &point;
        }
        if (in_order.size() < 2) continue;
        std::string path;
        for (const auto& [level, point] : in_order) {
            path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? "M" : "L", x.at(point->x),
                                y.at(point->y));
        }
        text += fmt::format("<path class=\"l s{}\" d=\"{}\"/>", i % kSeries, path);
    }
    return text;
}

/// Labels that would lie on one another are left out; points say their names on their own.
class LabelRoom {
  public:
    bool take(double x, double y, double width) {
        for (const auto& box : taken_) {
            if (x < box[0] + box[2] && box[0] < x + width && std::abs(y - box[1]) < 11) {
                return false;
            }
        }
        taken_.push_back({x, y, width});
        return true;
    }

  private:
    std::vector<std::array<double, 3>> taken_;
};

}  // namespace

std::string escape_html(std::string_view text) {
    std::string out;
    for (const char c : text) {
        switch (c) {
            case '&':
                out += "&amp;";
                break;
            case '<':
                out += "&lt;";
                break;
            case '>':
                out += "&gt;";
                break;
            case '"':
                out += "&quot;";
                break;
            case '\'':
                out += "&#39;";
                break;
            default:
                out += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
        }
    }
    return out;
}

std::string series_mark(std::size_t series) {
    return "<svg viewBox=\"0 0 14 14\" aria-hidden=\"true\">" + mark(series, 7, 7, 4, true) +
           "</svg>";
}

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
        if (!timed && !level) continue;
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
                                              .points = {}});
        plot.points.push_back(
            {.case_name = row.case_name,
             .level = row.level,
             .x = timed ? row.ms_median : *level,
             .y = row.error,
             .is_default = is_default_level(bench, row.knob, row.level, row.case_name)});
    }
    // One point alone compares nothing.
    std::erase_if(plots, [](const PagePlot& plot) { return plot.points.size() < 2; });
    for (PagePlot& plot : plots) {
        if (plot.against_time) mark_front(plot);
    }
    return plots;
}

std::string svg_of(const PagePlot& plot) {
    std::vector<double> xs, ys;
    for (const PlotPoint& point : plot.points) {
        xs.push_back(point.x);
        ys.push_back(point.y);
    }
    if (xs.empty()) return {};
    const PlotAxis x(xs, kLeft + 4, kPlotWidth - kRight - 4);
    const PlotAxis y(ys, kPlotHeight - kBottom - 4, kTop + 4);
    const std::vector<std::string> cases = cases_of(plot);
    std::string text = fmt::format(
        "<svg viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\">", kPlotWidth, kPlotHeight,
        escape_html(fmt::format("{} against {}, {}", plot.metric,
                                plot.against_time ? "time" : plot.knob, plot.knob)));
    text += axes_of(plot, x, y) + lines_of(plot, cases, x, y);
    std::string labels;
    LabelRoom room;
    for (const PlotPoint& point : plot.points) (void)room.take(x.at(point.x) - 4, y.at(point.y), 8);
    // Defaults first: their labels find room before others.
    std::vector<const PlotPoint*> order;
    for (const PlotPoint& point : plot.points) order.push_back(&point);
    std::stable_sort(order.begin(), order.end(), [](const PlotPoint* a, const PlotPoint* b) {
        return std::pair(a->is_default, a->on_front) > std::pair(b->is_default, b->on_front);
    });
    for (const PlotPoint* point : order) {
        const auto series = static_cast<std::size_t>(
            std::find(cases.begin(), cases.end(), point->case_name) - cases.begin());
        const double px = x.at(point->x), py = y.at(point->y);
        const std::string name = fmt::format(
            "{}, {}: {} at {}{}{}", point->level, point->case_name, short_number(point->y),
            plot.against_time ? short_number(point->x) + " ms" : point->level,
            point->on_front ? ", on the front" : "", point->is_default ? ", default" : "");
        text += fmt::format("<g><title>{}</title>{}{}</g>", escape_html(name),
                            mark(series, px, py, point->on_front ? 4 : 3, point->on_front),
                            point->is_default
                                ? fmt::format("<circle class=\"d\" cx=\"{:.1f}\" cy=\"{:.1f}\" "
                                              "r=\"8\"/>",
                                              px, py)
                                : "");
        const bool all = plot.points.size() <= kMostLabels;
        const bool some = plot.points.size() <= kMostLabelled;
        if (!all && !point->is_default && !(some && point->on_front)) continue;
        const double width = 5.6 * static_cast<double>(point->level.size()) + 6;
        const bool to_left = px + width + 10 > kPlotWidth;
        const double lx = to_left ? px - 8 - width : px + 8;
        if (lx < kLeft - 30 || !room.take(lx, py - 4, width)) continue;
        labels += fmt::format(
            "<text class=\"{}\" x=\"{:.1f}\" y=\"{:.1f}\" "
            "text-anchor=\"{}\">{}</text>",
            point->is_default ? "t b" : "t", to_left ? px - 8 : px + 8, py - 4,
            to_left ? "end" : "start", escape_html(point->level));
    }
    return text + labels + "</svg>";
}

}  // namespace kino::bench
