#include <gmock/gmock.h>

#include "board_session.h"
#include "calibration/files/camera_text.h"
#include "sensor/file_bytes.h"
#include "sensor/png_io.h"
#include "sensor/rig_json.h"
#include "tests/support/temp_dir.h"

namespace kino {
namespace {

using test::TempDir;
using testing::HasSubstr;

using test::kPlaces;
using test::Ran;

Ran run(const std::string& arguments, const TempDir& folder) {
    return test::run_calibrate(arguments, folder);
}

GreyPicture picture(int i) {
    return test::picture_of(test::held(i), static_cast<std::uint64_t>(i));
}

Image<Rgba8> colored(const GreyPicture& grey) {
    Image<Rgba8> out(grey.width(), grey.height());
    for (std::size_t i = 0; i < grey.size(); ++i) {
        const std::uint8_t v = grey.pixels()[i];
        out.pixels()[i] = {v, v, v, 255};
    }
    return out;
}

void expect_camera(const CameraModel& found) {
    const CameraModel truth = test::board_camera();
    EXPECT_NEAR(found.fx, truth.fx, 0.01 * truth.fx);
    EXPECT_NEAR(found.cx, truth.cx, 3);
    EXPECT_NEAR(found.cy, truth.cy, 3);
}

TEST(CalibrateProgram, PicturesToEveryFile) {
    const TempDir temp;
    std::filesystem::create_directories(temp / "pictures");
    for (int i = 0; i < kPlaces; ++i) {
        ASSERT_TRUE(write_png_rgba8(temp / ("pictures/" + std::to_string(i) + ".png"),
                                    colored(picture(i))));
    }
    const std::string out = temp.path().string() + "/";
    const Ran ran =
        run("--images " + out + "pictures --board chess:9x6:25 --model brown4 --serial A22 --out " +
                out + "rig.json --report " + out + "report --ros " + out + "ros --opencv " + out +
                "cv.yml --tum " + out + "tum",
            temp);
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_THAT(ran.out, HasSubstr("9 views, RMS"));
    const auto rig = read_rig_file(temp / "rig.json");
    ASSERT_TRUE(rig) << rig.error().to_string();
    expect_camera(rig->depth);
    EXPECT_EQ(rig->serial, "A22");
    EXPECT_FALSE(rig->color);
    const auto text = [&](const char* name) { return test::read_bytes(temp / name); };
    EXPECT_EQ(read_ros_camera_info(text("ros/pictures.yaml"), "ros")->camera, rig->depth);
    EXPECT_EQ(read_opencv_yaml(text("cv.yml"), "cv")->cameras[0].camera, rig->depth);
    EXPECT_EQ(read_tum_intrinsics(text("tum/pictures.txt"), "tum")->camera, rig->depth);
    EXPECT_THAT(text("report/report.html"), HasSubstr("chess:9x6:25"));
    EXPECT_THAT(text("report/report.json"), HasSubstr("\"kinoscope_calibration_report\": 1"));
}

// Infrared and raw disparity in one session: the board stands still for some frames in each place.
// Its squares are larger than stated.
TEST(CalibrateProgram, SessionGivesViewsWhereTheBoardHoldsStillAndItsDepthTheSquares) {
    const TempDir temp;
    const std::string file = temp / "board.mkv";
    test::BoardSession session;
    for (int i = 0; i < kPlaces; ++i) session.stands.push_back({test::held(i), 3});
    session.reading = [](int, int, double z) { return 1.2 * z; };
    ASSERT_TRUE(test::write_board_session(file, test::board_session_rig("B7"), session));
    const Ran ran = run(
        "--session " + file + " --model brown4 --keep --out " + (temp / "rig.json").string(), temp);
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_THAT(ran.out, HasSubstr("9 views, RMS"));
    const auto found = read_rig_file(temp / "rig.json");
    ASSERT_TRUE(found) << found.error().to_string();
    expect_camera(found->depth);
    EXPECT_EQ(found->serial, "B7");
    EXPECT_EQ(read_rig_file(temp / "kinoscope/calibration/B7.json").value(), *found);
    EXPECT_THAT(ran.err,
                testing::ContainsRegex(
                    "the depth says that the squares are (29[.][5-9]|30[.][0-5]) mm, not 25.0 mm"));
    // Nothing is made of depth that the board contradicts.
    EXPECT_EQ(found->disparity, DisparityParameters{});
}

TEST(CalibrateProgram, CheckNeedsNoBoard) {
    const TempDir temp;
    const Ran desk = run("--check recordings/desk", temp);
    ASSERT_EQ(desk.exit_code, 0) << desk.err;
    EXPECT_THAT(desk.out, HasSubstr("flat parts at 0.9"));
    EXPECT_THAT(desk.out, HasSubstr("the calibration still holds"));
    EXPECT_THAT(desk.out, HasSubstr("depth and colour share 0."));
    const Ran bust = run("--check recordings/bust", temp);
    ASSERT_EQ(bust.exit_code, 0) << bust.err;
    EXPECT_EQ(run("--check recordings/nowhere", temp).exit_code, 1);
}

TEST(CalibrateProgram, SaysWhatIsWrong) {
    const TempDir temp;
    const std::string folder = temp.path().string();
    EXPECT_EQ(run("--help", temp).exit_code, 0);
    EXPECT_EQ(run("--images a --pairs b", temp).exit_code, 2);
    EXPECT_EQ(run("--nonsense", temp).exit_code, 2);
    const auto complaint = [&](const std::string& arguments) {
        const Ran ran = run(arguments, temp);
        EXPECT_EQ(ran.exit_code, 1) << arguments;
        return ran.err;
    };
    EXPECT_THAT(complaint("--images " + folder + "/none"), HasSubstr("No such file"));
    EXPECT_THAT(complaint("--images " + folder), HasSubstr("no PNG or JPEG picture"));
    EXPECT_THAT(complaint("--images x --board ring:3"), HasSubstr("describes no board"));
    EXPECT_THAT(complaint("--images x --model best"), HasSubstr("\"best\" is no lens model"));
    ASSERT_TRUE(write_png_rgba8(temp / "a.png", Image<Rgba8>(64, 64)));
    EXPECT_THAT(complaint("--images " + folder),
                HasSubstr("no picture shows the board chess:9x6:25"));
    EXPECT_THAT(complaint("--session recordings/office"), HasSubstr("was never still and whole"));
}

}  // namespace
}  // namespace kino
