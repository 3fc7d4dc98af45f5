#include "apps/bench/page_svg.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string_view>
#include <utility>
#include <vector>

#include "apps/bench/page_text.h"

namespace kino::bench {
namespace {

constexpr double kPlotWidth = 440, kPlotHeight = 260;
constexpr double kLeft = 74, kRight = 14, kTop = 12, kBottom = 42;
constexpr std::size_t kSeries = 8;
/// With more points than this only the front's and the default's levels are written beside them.
constexpr std::size_t kMostLabels = 10;
constexpr std::size_t kMostLabelled = 24;
/// Values further apart than this need a logarithmic axis.
constexpr double kLogBeyond = 12;
/// As many letters as the height has room for.
constexpr std::size_t kAxisLetters = 36;

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

    [[nodiscard]] bool logarithmic() const { return log_; }
    /// With as many decimals as tell it from the next tick.
    [[nodiscard]] std::string label(double tick) const {
        const double decimals = log_ ? 0 : -std::floor(std::log10(step_) + 1e-9);
        if (decimals < 1 || decimals > 6 || std::abs(tick) >= 1e6) return short_number(tick);
        return fmt::format("{:.{}f}", tick, static_cast<int>(decimals));
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
            x.at(tick), kTop, bottom, bottom + 14, x.label(tick));
    }
    for (const double tick : y.ticks()) {
        text += fmt::format(
            "<path class=\"g\" d=\"M{1} {0:.1f}H{2}\"/><text x=\"{3}\" "
            "y=\"{4:.1f}\" text-anchor=\"end\">{5}</text>",
            y.at(tick), kLeft, right, kLeft - 6, y.at(tick) + 3.5, y.label(tick));
    }
    text += fmt::format("<path class=\"a\" d=\"M{} {}V{}H{}\"/>", kLeft, kTop, bottom, right);
    const auto scale = [](const PlotAxis& axis) { return axis.logarithmic() ? ", log scale" : ""; };
    text +=
        fmt::format("<text class=\"n\" x=\"{:.1f}\" y=\"{}\" text-anchor=\"middle\">{}{}</text>",
                    (kLeft + right) / 2, kPlotHeight - 6,
                    plot.against_time ? "time, ms (median)"
                                      : escape_html(plot.price.empty() ? plot.knob : plot.price),
                    scale(x));
    std::string metric = plot.metric;
    if (metric.size() > kAxisLetters) {
        // Of a letter of several bytes all go.
        std::size_t cut = kAxisLetters - 1;
        while (cut > 0 && (static_cast<unsigned char>(metric[cut]) & 0xC0) == 0x80) --cut;
        metric = metric.substr(0, cut) + "...";
    }
    text += fmt::format(
        "<text class=\"n\" text-anchor=\"middle\" transform=\"translate(14 {:.1f}) rotate(-90)\">"
        "{}{}</text>",
        (kTop + bottom) / 2, escape_html(metric), scale(y));
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

/// A line a level, a mark a case; error goes across.
std::string svg_of_named(const PagePlot& plot) {
    constexpr double kRow = 30, kEdge = 12;
    constexpr std::size_t kMostRows = 30;
    std::vector<std::string> levels;
    std::vector<double> values;
    for (const PlotPoint& point : plot.points) {
        values.push_back(point.y);
        if (std::find(levels.begin(), levels.end(), point.level) == levels.end()) {
            levels.push_back(point.level);
        }
    }
    if (levels.size() > kMostRows) levels.resize(kMostRows);
    const PlotAxis x(values, kEdge + 8, kPlotWidth - kEdge - 8);
    const double bottom = kRow * static_cast<double>(levels.size()) + 4;
    std::string text = fmt::format(
        "<svg viewBox=\"0 0 {} {:.0f}\" role=\"img\" aria-label=\"{}\">", kPlotWidth, bottom + 36,
        escape_html(fmt::format("{} of {} levels of {}; numbers are in the table below the plots",
                                plot.metric, levels.size(), plot.knob)));
    for (const double tick : x.ticks()) {
        text += fmt::format(
            "<path class=\"g\" d=\"M{0:.1f} 0V{1:.1f}\"/><text x=\"{0:.1f}\" y=\"{2:.1f}\" "
            "text-anchor=\"middle\">{3}</text>",
            x.at(tick), bottom, bottom + 14, x.label(tick));
    }
    text += fmt::format(
        "<path class=\"a\" d=\"M{} {}H{}\"/><text class=\"n\" x=\"{}\" y=\"{}\" "
        "text-anchor=\"middle\">{}{}</text>",
        kEdge, bottom, kPlotWidth - kEdge, kPlotWidth / 2, bottom + 30, escape_html(plot.metric),
        x.logarithmic() ? ", log scale" : "");
    const std::vector<std::string> cases = cases_of(plot);
    for (const PlotPoint& point : plot.points) {
        const auto row = std::find(levels.begin(), levels.end(), point.level) - levels.begin();
        if (row == static_cast<std::ptrdiff_t>(levels.size())) continue;
        const auto series = static_cast<std::size_t>(
            std::find(cases.begin(), cases.end(), point.case_name) - cases.begin());
        const double py = kRow * static_cast<double>(row) + 22, px = x.at(point.y);
        text += fmt::format(
            "<g><title>{}</title>{}{}</g>",
            escape_html(
                fmt::format("{}, {}: {}", point.level, point.case_name, short_number(point.y))),
            mark(series, px, py, 4, true),
            point.is_default
                ? fmt::format("<circle class=\"d\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"8\"/>", px, py)
                : "");
    }
    for (std::size_t i = 0; i < levels.size(); ++i) {
        text += fmt::format("<text class=\"t\" x=\"{}\" y=\"{:.1f}\">{}</text>", kEdge,
                            kRow * static_cast<double>(i) + 11, escape_html(levels[i]));
    }
    return text + "</svg>";
}

}  // namespace

