#include <gmock/gmock.h>

#include <cmath>

#include "board_session.h"
#include "calibration/depth_bias.h"
#include "sensor/rig_json.h"

namespace kino {
namespace {

using test::TempDir;
using testing::ContainsRegex;
using testing::HasSubstr;

// A device whose numbers are not the default ones, and whose picture is bent besides.
DisparityParameters true_disparity() {
    DisparityParameters truth;
    truth.const_shift = 203.5;
    truth.reference_distance_cm = 118.2;
    return truth;
}
double true_bias(int x, int y) {
    const double u = (x - 160) / 160.0;
    const double v = (y - 120) / 120.0;
    return 0.05 * u * u - 0.03 * v;
}
double seen_by_device(int x, int y, double z) {
    return 1 / (1 / z + true_bias(x, y));
}

Pose farther(Pose pose, double times) {
    pose.translation *= times;
    return pose;
}

TEST(DepthOfBoards, GivesTheDisparityAndWhatItIsOffByInEachPart) {
    const TempDir temp;
    const std::string file = temp / "board.mkv";
    test::BoardSession session;
    session.device = Disparity(true_disparity());
    session.reading = seen_by_device;
    for (int i = 0; i < test::kPlaces; ++i) session.stands.push_back({test::held(i), 2});
    for (const int i : {0, 2, 4, 6, 8}) {
        session.stands.push_back({farther(test::held(i), 1.7), 2});
    }
    ASSERT_TRUE(test::write_board_session(file, test::board_session_rig("D1"), session));
    const test::Ran ran = test::run_calibrate(
        "--session " + file + " --model brown4 --keep --out " + (temp / "rig.json").string(), temp);
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_THAT(ran.err, ContainsRegex("disparity from [0-9]+ depth pixels"));
    EXPECT_THAT(ran.err, ContainsRegex("depth bias from [0-9]+ depth pixels"));
    const auto rig = read_rig_file(temp / "rig.json");
    ASSERT_TRUE(rig);
    const auto bias = bias_beside(temp / "rig.json", "D1");
    ASSERT_TRUE(bias) << bias.error().to_string();
    ASSERT_TRUE(*bias);
    EXPECT_EQ(bias_beside(temp / "kinoscope/calibration/D1.json", "D1").value(), *bias);
    // At another distance than any board's, where boards were.
    const Disparity found(rig->disparity);
    const Disparity plain;
    double wrong = 0;
    double right = 0;
    double count = 0;
    for (int y = 40; y < 200; y += 4) {
        for (int x = 40; x < 280; x += 4) {
            const double raw = *session.device.raw_exact(seen_by_device(x, y, 0.9));
            const double metres = *found.metres(raw);
            wrong += std::abs(*plain.metres(raw) - 0.9);
            right += std::abs(1 / (1 / metres - (*bias)->at(x, y)) - 0.9);
            ++count;
        }
    }
    EXPECT_GT(wrong / count, 0.03);
    EXPECT_LT(right / count, 0.006);
}

TEST(StillScene, WallGivesABiasAndALongRecordingItsDrift) {
    const TempDir temp;
    const std::string wall = temp / "wall.mkv";
    test::BoardSession session;
    session.reading = seen_by_device;
    const Pose facing{glm::angleAxis(0.1, glm::dvec3(0, 1, 0)), {-0.1, -0.06, 1.0}};
    session.stands = {{facing, 3}};
    RigParameters rig = test::board_session_rig("D2");
    rig.depth = test::board_camera();
    ASSERT_TRUE(test::write_board_session(wall, rig, session));
    const test::Ran flat = test::run_calibrate("--wall " + wall + " --keep", temp);
    ASSERT_EQ(flat.exit_code, 0) << flat.err;
    EXPECT_THAT(flat.out, HasSubstr("depth bias from"));
    const auto bias = bias_beside(temp / "kinoscope/calibration/D2.json", "D2");
    ASSERT_TRUE(bias);
    ASSERT_TRUE(*bias);
    // A plane takes what is linear; the bend across the picture is left: 0.05 u^2.
    const double bend = (*bias)->at(300, 120) + (*bias)->at(20, 120) - 2 * (*bias)->at(160, 120);
    EXPECT_NEAR(bend, 2 * 0.05 * 0.875 * 0.875, 0.012);

    const std::string longer = temp / "long.mkv";
    test::BoardSession warming;
    for (int i = 0; i < 30; ++i) warming.stands.push_back({facing, 1});
    warming.reading = [calls = 0](int, int, double z) mutable {
        const double frame = calls++ / (320 * 240);
        return z * (1 - 0.03 * std::exp(-frame / 8));
    };
    ASSERT_TRUE(test::write_board_session(longer, rig, warming));
    const test::Ran drift =
        test::run_calibrate("--drift " + longer + " --report " + (temp / "report").string(), temp);
    ASSERT_EQ(drift.exit_code, 0) << drift.err;
    EXPECT_THAT(drift.out, HasSubstr("warming up: +"));
    EXPECT_THAT(test::read_bytes(temp / "report/report.html"), HasSubstr("Drift of the depth"));
    EXPECT_THAT(test::read_bytes(temp / "report/report.json"), HasSubstr("\"tau_s\""));
    const test::Ran none = test::run_calibrate("--drift recordings/nowhere", temp);
    EXPECT_EQ(none.exit_code, 1);
}

}  // namespace
}  // namespace kino
