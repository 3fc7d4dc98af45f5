#include "apps/bench/plot.h"

#include <fmt/format.h>
#include <sys/wait.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <map>
#include <vector>

namespace kino::bench {

namespace {

using Rows = std::vector<const BenchRow*>;

std::string gnuplot_string(std::string_view text) {
    std::string out = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') out += '\\';
        out += c == '\n' ? ' ' : c;
    }
    return out + '"';
}

bool is_number(std::string_view text) {
    double value = 0;
    const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
    return code == std::errc{} && end == text.data() + text.size();
}

void append_unique(std::vector<std::string>& list, const std::string& text) {
    if (std::find(list.begin(), list.end(), text) == list.end()) list.push_back(text);
}

int index_of(const std::vector<std::string>& list, const std::string& text) {
    return static_cast<int>(std::find(list.begin(), list.end(), text) - list.begin());
}

std::string data_block(const std::string& name, const Rows& rows) {
    std::string text = fmt::format("${} << EOD\n", name);
    for (const BenchRow* row : rows) {
        text += fmt::format("{} {} {}\n", row->ms_median, row->error, gnuplot_string(row->level));
    }
    return text + "EOD\n";
}

/// Logarithmic where every value allows it; always with room around, also around a single value.
std::string axis(char name, const Rows& rows, double BenchRow::*member) {
    double low = rows.front()->*member;
    double high = low;
    for (const BenchRow* row : rows) {
        low = std::min(low, row->*member);
        high = std::max(high, row->*member);
    }
    if (low > 0) {
        return fmt::format("set logscale {0}\nset {0}range [{1}:{2}]\n", name, low / 1.5,
                           high * 1.5);
    }
    const double room = high > low ? 0.1 * (high - low) : 1;
    return fmt::format("unset logscale {0}\nset {0}range [{1}:{2}]\n", name, low - room,
                       high + room);
}

std::string error_panel(const std::string& metric, const Rows& rows, int panel) {
    std::vector<std::string> cases;
    std::vector<std::string> levels;
    for (const BenchRow* row : rows) {
        append_unique(cases, row->case_name);
        append_unique(levels, row->level);
    }
    const bool swept = std::all_of(rows.begin(), rows.end(),
                                   [](const BenchRow* row) { return is_number(row->level); });
    std::string text = axis('x', rows, &BenchRow::ms_median) + axis('y', rows, &BenchRow::error) +
                       fmt::format("set ylabel {}\n", gnuplot_string(metric));
    std::string plots;
    const auto add_plot = [&](const std::string& block, const std::string& style) {
        plots += fmt::format("{}${} using 1:2 {}", plots.empty() ? "plot " : ", \\\n     ", block,
                             style);
    };
    if (swept) {
        for (std::size_t i = 0; i < cases.size(); ++i) {
            Rows series;
            std::copy_if(rows.begin(), rows.end(), std::back_inserter(series),
                         [&](const BenchRow* row) { return row->case_name == cases[i]; });
            const std::string block = fmt::format("p{}_{}", panel, i);
            text += data_block(block, series);
            add_plot(block, fmt::format("with linespoints lw 2 pt 7 ps 0.6 lc {} title {}", i + 1,
                                        gnuplot_string(cases[i])));
            plots +=
                fmt::format(", \\\n     ${} using 1:2:3 with labels offset 0.7,0.7 notitle", block);
        }
    } else {
        for (std::size_t i = 0; i < rows.size(); ++i) {
            const std::string block = fmt::format("p{}_{}", panel, i);
            text += data_block(block, {rows[i]});
            add_plot(block,
                     fmt::format("with points ps 1 lw 2 pt {} lc {} title {}",
                                 2 * index_of(cases, rows[i]->case_name) + 5,
                                 index_of(levels, rows[i]->level) + 1,
                                 gnuplot_string(rows[i]->level + ", " + rows[i]->case_name)));
        }
    }
    return text + plots + "\n";
}

/// Rows that have no time of their own: error against the knob, a line a case.
std::string knob_panel(const Rows& rows, int panel) {
    std::vector<std::string> cases;
    for (const BenchRow* row : rows) append_unique(cases, row->case_name);
    std::string text = fmt::format(
        "unset logscale xy\nset xrange [*:*]\nset yrange [0:*]\nset xlabel {}\nset ylabel {}\n",
        gnuplot_string(rows.front()->knob), gnuplot_string(rows.front()->metric));
    std::string plots;
    for (std::size_t i = 0; i < cases.size(); ++i) {
        const std::string block = fmt::format("k{}_{}", panel, i);
        text += fmt::format("${} << EOD\n", block);
        for (const BenchRow* row : rows) {
            if (row->case_name == cases[i]) text += fmt::format("{} {}\n", row->level, row->error);
        }
        text += "EOD\n";
        plots += fmt::format("{}${} using 1:2 with linespoints lw 2 pt 7 ps 0.6 lc {} title {}",
                             plots.empty() ? "plot " : ", \\\n     ", block, i + 1,
                             gnuplot_string(cases[i]));
    }
    return text + plots + "\n";
}

std::string time_bars(const Rows& rows) {
    std::string text =
        "set style fill solid 0.7\nset boxwidth 0.7\nset xrange [0:*]\n$bars << EOD\n";
    std::string ticks;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        text += fmt::format("{} {}\n", rows[i]->ms_median, i);
        ticks += fmt::format("{}{} {}", ticks.empty() ? "" : ", ",
                             gnuplot_string(rows[i]->level + ", " + rows[i]->case_name), i);
    }
    return text +
           fmt::format("EOD\nset ytics ({})\nset yrange [{}:-0.5]\n", ticks,
                       static_cast<double>(rows.size()) - 0.5) +
           "plot $bars using ($1/2):2:($1/2):(0.35) with boxxyerror notitle\n";
}