std::string series_mark(std::size_t series) {
    return "<svg viewBox=\"0 0 14 14\" aria-hidden=\"true\">" + mark(series, 7, 7, 4, true) +
           "</svg>";
}

std::string sample_mark(bool filled, bool ring) {
    return fmt::format("<svg class=\"i\" viewBox=\"0 0 20 20\" aria-hidden=\"true\">{}{}</svg>",
                       mark(0, 10, 10, filled ? 4 : 3, filled),
                       ring ? "<circle class=\"d\" cx=\"10\" cy=\"10\" r=\"8\"/>" : "");
}

std::string svg_of(const PagePlot& plot) {
    if (plot.named) return plot.points.empty() ? "" : svg_of_named(plot);
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
        escape_html(fmt::format("{} against {} at {} points, knob {}; numbers are in the table "
                                "below the plots",
                                plot.metric, plot.against_time ? "time" : plot.knob,
                                plot.points.size(), plot.knob)));
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
            plot.against_time    ? short_number(point->x) + " ms"
            : plot.price.empty() ? point->level
                                 : plot.price + " " + short_number(point->x),
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
        // Beside it above or below, right or left; what the default is called is always said.
        struct Place {
            double dx, dy;
        };
        const std::array<Place, 4> places = {{{8, -4}, {-8, -4}, {8, 12}, {-8, 12}}};
        const Place* found = nullptr;
        for (const Place& place : places) {
            const double lx = place.dx > 0 ? px + 8 : px - 8 - width;
            if (lx < kLeft - 30 || lx + width > kPlotWidth + 4) continue;
            if (py + place.dy > kPlotHeight - kBottom + 8) continue;
            if (!room.take(lx, py + place.dy, width)) continue;
            found = &place;
            break;
        }
        if (found == nullptr && !point->is_default) continue;
        const Place at =
            found != nullptr ? *found : Place{px + width + 10 > kPlotWidth ? -8.0 : 8.0, -4};
        labels += fmt::format(
            "<text class=\"{}\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>",
            point->is_default ? "t b" : "t", px + (point->is_default ? 1.3 : 1.0) * at.dx,
            py + at.dy, at.dx > 0 ? "start" : "end", escape_html(point->level));
    }
    return text + labels + "</svg>";
}

}  // namespace kino::bench
