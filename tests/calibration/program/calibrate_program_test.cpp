#include <gmock/gmock.h>
#include <sys/wait.h>

#include <cmath>
#include <cstdlib>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include "calibration/disparity.h"
#include "calibration/files/camera_text.h"
#include "sensor/file_bytes.h"
#include "sensor/png_io.h"
#include "sensor/rig_json.h"
#include "sensor/session/recorder.h"
#include "tests/calibration/boards/drawn_board.h"
#include "tests/support/temp_dir.h"

namespace kino {
namespace {

using test::TempDir;
using testing::HasSubstr;

struct Ran {
    int exit_code = -1;
    std::string out;
    std::string err;
};

Ran run(const std::string& arguments, const TempDir& folder) {
    const std::string out = folder / "stdout";
    const std::string err = folder / "stderr";
    const int status = std::system(("XDG_CONFIG_HOME=" + folder.path().string() +
                                    " " KINO_CALIBRATE " " + arguments + " >" + out + " 2>" + err)
                                       .c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, test::read_bytes(out),
            test::read_bytes(err)};
}

CameraModel camera() {
    return {
        .width = 320, .height = 240, .fx = 290, .fy = 291, .cx = 157.3, .cy = 121.9, .k1 = -0.08};
}

const Board kBoard;  // chess:9x6:25

Pose held(int i) {
    const double around = 2.4 * i;
    const glm::dquat rotation =
        glm::angleAxis(0.5, glm::dvec3(std::cos(around), std::sin(around), 0)) *
        glm::angleAxis(0.1 * (i % 3), glm::dvec3(0, 0, 1));
    const glm::dvec3 place(0.06 * (i % 3 - 1), 0.045 * (i / 3 - 1), 0.36 + 0.02 * (i % 2));
    return {glm::normalize(rotation), place - rotation * glm::dvec3(0.1, 0.0625, 0)};
}
constexpr int kPlaces = 9;

GreyPicture picture(int i) {
    return test::draw_chessboard(camera(), kBoard, held(i), static_cast<std::uint64_t>(i));
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
    EXPECT_NEAR(found.fx, camera().fx, 0.01 * camera().fx);
    EXPECT_NEAR(found.cx, camera().cx, 3);
    EXPECT_NEAR(found.cy, camera().cy, 3);
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

// Raw readings of the board's plane, as if everything were `scale` times as far.
Image<std::uint16_t> disparity_of(const Pose& pose, double scale) {
    const Disparity device;
    const Projection projection(camera());
    const glm::dvec3 normal = pose.rotation * glm::dvec3(0, 0, 1);
    Image<std::uint16_t> out(320, 240, Disparity::kNoReading);
    for (int y = 0; y < out.height(); ++y) {
        for (int x = 0; x < out.width(); ++x) {
            const glm::dvec3 ray(*projection.unproject({x, y}), 1);
            const double z = glm::dot(normal, pose.translation) / glm::dot(normal, ray);
            if (z > 0) out.at(x, y) = device.raw(scale * z);
        }
    }
    return out;
}

// Infrared and raw disparity in one session: the board stands still for some frames in each place.
// Its squares are larger than stated.
TEST(CalibrateProgram, SessionGivesViewsWhereTheBoardHoldsStillAndItsDepthTheSquares) {
    const TempDir temp;
    RigParameters rig = default_kinect1_rig(320, 240);
    rig.color.reset();
    rig.serial = "B7";
    const std::string file = temp / "board.mkv";
    {
        SourceInfo info;
        info.name = "drawn";
        info.serial = rig.serial;
        info.streams = {{{0, StreamKind::depth}, 320, 240, 30, "disparity"},
                        {{0, StreamKind::infrared}, 320, 240, 30, "grey"}};
        auto recorder = Recorder::create(file, info, rig, {});
        ASSERT_TRUE(recorder) << recorder.error().to_string();
        std::int64_t index = 0;
        for (int i = 0; i < kPlaces; ++i) {
            const GreyPicture grey = picture(i);
            const auto infrared = std::make_shared<InfraredFrame>();
            infrared->raw = Image<std::uint16_t>(320, 240);
            for (std::size_t k = 0; k < grey.size(); ++k) {
                infrared->raw.pixels()[k] = static_cast<std::uint16_t>(grey.pixels()[k] * 4);
            }
            const Image<std::uint16_t> readings = disparity_of(held(i), 1.2);
            for (int repeat = 0; repeat < 3; ++repeat, ++index) {
                FrameSet set;
                set.index = index;
                set.time = index * 33 * kNsPerMs;
                const auto put_header = [&](FrameHeader& header) {
                    header = {.device_time = set.time, .host_time = set.time, .sequence = index};
                };
                const auto own = std::make_shared<InfraredFrame>(*infrared);
                put_header(own->header);
                set.infrared = own;
                const auto depth = std::make_shared<DepthFrame>();
                put_header(depth->header);
                depth->unit = DepthUnit::kinect_disparity11;
                depth->raw = readings;
                set.depth = depth;
                (*recorder)->put(set);
            }
        }
        ASSERT_TRUE((*recorder)->close());
    }
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