std::string missed_words(const BenchContext& bench) {
    const auto missed = std::count_if(bench.claims().begin(), bench.claims().end(),
                                      [](const auto& claim) { return !claim.holds; });
    if (missed == 0) return {};
    return fmt::format(" ({} of {} claims do not hold)", missed, bench.claims().size());
}

}  // namespace

std::string gnuplot_program(const BenchContext& bench, const std::filesystem::path& svg) {
    std::vector<std::string> metrics;
    std::map<std::string, Rows> panels;
    Rows timed;
    std::vector<std::string> knob_metrics;
    std::map<std::string, Rows> knob_panels;
    for (const BenchRow& row : bench.rows()) {
        if (!std::isfinite(row.ms_median)) {
            if (!std::isfinite(row.error) || !is_number(row.level)) continue;
            append_unique(knob_metrics, row.metric);
            knob_panels[row.metric].push_back(&row);
            continue;
        }
        timed.push_back(&row);
        if (!std::isfinite(row.error)) continue;
        append_unique(metrics, row.metric);
        panels[row.metric].push_back(&row);
    }
    // A page without any time is of errors alone.
    if (timed.empty() && knob_metrics.empty()) return {};
    if (timed.empty()) {
        std::string text = fmt::format(
            "set terminal svg size 1000,{} font 'sans-serif,12' background '#ffffff' noenhanced\n"
            "set output {}\nset grid\nset key outside right top noenhanced\n"
            "set multiplot layout {},1 title {} noenhanced\n",
            std::min<std::size_t>(300 * knob_metrics.size(), 2400), gnuplot_string(svg.string()),
            knob_metrics.size(), gnuplot_string(bench.name() + missed_words(bench)));
        for (std::size_t i = 0; i < knob_metrics.size(); ++i) {
            text += knob_panel(knob_panels[knob_metrics[i]], static_cast<int>(i));
        }
        return text + "unset multiplot\n";
    }

    const std::size_t count = std::max<std::size_t>(metrics.size(), 1);
    const std::size_t height =
        metrics.empty() ? 120 + 22 * timed.size() : std::min<std::size_t>(360 * count, 2400);
    std::string text = fmt::format(
        "set terminal svg size 1000,{} font 'sans-serif,12' background '#ffffff' noenhanced\n"
        "set output {}\nset grid\nset key outside right top noenhanced\n"
        "set xlabel 'ms, median'\nset multiplot layout {},1 title {} noenhanced\n",
        height, gnuplot_string(svg.string()), count,
        gnuplot_string(bench.name() + ": error against time" + missed_words(bench)));
    if (metrics.empty()) {
        text += time_bars(timed);
    } else {
        for (std::size_t i = 0; i < metrics.size(); ++i) {
            text += error_panel(metrics[i], panels[metrics[i]], static_cast<int>(i));
        }
    }
    return text + "unset multiplot\n";
}

Result<void> write_plot(const BenchContext& bench, const std::filesystem::path& svg) {
    const std::string program = gnuplot_program(bench, svg);
    if (program.empty()) return fail("no row has a time, so there is nothing to plot", svg);
    if (std::system("command -v gnuplot >/dev/null 2>&1") != 0) {
        return fail("gnuplot is not installed, so there is no plot", svg,
                    "apt-get install gnuplot-nox, or leave out --docs");
    }
    FILE* gnuplot = popen("gnuplot - >/dev/null", "w");
    if (gnuplot == nullptr) return fail("cannot start gnuplot", svg);
    const bool written = std::fwrite(program.data(), 1, program.size(), gnuplot) == program.size();
    const int status = pclose(gnuplot);
    if (!written || !WIFEXITED(status) || WEXITSTATUS(status) != 0) {
        return fail("gnuplot refused the plot", svg, "its words are above");
    }
    return {};
}

}  // namespace kino::bench
