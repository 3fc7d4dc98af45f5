#include "apps/bench/table.h"

#include <gmock/gmock.h>

#include <limits>

#include "apps/bench/machine.h"
#include "apps/bench/plot.h"
#include "tests/support/temp_dir.h"

namespace kino::bench {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

BenchContext small_bench() {
    BenchContext bench("raster", false);
    bench.add(
        {.case_name = "orbit",
         .knob = "path",
         .level = "splat",
         .error = 0.25,
         .metric = "share",
         .baseline = "points"},
        Comparison({{.name = "splat", .ms = {2, 2, 2}}, {.name = "points", .ms = {20, 21, 19}}}));
    bench.add({.case_name = "a \"b\", c", .knob = "path", .level = "x|y"});
    return bench;
}

TEST(Csv, HasTheAgreedColumns) {
    EXPECT_EQ(csv_header(),
              "bench,case,knob,level,ms_median,ms_p95,error,metric,baseline,speedup\n");
}

TEST(Csv, QuotesFieldsAndLeavesUnmeasuredNumbersEmpty) {
    EXPECT_EQ(csv_lines(small_bench()),
              "raster,orbit,path,splat,2.00000,2.00000,0.250000,share,points,10.00\n"
              "raster,\"a \"\"b\"\", c\",path,x|y,,,,,,\n");
}

TEST(NumberText, KeepsSignificantDigits) {
    EXPECT_EQ(number_text(12.3456, 3), "12.3");
    EXPECT_EQ(number_text(1234.56, 3), "1235");
    EXPECT_EQ(number_text(0.00123456, 3), "0.00123");
    EXPECT_EQ(number_text(9.999, 3), "10.00");
    EXPECT_EQ(number_text(0), "0");
    EXPECT_EQ(number_text(-1.5, 2), "-1.5");
    EXPECT_EQ(number_text(1.5e-7, 2), "1.5e-07");
    EXPECT_EQ(number_text(std::numeric_limits<double>::infinity()), "inf");
    EXPECT_EQ(number_text(kNotMeasured), "");
}

TEST(Page, SaysWhatWhereAndHow) {
    BenchContext bench = small_bench();
    bench.note("one thread");
    bench.claim("at least 10x", false);
    bench.set_device("llvmpipe");
    const auto page = markdown_page(bench, {.description = "drawing",
                                            .machine = "some processor, 2 cores",
                                            .command = "kinoscope-bench raster",
                                            .with_plot = true});
    EXPECT_THAT(
        page, HasSubstr("| orbit | path | splat | 2.00 | 2.00 | 0.250 | share | points | 10.0 |"));
    EXPECT_THAT(page, HasSubstr("x\\|y"));
    EXPECT_THAT(page, HasSubstr("- **does not hold**: at least 10x"));
    EXPECT_THAT(page, HasSubstr("- one thread"));
    EXPECT_THAT(page, HasSubstr("some processor, 2 cores"));
    EXPECT_THAT(page, HasSubstr("llvmpipe"));
    EXPECT_THAT(page, HasSubstr("`kinoscope-bench raster`"));
    EXPECT_THAT(page, HasSubstr("raster.svg"));
    EXPECT_THAT(markdown_page(bench, {}), Not(HasSubstr("raster.svg")));
}

TEST(BenchContext, QuickRepeatsLessButEnough) {
    const BenchContext quick("a", true);
    const BenchContext full("a", false);
    EXPECT_EQ(full.repeats({.repeats = 100}).repeats, 100);
    EXPECT_EQ(quick.repeats({.repeats = 100}).repeats, 20);
    EXPECT_EQ(quick.repeats({.repeats = 10}).repeats, 5);
}

TEST(Machine, IsDescribedInOneLine) {
    const auto text = describe_machine();
    EXPECT_THAT(text, HasSubstr(" cores"));
    EXPECT_THAT(text, Not(HasSubstr("\n")));
}

TEST(Plot, NamedLevelsAreMarksNumericOnesLines) {
    EXPECT_THAT(gnuplot_program(small_bench(), "a.svg"), HasSubstr("with points"));
    BenchContext sweep("filters", false);
    for (const char* level : {"1", "2", "4"}) {
        sweep.add({.case_name = "desk",
                   .knob = "iterations",
                   .level = level,
                   .ms_median = 1,
                   .error = 0.5,
                   .metric = "mm RMS"});
    }
    EXPECT_THAT(gnuplot_program(sweep, "a.svg"), HasSubstr("with linespoints"));
}

TEST(Plot, WithoutErrorsItIsBarsAndWithoutTimesNothing) {
    BenchContext bench("a", false);
    bench.add({.case_name = "c", .knob = "k", .level = "l"});
    EXPECT_THAT(gnuplot_program(bench, "a.svg"), IsEmpty());
    EXPECT_FALSE(write_plot(bench, "a.svg"));
    bench.add({.case_name = "c", .knob = "k", .level = "l", .ms_median = 3});
    EXPECT_THAT(gnuplot_program(bench, "a.svg"), HasSubstr("boxxyerror"));
}

TEST(Plot, GnuplotDrawsEveryKind) {
    if (std::system("command -v gnuplot >/dev/null 2>&1") != 0) GTEST_SKIP() << "no gnuplot";
    const test::TempDir dir;
    BenchContext bench = small_bench();
    bench.add({.case_name = "zero \"quoted\"",
               .knob = "k",
               .level = "with_under",
               .ms_median = 3,
               .error = 0,
               .metric = "px"});
    bench.add({.case_name = "zero",
               .knob = "k",
               .level = "2",
               .ms_median = 3,
               .error = 1,
               .metric = "m"});
    const auto drawn = write_plot(bench, dir / "a b.svg");
    ASSERT_TRUE(drawn) << drawn.error().to_string();
    const std::string svg = test::read_bytes(dir / "a b.svg");
    EXPECT_THAT(svg, HasSubstr("</svg>"));
    EXPECT_THAT(svg, HasSubstr("with_under"));

    BenchContext bars("bars", false);
    bars.add({.case_name = "c", .knob = "k", .level = "l", .ms_median = 3});
    const auto bars_drawn = write_plot(bars, dir / "bars.svg");
    ASSERT_TRUE(bars_drawn) << bars_drawn.error().to_string();
    EXPECT_THAT(test::read_bytes(dir / "bars.svg"), HasSubstr("</svg>"));
}

TEST(Plot, AFolderThatIsNotThereIsAnError) {
    const test::TempDir dir;
    EXPECT_FALSE(write_plot(small_bench(), dir / "missing/a.svg"));
}

TEST(WriteText, MakesFoldersAndLeavesNoPart) {
    const test::TempDir dir;
    ASSERT_TRUE(write_text(dir / "a/b.txt", "text"));
    ASSERT_TRUE(write_text(dir / "a/b.txt", "other"));
    EXPECT_EQ(test::read_bytes(dir / "a/b.txt"), "other");
    EXPECT_FALSE(std::filesystem::exists(dir / "a/b.txt.part"));
    EXPECT_FALSE(write_text(dir / "a/b.txt/c", "under a file"));
}

}  // namespace
}  // namespace kino::bench
