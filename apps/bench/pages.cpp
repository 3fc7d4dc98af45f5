#include "apps/bench/pages.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <sstream>

#include "apps/bench/csv_read.h"
#include "apps/bench/knobs.h"
#include "apps/bench/page_defaults.h"
#include "apps/bench/page_plot.h"
#include "apps/bench/page_style.h"
#include "apps/bench/page_svg.h"
#include "apps/bench/page_text.h"
#include "apps/bench/table.h"

namespace kino::bench {
namespace {

namespace fs = std::filesystem;

Result<std::string> read_text(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    if (!file) return fail("cannot be read", path.string());
    return std::string((std::istreambuf_iterator<char>(file)), {});
}

/// What markdown_page() wrote.
void read_markdown(const std::string& text, PageEntry& entry) {
    std::istringstream lines(text);
    std::string part;
    for (std::string line; std::getline(lines, line);) {
        if (line.starts_with("#")) {
            part = line;
        } else if (part.starts_with("# ") && entry.description.empty() && !line.empty()) {
            entry.description = line;
        } else if (line.starts_with("- holds:")) {
            ++entry.claims_hold;
        } else if (line.starts_with("- **does not hold**: ")) {
            entry.claims_missed.push_back(line.substr(line.find(": ") + 2));
        } else if (part == "## Machine" && line.starts_with("- ")) {
            const std::string words = line.substr(2);
            if (words.starts_with("made by `")) {
                entry.command = words.substr(9, words.rfind('`') - 9);
            } else if (entry.machine.empty()) {
                entry.machine = words;
            } else if (entry.device.empty() && words.find("medians") == std::string::npos) {
                entry.device = words;
            }
        }
    }
}

/// Where there are several series, which mark is whose.
std::string key_of(const PagePlot& plot) {
    std::vector<std::string> cases;
    for (const PlotPoint& point : plot.points) {
        if (std::find(cases.begin(), cases.end(), point.case_name) == cases.end()) {
            cases.push_back(point.case_name);
        }
    }
    if (cases.size() < 2) return fmt::format("<p class=\"q\">{}</p>", escape_html(cases.front()));
    std::string list;
    for (std::size_t i = 0; i < cases.size(); ++i) {
        list += fmt::format("<li>{}{}</li>", series_mark(i), escape_html(cases[i]));
    }
    return fmt::format("<ul class=\"k\">{}</ul>", list);
}

/// `id`: of the knob's first plot, else empty.
std::string figure(const PagePlot& plot, const std::string& id) {
    const char* direction = plot.higher_is_better ? "more is better" : "less is better";
    std::string about = direction;
    if (plot.against_time) about += ", left is faster";
    if (!plot.price.empty()) about += fmt::format(", {} goes across: left is better", plot.price);
    if (!plot.same_time.empty()) {
        about += fmt::format("; every level takes {}", plot.same_time);
    }
    return fmt::format(
        "<figure{}><figcaption><b>{}</b><br>{} <span class=\"q\">({})</span></figcaption>{}{}"
        "</figure>\n",
        id.empty() ? "" : fmt::format(" id=\"{}\"", escape_html(id)), escape_html(plot.knob),
        escape_html(plot.metric), about, svg_of(plot), key_of(plot));
}

std::string rows_table(const PageEntry& entry) {
    std::string text = fmt::format(
        "<details><summary>All {} rows</summary><div class=\"w\" tabindex=\"0\"><table><thead><tr>"
        "<th>case</th><th>knob</th><th>level</th><th>ms, median</th><th>ms, 95 %</th>"
        "<th>error</th><th>metric</th><th>speedup</th><th>over</th></tr></thead><tbody>\n",
        entry.rows.size());
    for (const BenchRow& row : entry.rows) {
        const bool standard = is_default_level(entry.stem, row.knob, row.level, row.case_name);
        text += fmt::format(
            "<tr{}><td>{}</td><td>{}</td><td>{}{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td>"
            "<td>{}</td><td>{}</td></tr>\n",
            standard ? " class=\"b\"" : "", escape_html(row.case_name), escape_html(row.knob),
            escape_html(row.level), standard ? " (default)" : "", number_text(row.ms_median, 3),
            number_text(row.ms_p95, 3), number_text(row.error, 3), escape_html(row.metric),
            number_text(row.speedup, 3), escape_html(row.baseline));
    }
    return text + "</tbody></table></div></details>\n";
}

std::string capitalized(std::string text) {
    if (!text.empty() && text[0] >= 'a' && text[0] <= 'z')
        text[0] = static_cast<char>(text[0] - 32);
    return text;
}

/// Where what was promised is not kept, before anything else.
std::string missed_box(std::span<const PageEntry> entries, std::size_t missed, std::size_t all) {
    if (missed == 0) return fmt::format("<p>All {} claims hold on this machine.</p>\n", all);
    std::string names, list;
    for (const PageEntry& entry : entries) {
        if (entry.claims_missed.empty()) continue;
        const std::string stem = escape_html(entry.stem);
        names += fmt::format("{0}<a href=\"#{1}\">{1}</a> {2}", names.empty() ? "" : ", ", stem,
                             entry.claims_missed.size());
        for (const std::string& claim : entry.claims_missed) {
            list += fmt::format("<li><a href=\"#{0}\">{0}</a>: {1}</li>", stem, escape_html(claim));
        }
    }
    return fmt::format(
        "<div class=\"x\"><p><b class=\"m\">{} of {} claims do not hold on this machine.</b> "
        "{}.</p>"
        "<details><summary>What does not hold</summary><ul>{}</ul></details></div>\n",
        missed, all, names, list);
}

std::string knob_index(std::span<const PageEntry> entries) {
    std::string text = fmt::format(
        "<details><summary>All {} knobs, their defaults, and where each one's curve is</summary>"
        "<div class=\"w\" tabindex=\"0\"><table><thead><tr><th>knob</th><th>turned by</th>"
        "<th>default</th><th>curve</th></tr></thead><tbody>\n",
        knobs().size());
    std::string_view area;
    for (const Knob& knob : knobs()) {
        if (knob.area != area) {
            area = knob.area;
            text += fmt::format("<tr><th colspan=\"4\" scope=\"rowgroup\">{}</th></tr>\n", area);
        }
        std::string curve;
        if (has_curve(entries, knob.bench, knob.column)) {
            curve = fmt::format("<a href=\"#{}\">{}: {}</a>",
                                escape_html(plot_id(knob.bench, knob.column)), knob.bench,
                                escape_html(knob.column));
        } else if (!knob.bench.empty()) {
            curve = fmt::format("<a href=\"#{0}\">{0}</a>", knob.bench);
        }
        // The remark's links are Markdown; here the plots are at hand.
        if (curve.empty() || knob.remark.find('[') == std::string_view::npos) {
            curve += fmt::format("{}{}", curve.empty() || knob.remark.empty() ? "" : "; ",
                                 escape_html(knob.remark));
        }
        text += fmt::format("<tr><td>{}</td><td><code>{}</code></td><td>{}</td><td>{}</td></tr>\n",
                            escape_html(knob.name), escape_html(knob.where),
                            escape_html(knob.standard), curve);
    }
    return text + "</tbody></table></div></details>\n";
}

/// `machine`: named at the top of the page already.
std::string section(const PageEntry& entry, const std::string& machine) {
    const std::string stem = escape_html(entry.stem);
    std::string text = fmt::format("<section id=\"{0}\">\n<h2>{0}</h2>\n<p>{1}</p>\n", stem,
                                   escape_html(capitalized(entry.description)));
    text += fmt::format(
        "<p><a href=\"{0}.md\">Tables, notes and claims</a> · <a href=\"{0}.csv\">CSV</a> · made "
        "by <code>{1}</code></p>\n",
        stem, escape_html(entry.command));
    std::string where = entry.machine == machine ? "" : entry.machine;
    if (!entry.device.empty()) where += (where.empty() ? "" : "; ") + entry.device;
    if (!where.empty()) text += fmt::format("<p class=\"q\">{}</p>\n", escape_html(where));
    if (entry.command.find("--quick") != std::string::npos) {
        text += "<p class=\"m\">Made with --quick: few repeats, small cases.</p>\n";
    }
    const std::size_t missed = entry.claims_missed.size();
    if (entry.claims_hold > 0 || missed > 0) {
        text += fmt::format("<p>{} of {} claims hold.</p>\n", entry.claims_hold,
                            static_cast<std::size_t>(entry.claims_hold) + missed);
    }
    if (missed > 0) {
        text += "<p class=\"m\">Not so:</p><ul class=\"m\">";
        for (const std::string& claim : entry.claims_missed) {
            text += fmt::format("<li>{}</li>", escape_html(claim));
        }
        text += "</ul>\n";
    }
    const std::vector<PagePlot> plots = plots_of(entry.stem, entry.rows);
    std::string figures;
    std::set<std::string> seen;
    for (const bool timed : {true, false}) {
        for (const PagePlot& plot : plots) {
            // Those whose knob does not change the time stand with those that do.
            const bool first = plot.against_time || !plot.same_time.empty() || !plot.price.empty();
            if (first != timed) continue;
            const std::string id = plot_id(entry.stem, plot.knob);
            figures += figure(plot, seen.insert(id).second ? id : "");
        }
    }
    if (figures.empty()) {
        text += "<p class=\"q\">No knob of it trades error for time; see the tables.</p>\n";
    } else {
        text += "<div class=\"plots\">\n" + figures + "</div>\n";
    }
    return text + rows_table(entry) + "<p class=\"q\"><a href=\"#top\">Up</a></p></section>\n";
}

}  // namespace

Result<std::vector<PageEntry>> read_page_entries(const fs::path& folder) {
    std::vector<PageEntry> entries;
    std::error_code error;
    std::set<fs::path> tables;
    for (const auto& file : fs::directory_iterator(folder, error)) {
        if (file.path().extension() == ".csv") tables.insert(file.path());
    }
    if (error) return fail("cannot be listed: " + error.message(), folder.string());
    for (const fs::path& path : tables) {
        KINO_ASSIGN(const std::string text, read_text(path));
        if (!text.starts_with(csv_header())) continue;
        PageEntry entry{.stem = path.stem().string()};
        auto rows = read_csv(text);
        if (!rows) return fail(rows.error().what, path.string() + ": " + rows.error().where);
        entry.rows = std::move(*rows);
        KINO_ASSIGN(const std::string page, read_text(fs::path(path).replace_extension(".md")));
        read_markdown(page, entry);
        entries.push_back(std::move(entry));
    }
    return entries;
}

std::string accuracy_page(std::span<const PageEntry> entries) {
    std::map<std::string, int> machines;
    std::size_t hold = 0, missed = 0;
    for (const PageEntry& entry : entries) {
        ++machines[entry.machine];
        hold += static_cast<std::size_t>(entry.claims_hold);
        missed += entry.claims_missed.size();
    }
    std::string text = fmt::format(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
        "<title>Kinoscope: error against time</title>\n<style>{}</style>\n</head>\n<body>\n"
        "<h1 id=\"top\">Kinoscope: error against time</h1>\n",
        kPageStyle);
    text += fmt::format(
        "<p>Every approximation has a knob, a slow reference and a table. Here is what each knob "
        "costs and loses, by {} benches.</p>\n",
        entries.size());
    text += missed_box(entries, missed, hold + missed);
    text += fmt::format(
        "<p>How to read a plot: across is the time it takes, up is the error (or, where it says "
        "so, what more of is better). Filled marks {0} are on the front: nothing of the same case "
        "is quicker without being worse. Hollow ones {1} are beaten. A ring {2} is what the "
        "program does if not asked. A mark says its numbers when pointed at; below the plots of a "
        "bench they are all in a table.</p>\n",
        sample_mark(true, false), sample_mark(false, false), sample_mark(true, true));
    for (const auto& [machine, count] : machines) {
        text += fmt::format("<p class=\"q\">{} of the tables: {}</p>\n", count,
                            escape_html(machine.empty() ? "machine not named" : machine));
    }
    text +=
        "<p class=\"q\">Measured anew by <code>kinoscope bench --all</code>; this page alone, "
        "from the committed tables, by <code>kinoscope bench --pages</code>.</p>\n";
    text += knob_index(entries) + "<nav aria-label=\"benches\">";
    for (const PageEntry& entry : entries) {
        text += fmt::format("<a href=\"#{0}\">{0}</a>", escape_html(entry.stem));
    }
    text += "</nav>\n";
    const std::string common = machines.size() == 1 ? machines.begin()->first : "";
    for (const PageEntry& entry : entries) text += section(entry, common);
    return text + "</body>\n</html>\n";
}

Result<void> write_pages(const fs::path& folder) {
    KINO_ASSIGN(const auto entries, read_page_entries(folder));
    if (entries.empty()) return fail("holds no tables", folder.string(), "run a bench with --docs");
    KINO_TRY(write_text(folder / "README.md", knobs_page(entries)));
    return write_text(folder / "index.html", accuracy_page(entries));
}

}  // namespace kino::bench
