#include "calibration/report/report.h"

#include <gmock/gmock.h>

#include <array>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "calibration/report/report_pictures.h"
#include "tests/calibration/solve/synthetic_boards.h"
#include "tests/support/temp_dir.h"

namespace kino {
namespace {

using testing::HasSubstr;
using testing::Not;

Report sample() {
    const auto scene = test::make_scene(test::typical_rig(), {.views = 8, .seed = 3});
    Shots shots = test::photograph(scene, 0.2, 4);
    shots.names[0] = "<script>alert(1)</script> & \"x\" \xFF";
    CalibrateOptions options;
    options.models = {LensModel::pinhole, LensModel::brown4};
    Report report{"Two cameras", "chess:9x6:35", {"view 9: no board is seen"}, {}, {}};
    report.calibration = calibrate(shots, options).value();
    report.planes = {{1.0, 12, 2.5}, {2.0, 20, 9.0}};
    return report;
}

std::size_t count(const std::string& text, const std::string& part) {
    std::size_t found = 0;
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) {
        ++found;
    }
    return found;
}

TEST(Report, PageHoldsWhatItPromises) {
    const Report report = sample();
    const std::string page = report_html(report);
    EXPECT_THAT(page, testing::StartsWith("<!doctype html>"));
    // RMS by view, two pictures a camera, planes.
    EXPECT_EQ(count(page, "<svg "), 6u);
    EXPECT_EQ(count(page, "<svg "), count(page, "</svg>"));
    const std::size_t corners =
        report.calibration.cameras[0].errors.size() + report.calibration.cameras[1].errors.size();
    EXPECT_EQ(corners, 8u * 54 * 2);
    EXPECT_EQ(count(page, "<circle "), corners + report.planes.size());
    for (const char* part : {"standard deviation", "RMS held out, px", "brown4", "turn x",
                             "infrared", "Depth by distance", "view 9: no board is seen"}) {
        EXPECT_THAT(page, HasSubstr(part));
    }
}

TEST(Report, PageAsksForNothing) {
    const std::string page = report_html(sample());
    for (const char* part : {"http:", "https:", "//", "src=", "href=", "url(", "@import", "<script",
                             "<link", "<iframe", "<object", "onload"}) {
        EXPECT_THAT(page, Not(HasSubstr(part))) << part;
    }
    EXPECT_THAT(page, HasSubstr("default-src 'none'"));
    EXPECT_THAT(
        page, HasSubstr("&lt;script&gt;alert(1)&lt;/script&gt; &amp; &quot;x&quot; \xEF\xBF\xBD"));
}

TEST(Report, JsonSaysTheSame) {
    const Report report = sample();
    const auto json = nlohmann::json::parse(report_json(report));
    EXPECT_EQ(json["cameras"][0]["numbers"]["fx"]["value"],
              report.calibration.cameras[0].numbers[0].value);
    EXPECT_EQ(json["cameras"][1]["view_rms_px"].size(), 8u);
    EXPECT_EQ(json["second_from_first"]["numbers"]["shift x"]["sigma"],
              report.calibration.rig[3].sigma);
    EXPECT_EQ(json["depth_planes"][1]["rms_mm"], 9.0);
    EXPECT_EQ(json["notes"][0], "view 9: no board is seen");
}

struct Seen {
    std::string dom;
    std::string log;
};

// What Chromium makes of a page, and what it says about it.
Seen in_chromium(const std::filesystem::path& page, const test::TempDir& folder) {
    const std::string command =
        "timeout 60 chromium --headless --no-sandbox --disable-gpu --disable-dev-shm-usage "
        "--disable-background-networking --host-resolver-rules='MAP * ~NOTFOUND' "
        "--enable-logging=stderr --v=0 --user-data-dir=" +
        (folder / "profile").string() + " --dump-dom file://" + page.string() + " 2>" +
        (folder / "log").string();
    Seen out;
    FILE* pipe = popen(command.c_str(), "r");
    if (!pipe) return out;
    std::array<char, 4096> buffer{};
    while (const std::size_t got = std::fread(buffer.data(), 1, buffer.size(), pipe)) {
        out.dom.append(buffer.data(), got);
    }
    pclose(pipe);
    out.log = test::read_bytes(folder / "log");
    return out;
}

// Everything that the page could ask for is forbidden by its own policy, and Chromium tells of
// every try.
TEST(Report, ChromiumShowsItAndIsAskedForNothing) {
    ASSERT_EQ(std::system("command -v chromium >/dev/null 2>&1"), 0)
        << "no chromium: see packages.txt";
    const test::TempDir folder;
    ASSERT_TRUE(write_report(folder / "report", sample()));
    const Seen good = in_chromium(folder / "report/report.html", folder);
    EXPECT_EQ(count(good.dom, "<svg "), 6u);
    EXPECT_THAT(good.dom, HasSubstr("</html>"));
    EXPECT_THAT(good.log, Not(HasSubstr("Content Security Policy")));

    std::string page = report_html(sample());
    page.insert(page.find("<h2>"), "<img src=\"http://example.org/x.png\">");
    const Seen bad = in_chromium(folder.write("bad.html", page), folder);
    EXPECT_THAT(bad.log, HasSubstr("Content Security Policy"));
}

}  // namespace
}  // namespace kino
