#include "calibration/files/camera_text.h"

#include <gmock/gmock.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include "calibration/projection.h"
#include "sensor/convert/k4a_calibration.h"
#include "sensor/file_bytes.h"
#include "tests/support/random.h"

namespace kino {
namespace {

using testing::HasSubstr;

const std::string kParameters = "tests/data/calibration/parameters/";

std::string text_of(const std::string& name) {
    return read_file_text(kParameters + name, 1 << 20).value();
}

CameraModel random_camera(test::Random& random, bool rational) {
    CameraModel c{.width = random.integer(1, 4096),
                  .height = random.integer(1, 4096),
                  .fx = random.real(1, 3000),
                  .fy = random.real(1e-3, 3000),
                  .cx = random.real(-10, 3000),
                  .cy = random.real(-10, 3000),
                  .k1 = random.real(-1, 1),
                  .k2 = random.real(-1e-12, 1e-12),
                  .k3 = random.real(-100, 100),
                  .p1 = random.real(-1e-5, 1e-5),
                  .p2 = random.chance(0.3) ? 0 : random.real(-1, 1)};
    if (rational) {
        c.k4 = random.real(-1, 1);
        c.k5 = random.real(-1e9, 1e9);
        c.k6 = random.real(-1, 1);
    }
    return c;
}

TEST(CameraText, EveryFormatGivesTheSameBitsBack) {
    test::Random random(1);
    for (int i = 0; i < 200; ++i) {
        const NamedCamera a{"infrared", random_camera(random, i % 2 == 0)};
        const auto ros = read_ros_camera_info(ros_camera_info(a), "ros");
        ASSERT_TRUE(ros) << ros.error().to_string();
        EXPECT_EQ(*ros, a);

        const auto one = read_opencv_yaml(opencv_yaml({{a}, std::nullopt}), "cv");
        ASSERT_TRUE(one) << one.error().to_string();
        EXPECT_EQ(one->cameras[0].camera, a.camera);

        const NamedCamera b{"color", random_camera(random, i % 3 == 0)};
        const Pose pose{
            glm::angleAxis(random.real(0, 3), glm::normalize(glm::dvec3(1, random.real(-1, 1), 2))),
            {random.real(-1, 1), random.real(-1, 1), 0}};
        const auto two = read_opencv_yaml(opencv_yaml({{a, b}, pose}), "cv");
        ASSERT_TRUE(two) << two.error().to_string();
        EXPECT_EQ(two->cameras[1].camera, b.camera);
        ASSERT_TRUE(two->second_from_first);
        EXPECT_EQ(two->second_from_first->translation, pose.translation);
        EXPECT_NEAR(std::abs(glm::dot(two->second_from_first->rotation, pose.rotation)), 1, 1e-14);

        const auto tum = tum_intrinsics(a);
        EXPECT_EQ(tum.has_value(), i % 2 != 0);
        if (tum) {
            const auto again = read_tum_intrinsics(*tum, "tum");
            ASSERT_TRUE(again) << again.error().to_string();
            EXPECT_EQ(*again, a);
        }
    }
}

TEST(CameraText, RealFilesOfOtherPrograms) {
    const auto rgbdemo = read_opencv_yaml(text_of("kinect1_rgbdemo.yml"), "rgbdemo");
    ASSERT_TRUE(rgbdemo) << rgbdemo.error().to_string();
    EXPECT_EQ(rgbdemo->cameras[0].name, "depth");
    EXPECT_EQ(rgbdemo->cameras[0].camera.fx, 594.25464969100040);
    EXPECT_EQ(rgbdemo->cameras[1].camera.k3, 0.89012728224037985);
    EXPECT_EQ(rgbdemo->second_from_first->translation.x, 0.021354778990792557);

    const auto iai = read_opencv_yaml(text_of("kinect2_iai_196605135147/calib_ir.yaml"), "iai",
                                      std::pair(512, 424));
    ASSERT_TRUE(iai) << iai.error().to_string();
    EXPECT_EQ(iai->cameras[0].camera.width, 512);
    EXPECT_EQ(iai->cameras[0].camera.cx, 242.98551682775121);
    EXPECT_FALSE(read_opencv_yaml(text_of("kinect2_iai_196605135147/calib_ir.yaml"), "iai"));

    const auto azure = read_opencv_yaml(text_of("azure_charuco_ir.yml"), "azure");
    ASSERT_TRUE(azure) << azure.error().to_string();
    EXPECT_EQ(azure->cameras[0].camera.k6, 0.063248715614073373);
    EXPECT_EQ(azure->cameras[0].camera.width, 1024);

    const auto left = read_opencv_yaml(text_of("opencv_left.yml"), "left");
    ASSERT_TRUE(left) << left.error().to_string();
    EXPECT_EQ(left->cameras[0].camera.height, 480);
}

// The inverse over the whole picture, and never a folded pixel beyond.
TEST(RealLenses, DistortionHasAnInverseOverThePicture) {
    std::vector<NamedCamera> cameras;
    for (const char* name :
         {"kinect1_rgbdemo.yml", "kinect2_bauhaus_50.yml", "azure_charuco_fullres.yml",
          "azure_charuco_ir.yml", "opencv_left.yml"}) {
        const auto file = read_opencv_yaml(text_of(name), name);
        ASSERT_TRUE(file) << file.error().to_string();
        for (const NamedCamera& camera : file->cameras) {
            cameras.push_back({std::string(name) + " " + camera.name, camera.camera});
        }
    }
    for (const auto& [name, size] : {std::pair("calib_ir.yaml", std::pair(512, 424)),
                                     std::pair("calib_color.yaml", std::pair(1920, 1080))}) {
        const auto file =
            read_opencv_yaml(text_of(std::string("kinect2_iai_196605135147/") + name), name, size);
        ASSERT_TRUE(file);
        cameras.push_back({name, file->cameras[0].camera});
    }
    for (const char* name : {"azure_TestCalibration.json", "azure_pyk4a_001514394512.json"}) {
        std::string text = text_of(name);
        if (text.starts_with("\xEF\xBB\xBF")) text.erase(0, 3);
        const auto rig = rig_from_k4a(text, {640, 576}, PixelSize{2048, 1536}, name);
        ASSERT_TRUE(rig) << rig.error().to_string();
        cameras.push_back({std::string(name) + " depth", rig->depth});
        cameras.push_back({std::string(name) + " color", *rig->color});
    }
    EXPECT_GE(cameras.size(), 13u);
    for (const NamedCamera& named : cameras) {
        const CameraModel& c = named.camera;
        const Projection projection(c);
        double worst = 0;
        int inside = 0;
        int all = 0;
        for (int i = 0; i <= 60; ++i) {
            for (int j = 0; j <= 60; ++j) {
                const glm::dvec2 px(-0.5 + c.width * i / 60.0, -0.5 + c.height * j / 60.0);
                ++all;
                const auto ray = projection.unproject(px);
                if (!ray) continue;
                ++inside;
                EXPECT_LE(glm::length(*ray), projection.max_radius() * (1 + 1e-12));
                const auto again = projection.project({*ray, 1});
                ASSERT_TRUE(again) << named.name;
                worst = std::max(worst, glm::distance(*again, px));
                // Rounded to float, as the registration has it.
                const glm::vec2 coarse(*ray);
                const auto by_float = projection.project({glm::dvec2(coarse), 1});
                if (by_float) {
                    EXPECT_LT(glm::distance(*by_float, px), 1e-6 * c.width) << named.name;
                }
            }
        }
        EXPECT_LT(worst, 0.01) << named.name;
        // A Kinect v2 whose polynomial folds in the corners of its picture is among them.
        EXPECT_GT(inside, 0.94 * all) << named.name;
        const double beyond = projection.max_radius() * 1.0001;
        if (std::isfinite(beyond)) {
            EXPECT_FALSE(projection.project({beyond, 0, 1})) << named.name;
            EXPECT_FALSE(projection.project({0, -2 * beyond, 1})) << named.name;
        }
    }
}

std::string ros() {
    return ros_camera_info(
        {"color", {.width = 640, .height = 480, .fx = 500, .fy = 500, .cx = 320, .cy = 240}});
}

std::string with(std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
}

std::string complaint(const std::string& text) {
    const auto read = read_ros_camera_info(text, "file");
    return read ? "no complaint" : read.error().to_string();
}

TEST(CameraText, WhatIsWrongIsNamed) {
    EXPECT_EQ(complaint(ros()), "no complaint");
    EXPECT_THAT(complaint(with(ros(), "image_width: 640", "image_width: 0")), HasSubstr("line 1"));
    EXPECT_THAT(complaint(with(ros(), "image_width: 640", "width: 640")),
                HasSubstr("no image_width"));
    EXPECT_THAT(complaint(with(ros(), "image_width: 640", "image_height: 640")),
                HasSubstr("is there twice"));
    EXPECT_THAT(complaint(with(ros(), "plumb_bob", "fisheye")),
                HasSubstr("\"fisheye\" is not known"));
    EXPECT_THAT(complaint(with(ros(), "[500,", "[-500,")), HasSubstr("focal length"));
    EXPECT_THAT(complaint(with(ros(), "[500,", "[nan,")), HasSubstr("\"nan\" is no number"));
    EXPECT_THAT(complaint(with(ros(), "[500, 0,", "[500, 3,")), HasSubstr("camera matrix is not"));
    EXPECT_THAT(complaint(with(ros(), "[500, 0,", "[500,")),
                HasSubstr("8 numbers in a matrix of 3 x 3"));
    EXPECT_THAT(complaint(with(ros(), "cols: 5", "cols: 6")),
                HasSubstr("5 numbers in a matrix of 1 x 6"));
    EXPECT_THAT(complaint(ros().substr(0, ros().find("0, 0, 1]"))),
                HasSubstr("the list does not end"));
    EXPECT_THAT(complaint("a:\n  - 1\n"), HasSubstr("not \"key: value\""));
    EXPECT_THAT(complaint(""), HasSubstr("no image_width"));
    std::string deep;
    for (int i = 0; i < 40; ++i) deep += std::string(static_cast<std::size_t>(i), ' ') + "a:\n";
    EXPECT_THAT(complaint(deep), HasSubstr("nested too deeply"));
    EXPECT_THAT(complaint(std::string(2 << 20, '#')), HasSubstr("too long"));
    const auto mirror = read_opencv_yaml(
        with(text_of("kinect1_rgbdemo.yml"),
             "R: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ 9.9",
             "R: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ -9.9"),
        "file");
    ASSERT_FALSE(mirror);
    EXPECT_THAT(mirror.error().to_string(), HasSubstr("R is"));
    EXPECT_FALSE(read_tum_intrinsics("1 2 3", "f", std::pair(1, 1)));
    EXPECT_FALSE(read_tum_intrinsics("1 2 3 4 5 6 7 8 9 10", "f", std::pair(1, 1)));
    EXPECT_FALSE(read_tum_intrinsics("500 500 320 240", "f"));
    EXPECT_TRUE(read_tum_intrinsics("500 500 320 240", "f", std::pair(640, 480)));
}

TEST(CameraText, NamesCannotBreakTheirFile) {
    const CameraModel c{.width = 640, .height = 480, .fx = 500, .fy = 500, .cx = 320, .cy = 240};
    for (const char* name : {"a: b", "", "x\ny: 3", "\"", "# no"}) {
        const auto ros_again = read_ros_camera_info(ros_camera_info({name, c}), "f");
        ASSERT_TRUE(ros_again) << ros_again.error().to_string();
        EXPECT_EQ(ros_again->camera, c);
        const auto tum = read_tum_intrinsics(*tum_intrinsics({name, c}), "f");
        ASSERT_TRUE(tum) << tum.error().to_string();
        EXPECT_EQ(tum->camera, c);
    }
}

}  // namespace
}  // namespace kino
