#include "apps/bench/pages.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "apps/bench/csv_read.h"
#include "apps/bench/page_defaults.h"
#include "apps/bench/page_plot.h"
#include "apps/bench/page_svg.h"
#include "apps/bench/run_all.h"
#include "apps/bench/table.h"
#include "tests/support/random.h"
#include "tests/support/temp_dir.h"

namespace kino::bench {
namespace {

using testing::HasSubstr;
using testing::Not;

std::string read_all(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return std::string((std::istreambuf_iterator<char>(file)), {});
}

/// Every element that is opened is closed, in order; attributes are quoted. Not a validator: what
/// a broken escape breaks first.
void expect_balanced(const std::string& html) {
    static const std::set<std::string> kEmpty = {"meta", "br", "link"};
    std::vector<std::string> open;
    for (std::size_t at = html.find('<'); at != std::string::npos; at = html.find('<', at + 1)) {
        if (html.compare(at, 2, "<!") == 0) continue;
        std::size_t end = at;
        bool quoted = false;
        while (++end < html.size() && (quoted || html[end] != '>')) {
            if (html[end] == '"') quoted = !quoted;
            ASSERT_TRUE(quoted || html[end] != '<') << html.substr(at, 80);
        }
        ASSERT_LT(end, html.size());
        const bool closes = html[at + 1] == '/';
        std::size_t name_end = at + (closes ? 2 : 1);
        const std::size_t name_at = name_end;
        while (std::isalnum(static_cast<unsigned char>(html[name_end])) != 0) ++name_end;
        const std::string name = html.substr(name_at, name_end - name_at);
        ASSERT_FALSE(name.empty()) << html.substr(at, 80);
        if (closes) {
            ASSERT_FALSE(open.empty());
            ASSERT_EQ(open.back(), name) << html.substr(at > 80 ? at - 80 : 0, 160);
            open.pop_back();
        } else if (html[end - 1] != '/' && kEmpty.count(name) == 0) {
            open.push_back(name);
        }
    }
    EXPECT_THAT(open, testing::IsEmpty());
}

BenchRow row(std::string case_name, std::string level, double ms, double error,
             std::string metric = "mm RMS") {
    return {.case_name = std::move(case_name),
            .knob = "knob",
            .level = std::move(level),
            .ms_median = ms,
            .error = error,
            .metric = std::move(metric)};
}

TEST(CsvRead, ReadsBackWhatIsWritten) {
    BenchContext bench("some", false);
    bench.add(row("a, \"quoted\"\ncase", "1", 1.5, 0.25));
    bench.add({.case_name = "b", .knob = "k", .level = "x", .baseline = "y", .speedup = 2});
    const auto rows = read_csv(std::string(csv_header()) + csv_lines(bench));
    ASSERT_TRUE(rows) << rows.error().to_string();
    ASSERT_EQ(rows->size(), 2u);
    EXPECT_EQ((*rows)[0].case_name, "a, \"quoted\"\ncase");
    EXPECT_EQ((*rows)[0].ms_median, 1.5);
    EXPECT_EQ((*rows)[0].error, 0.25);
    EXPECT_TRUE(std::isnan((*rows)[1].ms_median));
    EXPECT_EQ((*rows)[1].speedup, 2);
    EXPECT_EQ((*rows)[1].baseline, "y");
}

TEST(CsvRead, RefusesWhatIsNoTable) {
    const std::string header(csv_header());
    EXPECT_FALSE(read_csv(""));
    EXPECT_FALSE(read_csv("a,b\n1,2\n"));
    EXPECT_FALSE(read_csv(header + "a,b,c\n"));
    EXPECT_FALSE(read_csv(header + "a,b,c,d,much,,,,,\n"));
    EXPECT_FALSE(read_csv(header + "a,b,c,d,1x,,,,,\n"));
    EXPECT_TRUE(read_csv(header));
    // Whatever is broken, it is refused or read, and nothing else happens.
    BenchContext bench("some", false);
    for (int i = 0; i < 5; ++i) bench.add(row("case, \"x\"", "level", i, 2 * i));
    const std::string good = header + csv_lines(bench);
    test::Random random(12);
    for (int round = 0; round < 500; ++round) {
        std::string bad = good;
        for (int i = random.integer(1, 4); i > 0; --i) {
            bad[static_cast<std::size_t>(random.integer(0, static_cast<int>(bad.size()) - 1))] =
                static_cast<char>(random.integer(0, 255));
        }
        (void)read_csv(bad);
    }
}

TEST(PagePlot, TheFrontIsWhatNothingElseBeats) {
    test::Random random(13);
    for (int round = 0; round < 200; ++round) {
        PagePlot plot{.higher_is_better = random.chance(0.5)};
        for (int i = random.integer(1, 20); i > 0; --i) {
            plot.points.push_back({.case_name = random.chance(0.5) ? "a" : "b",
                                   .x = random.integer(0, 6) * 1.0,
                                   .y = random.integer(0, 6) * 1.0});
        }
        mark_front(plot);
        for (const PlotPoint& a : plot.points) {
            bool beaten = false;
            for (const PlotPoint& b : plot.points) {
                const bool better = plot.higher_is_better ? b.y > a.y : b.y < a.y;
                const bool same = b.y == a.y;
                beaten = beaten || (b.case_name == a.case_name &&
                                    ((b.x < a.x && (better || same)) || (b.x == a.x && better)));
            }
            EXPECT_EQ(a.on_front, !beaten);
        }
    }
}

TEST(PagePlot, MakesOnePlotForEveryKnobAndMetric) {
    const std::vector<BenchRow> rows = {row("a", "1", 1, 2),
                                        row("a", "2", 2, 1),
                                        row("a", "1", 1, 30, "dB PSNR"),
                                        row("a", "2", 2, 40, "dB PSNR"),
                                        row("a", "1", 3, kNotMeasured, "nothing"),
                                        row("a", "1", kNotMeasured, 1, "untimed"),
                                        row("a", "2", kNotMeasured, 2, "untimed"),
                                        row("a", "word", kNotMeasured, 2, "untimed words"),
                                        row("a", "1", 1, 1, "alone")};
    const auto plots = plots_of("some", rows);
    ASSERT_EQ(plots.size(), 3u);
    EXPECT_EQ(plots[0].metric, "mm RMS");
    EXPECT_FALSE(plots[0].higher_is_better);
    EXPECT_TRUE(plots[1].higher_is_better);
    EXPECT_TRUE(plots[1].points[1].on_front);
    EXPECT_FALSE(plots[2].against_time);
    EXPECT_EQ(plots[2].points[1].x, 2);
}

TEST(PagePlot, DrawsHardValues) {
    const double hard[] = {0, -1, 1e-12, 1e12, 1, 1};
    for (const double a : hard) {
        for (const double b : hard) {
            PagePlot plot{
                .knob = "k", .metric = "m", .points = {{"c", "1", a, b}, {"c", "2", b, a}}};
            mark_front(plot);
            const std::string svg = svg_of(plot);
            EXPECT_THAT(svg, Not(HasSubstr("nan")));
            EXPECT_THAT(svg, Not(HasSubstr("inf")));
            EXPECT_LT(svg.size(), 20000u);
            expect_balanced(svg);
        }
    }
    EXPECT_EQ(svg_of({}), "");
}

TEST(Pages, EscapeWhatTablesSay) {
    const std::string evil = "<b>&\"'</b><script>alert(1)</script>";
    PageEntry entry{.stem = evil,
                    .description = evil,
                    .machine = evil,
                    .device = evil,
                    .command = evil,
                    .claims_missed = {evil}};
    entry.rows = {row(evil, evil, 1, 2, evil), row(evil, evil + "2", 2, 1, evil)};
    for (BenchRow& r : entry.rows) r.knob = evil;
    const std::string page = accuracy_page(std::vector<PageEntry>{entry});
    EXPECT_THAT(page, Not(HasSubstr("<script")));
    EXPECT_THAT(page, Not(HasSubstr("<b>&\"")));
    EXPECT_THAT(page, HasSubstr("&lt;script&gt;"));
    expect_balanced(page);
}

TEST(Pages, StandAloneAndHaveEveryCommittedTable) {
    const auto entries = read_page_entries("docs/accuracy");
    ASSERT_TRUE(entries) << entries.error().to_string();
    const std::string page = accuracy_page(*entries);
    expect_balanced(page);
    // One file, nothing from elsewhere, nothing that runs.
    const std::string committed = read_all("docs/accuracy/index.html");
    EXPECT_GT(committed.size(), 100000u);
    expect_balanced(committed);
    for (const char* word : {"<script", "http:", "https:", "//", "<img", "url(", "@import"}) {
        EXPECT_EQ(page.find(word), std::string::npos) << word;
        EXPECT_EQ(committed.find(word), std::string::npos) << word;
    }
    std::size_t tables = 0;
    for (const auto& file : std::filesystem::directory_iterator("docs/accuracy")) {
        if (file.path().extension() != ".csv") continue;
        if (!read_all(file.path()).starts_with(csv_header())) continue;
        ++tables;
        const std::string stem = file.path().stem().string();
        EXPECT_NE(page.find("<h2>" + stem + "</h2>"), std::string::npos) << stem << " is missing";
        EXPECT_NE(page.find("href=\"" + stem + ".md\""), std::string::npos);
    }
    EXPECT_GE(tables, 13u);
    EXPECT_EQ(tables, entries->size());
    // What it links to is there.
    const std::regex link("href=\"([^\"#]+)\"");
    for (std::sregex_iterator it(page.begin(), page.end(), link), end; it != end; ++it) {
        EXPECT_TRUE(std::filesystem::exists("docs/accuracy/" + (*it)[1].str())) << (*it)[1].str();
    }
    for (const PageEntry& entry : *entries) {
        EXPECT_FALSE(entry.description.empty()) << entry.stem;
        EXPECT_FALSE(entry.machine.empty()) << entry.stem;
        EXPECT_THAT(entry.command, HasSubstr("kinoscope-bench")) << entry.stem;
    }
}

TEST(Pages, DefaultsAreLevelsOfTheTables) {
    const auto entries = read_page_entries("docs/accuracy");
    ASSERT_TRUE(entries);
    for (const DefaultLevel& wanted : default_levels()) {
        const auto entry = std::find_if(entries->begin(), entries->end(),
                                        [&](const PageEntry& e) { return e.stem == wanted.bench; });
        // A bench that was not run for the committed tables yet.
        if (entry == entries->end()) continue;
        EXPECT_TRUE(std::any_of(entry->rows.begin(), entry->rows.end(),
                                [&](const BenchRow& r) {
                                    return is_default_level(wanted.bench, r.knob, r.level,
                                                            r.case_name) &&
                                           r.knob == wanted.knob && r.level == wanted.level;
                                }))
            << wanted.bench << ": " << wanted.knob << " = " << wanted.level;
    }
}

TEST(Pages, MissingAndBrokenTablesAreSaid) {
    const test::TempDir temp;
    EXPECT_FALSE(write_pages(temp.path() / "nowhere"));
    EXPECT_FALSE(write_pages(temp.path())) << "no tables";
    temp.write("raster.csv", std::string(csv_header()) + "raster,a,k,l,1,,2,m,,\n");
    EXPECT_FALSE(write_pages(temp.path())) << "no page";
    temp.write("raster.md", "# raster\n\nwhat it is.\n\n- holds: a\n- **does not hold**: b > c\n");
    temp.write("unrelated.csv", "joint,head\n1,2\n");
    ASSERT_TRUE(write_pages(temp.path()));
    const std::string page = read_all(temp.path() / "index.html");
    EXPECT_THAT(page, HasSubstr("1 of 2 claims hold"));
    EXPECT_THAT(page, HasSubstr("b &gt; c"));
    EXPECT_THAT(page, Not(HasSubstr("unrelated")));
    temp.write("raster.csv", std::string(csv_header()) + "raster,a,k\n");
    EXPECT_FALSE(write_pages(temp.path()));
}

TEST(RunAll, OneThatFailsDoesNotStopTheOthers) {
    // A program that does as its first argument says, in place of a bench.
    const test::TempDir temp;
    const auto script =
        temp.write("bench",
                   "#!/bin/sh\n[ \"$1\" = bad ] && exit 3\n[ \"$1\" = dead ] && kill -6 $$\n"
                   "printf '%s' '" +
                       std::string(csv_header()) +
                       "' > \"$3\"\nprintf '%s,c,k,l,1,,2,m,,\\n' \"$1\" >> \"$3\"\n"
                       "printf 'holds: a\\nholds: b\\n' > \"$5\"\n"
                       "[ \"$1\" = two ] && echo 'missed: 5 > 3' >> \"$5\"\nexit 0\n");
    std::filesystem::permissions(script, std::filesystem::perms::owner_all);
    const std::vector<std::string_view> names = {"one", "bad", "dead", "two"};
    const AllReport report = run_all(names, {.program = script.string(), .arguments = {}});
    EXPECT_THAT(report.csv, HasSubstr("one,c,k,l,1"));
    EXPECT_THAT(report.csv, HasSubstr("two,c,k,l,1"));
    ASSERT_EQ(report.outcomes.size(), 4u);
    EXPECT_EQ(report.failures(), 2u);
    EXPECT_EQ(report.outcomes[0].failure, "");
    EXPECT_EQ(report.outcomes[0].rows, 1u);
    EXPECT_EQ(report.outcomes[0].claims_hold, 2);
    EXPECT_EQ(report.outcomes[1].failure, "ended with status 3");
    EXPECT_EQ(report.outcomes[1].claims_hold, 0) << "of the one before";
    EXPECT_EQ(report.outcomes[2].failure, "ended by signal 6");
    // What does not hold is told apart from what failed.
    EXPECT_EQ(report.claims_missed(), 1u);
    EXPECT_THAT(report.outcomes[3].claims_missed, testing::ElementsAre("5 > 3"));
    const std::string table = summary_table(report);
    EXPECT_THAT(table, HasSubstr("2 failed:\n  bad: ended with status 3\n  dead: ended by"));
    EXPECT_THAT(table,
                HasSubstr("1 claims do not hold on this machine (no failure):\n  two: 5 > 3"));
    const AllReport late =
        run_all(names, {.program = script.string(), .arguments = {}, .most_minutes = 0});
    EXPECT_EQ(late.failures(), 4u);
    const AllReport gone = run_all(names, {.program = "/nowhere/bench", .arguments = {}});
    EXPECT_EQ(gone.failures(), 4u);
}

}  // namespace
}  // namespace kino::bench
