#include <gmock/gmock.h>

#include "board_session.h"
#include "sensor/rig_json.h"

namespace kino {
namespace {

using test::TempDir;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

// A person who shows the board: it rests in each place and is carried to the next.
test::BoardSession carried(int rest) {
    test::BoardSession session;
    for (int i = 0; i < test::kPlaces; ++i) {
        session.stands.push_back({test::held(i), rest});
        if (i + 1 == test::kPlaces) break;
        session.stands.push_back({interpolate(test::held(i), test::held(i + 1), 0.5), 1});
    }
    return session;
}

std::string text_of(const TempDir& temp, const char* name) {
    return test::read_bytes(temp / name);
}

TEST(GuidedCapture, TakesViewsOfASessionAsIfItWereLive) {
    const TempDir temp;
    const std::string file = temp / "board.mkv";
    ASSERT_TRUE(test::write_board_session(file, test::board_session_rig("G1"), carried(5)));
    const std::string to = " --model brown4 --report " + (temp / "report").string() + " --out " +
                           (temp / "rig.json").string();
    const test::Ran ran = test::run_calibrate(file + to, temp);
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    // One in every place, none on the way.
    EXPECT_THAT(ran.out, HasSubstr("9 views, RMS"));
    EXPECT_THAT(ran.err, HasSubstr("view 9: frame 5"));
    EXPECT_THAT(ran.err, HasSubstr("hold still"));
    EXPECT_THAT(ran.err, HasSubstr("infrared: still missing: "));
    const auto rig = read_rig_file(temp / "rig.json");
    ASSERT_TRUE(rig);
    EXPECT_NEAR(rig->depth.fx, 290, 3);
    EXPECT_EQ(rig->serial, "G1");
    EXPECT_THAT(text_of(temp, "report/report.html"), HasSubstr("9 views"));

    // Bounds.
    const test::Ran few = test::run_calibrate(file + " --frames 4", temp);
    EXPECT_EQ(few.exit_code, 1);
    EXPECT_THAT(few.err, HasSubstr("1 view shows the board"));
    const test::Ran none = test::run_calibrate(file + " --seconds 0.001", temp);
    EXPECT_EQ(none.exit_code, 1);
    EXPECT_THAT(none.err, HasSubstr("was never still, sharp and whole"));
}

TEST(GuidedCapture, ShowsAWindowWhereThereIsADisplay) {
    ASSERT_TRUE(std::filesystem::exists("/usr/bin/xvfb-run")) << "xvfb is in packages.txt";
    const TempDir temp;
    const std::string file = temp / "board.mkv";
    test::BoardSession session = carried(4);
    ASSERT_TRUE(test::write_board_session(file, test::board_session_rig("G2"), session));
    const test::Ran ran =
        test::run_calibrate(file + " --model brown4 --report " + (temp / "report").string(), temp,
                            "KINO_VALIDATION=1 xvfb-run -a -s '-screen 0 1280x800x24'");
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_THAT(ran.out, ContainsRegex("[789] views, RMS"));
    EXPECT_THAT(ran.err, Not(HasSubstr("no window")));
    EXPECT_THAT(ran.err, Not(HasSubstr("vulkan:")));
    // What the window says is not said again in lines.
    EXPECT_THAT(ran.err, Not(HasSubstr("hold still")));
    EXPECT_THAT(text_of(temp, "report/report.html"), HasSubstr("views. RMS"));
}

}  // namespace
}  // namespace kino
