#include "calibration/report/report.h"

#include <gmock/gmock.h>

#include <array>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "calibration/report/overlay_picture.h"
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
    report.overlays = {report_picture("before", Image<Rgba8>(8, 6, {200, 0, 0, 255})).value(),
                       report_picture("after <b>", Image<Rgba8>(8, 6, {0, 0, 200, 255})).value()};
    DriftSeries drift;
    drift.points = {{0, 1.5, 1, 1e-4, 31.5}, {60, 1.503, 1.002, 1e-4, {}}};
    drift.warm_up = WarmUp{1.003, 0.003, 50};
    report.drift = drift;
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
    // RMS by view, two pictures a camera, planes, drift.
    EXPECT_EQ(count(page, "<svg "), 7u);
    EXPECT_EQ(count(page, "<img "), 2u);
    EXPECT_EQ(count(page, "src=\"data:image/png;base64,iVBOR"), 2u);
    EXPECT_THAT(page, HasSubstr("alt=\"after &lt;b&gt;\""));
    EXPECT_THAT(page, HasSubstr("warming up: +0.300 % with a time of 50 s"));
    EXPECT_EQ(count(page, "<svg "), count(page, "</svg>"));
    const std::size_t corners =
        report.calibration.cameras[0].errors.size() + report.calibration.cameras[1].errors.size();
    EXPECT_EQ(corners, 8u * 54 * 2);
    EXPECT_EQ(count(page, "<circle "), corners + report.planes.size() + 2);
    for (const char* part : {"standard deviation", "RMS held out, px", "brown4", "turn x",
                             "infrared", "Depth by distance", "view 9: no board is seen"}) {
        EXPECT_THAT(page, HasSubstr(part));
    }
}

TEST(Report, PageAsksForNothing) {
    std::string page = report_html(sample());
    // Pictures are in the page itself; what is left of it is looked at.
    for (std::size_t at = 0;
         (at = page.find("src=\"data:image/png;base64,")) != std::string::npos;) {
        page.erase(at, page.find('"', at + 5) + 1 - at);
    }
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
    EXPECT_EQ(json["drift"]["points"][1]["scale"], 1.002);
    EXPECT_EQ(json["drift"]["points"][0]["temperature_c"], 31.5);
    EXPECT_FALSE(json["drift"]["points"][1].contains("temperature_c"));
    EXPECT_EQ(json["drift"]["warm_up"]["tau_s"], 50);
    EXPECT_EQ(json["depth_over_color"][1]["caption"], "after <b>");
    EXPECT_EQ(json["depth_over_color"][1]["picture"], data_uri(report.overlays[1].png));
}

// RFC 4648, section 10.
TEST(Report, PicturesAreBase64) {
    const auto of = [](const std::string& text) {
        return data_uri({text.begin(), text.end()}).substr(22);
    };
    EXPECT_EQ(of(""), "");
    EXPECT_EQ(of("f"), "Zg==");
    EXPECT_EQ(of("fo"), "Zm8=");
    EXPECT_EQ(of("foo"), "Zm9v");
    EXPECT_EQ(of("foob"), "Zm9vYg==");
    EXPECT_EQ(of("fooba"), "Zm9vYmE=");
    EXPECT_EQ(of("foobar"), "Zm9vYmFy");
}

TEST(Report, AStillSceneHasAPageWithoutCameras) {
    Report report;
    report.title = "Depth of a still scene";
    report.drift = sample().drift;
    const std::string page = report_html(report);
    EXPECT_EQ(count(page, "<svg "), 1u);
    EXPECT_THAT(page, Not(HasSubstr("Board")));
    EXPECT_TRUE(nlohmann::json::accept(report_json(report)));
}

// The depth lies on what it belongs to with the true calibration, and beside it with another.
TEST(Report, DepthLiesOverColour) {
    RigParameters rig = default_kinect1_rig(160, 120);
    rig.color = rig.depth;
    rig.color_from_depth = {};
    DepthFrame depth;
    depth.raw = Image<std::uint16_t>(160, 120, 3000);
    Image<Rgba8> color(160, 120, {128, 128, 128, 255});
    for (int y = 40; y < 80; ++y) {
        for (int x = 50; x < 100; ++x) depth.raw.at(x, y) = 1000;
    }
    const auto good = depth_over_color(depth, color, rig, 160);
    ASSERT_TRUE(good) << good.error().to_string();
    // Near is red, far is blue, the border white.
    EXPECT_GT(good->at(75, 60).r, good->at(75, 60).b + 50);
    EXPECT_GT(good->at(20, 20).b, good->at(20, 20).r + 50);
    EXPECT_EQ(good->at(50, 60), (Rgba8{255, 255, 255, 255}));
    EXPECT_NE(good->at(58, 60), (Rgba8{255, 255, 255, 255}));
    rig.color->cx += 8;
    const auto slid = depth_over_color(depth, color, rig, 160);
    EXPECT_EQ(slid->at(58, 60), (Rgba8{255, 255, 255, 255}));
    EXPECT_EQ(depth_over_color(depth, color, rig, 80)->width(), 80);
    rig.color.reset();
    EXPECT_FALSE(depth_over_color(depth, color, rig));
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
    EXPECT_EQ(count(good.dom, "<svg "), 7u);
    EXPECT_EQ(count(good.dom, "<img "), 2u);
    EXPECT_THAT(good.dom, HasSubstr("</html>"));
    EXPECT_THAT(good.log, Not(HasSubstr("Content Security Policy")));

    std::string page = report_html(sample());
    page.insert(page.find("<h2>"), "<img src=\"http://example.org/x.png\">");
    const Seen bad = in_chromium(folder.write("bad.html", page), folder);
    EXPECT_THAT(bad.log, HasSubstr("Content Security Policy"));
}

}  // namespace
}  // namespace kino
