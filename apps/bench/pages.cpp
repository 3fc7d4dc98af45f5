#include "apps/bench/pages.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <sstream>

#include "apps/bench/csv_read.h"
#include "apps/bench/page_plot.h"
#include "apps/bench/page_style.h"
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

std::string figure(const PagePlot& plot) {
    const char* direction = plot.higher_is_better ? "more is better" : "less is better";
    return fmt::format(
        "<figure><figcaption><b>{}</b><br>{} <span class=\"q\">({})</span></figcaption>{}{}"
        "</figure>\n",
        escape_html(plot.knob), escape_html(plot.metric), direction, svg_of(plot), key_of(plot));
}

std::string section(const PageEntry& entry) {
    const std::string stem = escape_html(entry.stem);
    std::string text = fmt::format("<section id=\"{0}\">\n<h2>{0}</h2>\n<p>{1}</p>\n", stem,
                                   escape_html(entry.description));
    text += fmt::format(
        "<p><a href=\"{0}.md\">Tables, notes and claims</a> · <a href=\"{0}.csv\">CSV</a> · made "
        "by <code>{1}</code></p>\n<p class=\"q\">{2}{3}{4}</p>\n",
        stem, escape_html(entry.command), escape_html(entry.machine),
        entry.device.empty() ? "" : "; ", escape_html(entry.device));
    const std::size_t missed = entry.claims_missed.size();
    if (entry.claims_hold > 0 || missed > 0) {
        text += fmt::format("<p>{} of {} claims hold.</p>\n", entry.claims_hold,
                            static_cast<std::size_t>(entry.claims_hold) + missed);
    }
    if (missed > 0) {
        text += "<details><summary>What does not hold</summary><ul class=\"m\">";
        for (const std::string& claim : entry.claims_missed) {
            text += fmt::format("<li>{}</li>", escape_html(claim));
        }
        text += "</ul></details>\n";
    }
    const std::vector<PagePlot> plots = plots_of(entry.stem, entry.rows);
    std::string figures;
    for (const bool timed : {true, false}) {
        for (const PagePlot& plot : plots) {
            if (plot.against_time == timed) figures += figure(plot);
        }
    }
    if (figures.empty()) {
        text += "<p class=\"q\">No knob of it trades error for time; see the tables.</p>\n";
    } else {
        text += "<div class=\"plots\">\n" + figures + "</div>\n";
    }
    return text + "</section>\n";
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
        "<h1>Kinoscope: error against time</h1>\n",
        kPageStyle);
    text += fmt::format(
        "<p>Every approximation has a knob, a slow reference and a table. Here is what each knob "
        "costs and loses: {} benches; {} of {} claims hold, and those that do not are named.</p>\n"
        "<p>Filled marks are on the front: nothing of the same case is quicker without being "
        "worse. A ring is what the program does if not asked. A mark says its numbers when "
        "pointed at.</p>\n",
        entries.size(), hold, hold + missed);
    for (const auto& [machine, count] : machines) {
        text += fmt::format("<p class=\"q\">{} of the tables: {}</p>\n", count,
                            escape_html(machine.empty() ? "machine not named" : machine));
    }
    text +=
        "<p class=\"q\">Measured anew by <code>kinoscope bench --all</code>; this page alone, "
        "from the committed tables, by <code>kinoscope bench --pages</code>.</p>\n<nav>";
    for (const PageEntry& entry : entries) {
        text += fmt::format("<a href=\"#{0}\">{0}</a>", escape_html(entry.stem));
    }
    text += "</nav>\n";
    for (const PageEntry& entry : entries) text += section(entry);
    return text + "</body>\n</html>\n";
}

Result<void> write_pages(const fs::path& folder) {
    KINO_ASSIGN(const auto entries, read_page_entries(folder));
    if (entries.empty()) return fail("holds no tables", folder.string(), "run a bench with --docs");
    return write_text(folder / "index.html", accuracy_page(entries));
}

}  // namespace kino::bench
