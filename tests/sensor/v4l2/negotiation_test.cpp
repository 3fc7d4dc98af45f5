#include "sensor/v4l2/negotiation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cerrno>

#include "capture_session.h"
#include "sensor/rig_json.h"
#include "sensor/v4l2/v4l2_device.h"
#include "tests/support/temp_dir.h"

namespace kino {
namespace {

using test::FakeCamera;
using test::FakeFormat;
using test::FakeVideoSystem;
using testing::HasSubstr;

const FakeFormat kDepthMode{V4L2_PIX_FMT_Y10BPACK, {{640, 480}}, 10, {}};
const std::vector<FakeFormat> kPictureMode{
    {V4L2_PIX_FMT_Y10BPACK, {{640, 488}, {1280, 1024}}, 10, {}},
    {V4L2_PIX_FMT_SGRBG8, {{640, 480}, {1280, 1024}}, 8, {}},
    {V4L2_PIX_FMT_UYVY, {{640, 480}}, 16, {}}};

FakeCamera kinect(std::vector<FakeFormat> formats) {
    FakeCamera camera;
    camera.driver = "kinect";
    camera.bus = "usb-vhci_hcd.0-1";
    camera.node.serial = "A00364A07684047A";
    camera.formats = std::move(formats);
    return camera;
}

FakeCamera webcam() {
    FakeCamera camera;
    camera.driver = "uvcvideo";
    camera.has_rate = true;
    camera.formats = {
        {V4L2_PIX_FMT_MJPEG, {{1920, 1080}, {640, 480}}, 8, {{1, 30}}},
        {V4L2_PIX_FMT_YUYV, {{320, 240}, {640, 480}, {1280, 720}}, 16, {{1, 30}, {1, 15}, {2, 15}}},
        {V4L2_PIX_FMT_NV12, {{640, 480}}, 12, {}}};
    return camera;
}

struct Opened {
    std::shared_ptr<FakeVideoSystem> system;
    Result<std::unique_ptr<V4l2Device>> device;
    const VideoMode& mode() const { return (*device)->mode(); }
    std::string error() const { return device ? "" : device.error().to_string(); }
};

Opened open(const FakeCamera& camera, const std::string& address = {}) {
    auto system = std::make_shared<FakeVideoSystem>(camera);
    auto parsed = parse_v4l2_address(address);
    if (!parsed) return {system, fail(parsed.error())};
    return {system, V4l2Device::open(system, *parsed, camera.node)};
}

TEST(Negotiation, AKinectInDepthModeGivesDisparity) {
    const auto opened = open(kinect({kDepthMode}));
    ASSERT_EQ(opened.error(), "");
    const SourceInfo& info = (*opened.device)->info();
    ASSERT_EQ(info.streams.size(), 1u);
    EXPECT_EQ(info.streams[0].id.kind, StreamKind::depth);
    EXPECT_EQ(info.streams[0].width, 640);
    EXPECT_EQ(info.streams[0].height, 480);
    EXPECT_EQ(info.streams[0].nominal_hz, 30);
    EXPECT_EQ(opened.mode().layout.unit, DepthUnit::kinect_disparity11);
    EXPECT_EQ(opened.mode().layout.stride, 800u);
    EXPECT_EQ(opened.mode().buffer_bytes, 384000u);
    EXPECT_FALSE(opened.mode().layout.short_rows_in_place);
    auto rig = default_kinect1_rig();
    const auto calibration = (*opened.device)->calibration();
    ASSERT_TRUE(calibration.has_value());
    EXPECT_EQ(calibration->depth, rig.depth);
    EXPECT_EQ(calibration->serial, "A00364A07684047A");
    EXPECT_EQ((*opened.device)->address(), "A00364A07684047A?node=1.0.0");
}

TEST(Negotiation, AKinectInPictureModeGivesBayerOrWhatIsAskedFor) {
    const FakeCamera camera = kinect(kPictureMode);
    const struct {
        const char* address;
        StreamKind kind;
        const char* mode;
        double hz;
    } kCases[] = {
        {"", StreamKind::color, "GRBG 640x480", 30},
        {"?format=UYVY", StreamKind::color, "UYVY 640x480", 15},
        {"?as=color", StreamKind::color, "GRBG 640x480", 30},
        {"?format=SGRBG8&size=1280x1024", StreamKind::color, "GRBG 1280x1024", 10},
        {"?as=infrared", StreamKind::infrared, "Y10B 640x488", 30},
        {"?as=infrared&size=1280x1024", StreamKind::infrared, "Y10B 1280x1024", 10},
    };
    for (const auto& c : kCases) {
        const auto opened = open(camera, c.address);
        ASSERT_EQ(opened.error(), "") << c.address;
        EXPECT_EQ(opened.mode().layout.kind, c.kind) << c.address;
        EXPECT_EQ(opened.mode().text, c.mode);
        EXPECT_EQ(opened.mode().hz, c.hz);
        const auto rig = (*opened.device)->calibration();
        ASSERT_TRUE(rig.has_value());
        EXPECT_TRUE(validate(*rig).has_value());
        EXPECT_TRUE(c.kind != StreamKind::color || rig->color->width == opened.mode().layout.width);
    }
    // Its infrared picture must not be taken for depth.
    EXPECT_THAT(open(camera, "?as=depth").error(), HasSubstr("depth_mode=1"));
}

TEST(Negotiation, SizesAndRatesNearestToWhatIsWanted) {
    const struct {
        const char* address;
        const char* mode;
        double hz;
    } kCases[] = {
        {"", "YUYV 640x480", 30},
        {"?size=1280x720&fps=16", "YUYV 1280x720", 15},
        {"?fps=1", "YUYV 640x480", 7.5},
        {"?format=MJPG&size=1920x1080", "MJPG 1920x1080", 30},
        {"?size=99x99", "YUYV 320x240", 30},  // the driver has the last word
    };
    for (const auto& c : kCases) {
        const auto opened = open(webcam(), c.address);
        ASSERT_EQ(opened.error(), "") << c.address;
        EXPECT_EQ(opened.mode().text, c.mode) << c.address;
        EXPECT_EQ(opened.mode().hz, c.hz) << c.address;
    }
    const auto untouched = open(webcam());
    EXPECT_EQ(untouched.system->count("VIDIOC_S_PARM"), 0);
}

TEST(Negotiation, TheMeaningIsTheUsersToChoose) {
    FakeCamera camera;
    EXPECT_EQ(open(camera).mode().layout.kind, StreamKind::infrared);
    const auto depth = open(camera, "?as=depth");
    EXPECT_EQ(depth.mode().layout.kind, StreamKind::depth);
    EXPECT_EQ(depth.mode().layout.unit, DepthUnit::linear);
    EXPECT_EQ(depth.mode().layout.metres_per_unit, 0.001);
    EXPECT_THAT(open(camera, "?as=color").error(), HasSubstr("Y16"));
    camera.formats = {{V4L2_PIX_FMT_GREY, {{8, 6}}, 8, {}}};
    EXPECT_EQ(open(camera).mode().layout.kind, StreamKind::infrared);
    EXPECT_EQ(open(camera, "?as=color").mode().layout.kind, StreamKind::color);
    camera.formats.push_back({V4L2_PIX_FMT_Z16, {{8, 6}}, 16, {}});
    EXPECT_EQ(open(camera).mode().text, "Z16 8x6");
    camera.controls = {{0x9a0000, V4L2_CTRL_TYPE_INTEGER, "Depth Units", 1, 100000, 1, 1000, 100}};
    EXPECT_EQ(open(camera).mode().layout.metres_per_unit, 100 * 1e-6);
}

TEST(Negotiation, WhatTheDriverGivesInsteadIsTakenOnlyWhereItFits) {
    FakeCamera camera = webcam();
    camera.gives_instead = V4L2_PIX_FMT_UYVY;
    EXPECT_EQ(open(camera).mode().text, "UYVY 640x480");
    EXPECT_THAT(open(camera, "?format=YUYV").error(), HasSubstr("asked for YUYV it gives UYVY"));
    camera.gives_instead = V4L2_PIX_FMT_NV12;
    EXPECT_THAT(open(camera).error(), HasSubstr("NV12"));
    camera.gives_instead = V4L2_PIX_FMT_Y16;
    EXPECT_THAT(open(camera, "?as=color").error(), HasSubstr("Y16 cannot be"));
}

TEST(Negotiation, NodesThatAreNoCamerasAreRefusedByName) {
    FakeCamera camera;
    // The whole driver can capture; this node of it cannot.
    camera.device_capabilities = V4L2_CAP_META_CAPTURE | V4L2_CAP_STREAMING;
    EXPECT_THAT(open(camera).error(), HasSubstr("no camera"));
    EXPECT_TRUE(v4l2_driver(std::make_shared<FakeVideoSystem>(camera)).list().empty());
    camera.device_capabilities = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_READWRITE;
    EXPECT_THAT(open(camera).error(), HasSubstr("no camera"));
    camera = FakeCamera{};
    camera.capabilities = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;  // before device_caps
    camera.device_capabilities = 0;
    EXPECT_EQ(open(camera).error(), "");
    camera.formats[0].fourcc = V4L2_PIX_FMT_NV12;
    EXPECT_THAT(open(camera).error(), HasSubstr("it has NV12"));
    const auto entries = v4l2_driver(std::make_shared<FakeVideoSystem>(camera)).list();
    ASSERT_EQ(entries.size(), 1u);
    EXPECT_THAT(entries[0].problem, HasSubstr("NV12"));
    FakeCamera planes;
    planes.device_capabilities = V4L2_CAP_VIDEO_CAPTURE_MPLANE | V4L2_CAP_STREAMING;
    planes.planes = 2;
    EXPECT_THAT(open(planes).error(), HasSubstr("2 planes"));
}

TEST(Negotiation, ColourNamesItsMatrixAndRange) {
    const auto layout = [](std::uint32_t space, std::uint32_t encoding, std::uint32_t range) {
        FakeCamera camera = webcam();
        camera.colorspace = space;
        camera.ycbcr = encoding;
        camera.quantization = range;
        return open(camera).mode().layout;
    };
    const auto usual = layout(V4L2_COLORSPACE_SRGB, V4L2_YCBCR_ENC_DEFAULT, 0);
    EXPECT_EQ(usual.matrix, YuvMatrix::bt601);
    EXPECT_EQ(usual.range, YuvRange::limited);
    EXPECT_EQ(layout(V4L2_COLORSPACE_REC709, 0, 0).matrix, YuvMatrix::bt709);
    EXPECT_EQ(layout(V4L2_COLORSPACE_JPEG, 0, 0).range, YuvRange::full);
    const auto said =
        layout(V4L2_COLORSPACE_SRGB, V4L2_YCBCR_ENC_709, V4L2_QUANTIZATION_FULL_RANGE);
    EXPECT_EQ(said.matrix, YuvMatrix::bt709);
    EXPECT_EQ(said.range, YuvRange::full);
}

TEST(Negotiation, AFormatThatSomebodyChangedMeanwhileIsSetAgain) {
    const auto opened = open(webcam(), "?size=1280x720");
    ASSERT_EQ(opened.error(), "");
    v4l2_format other{};
    other.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    other.fmt.pix.pixelformat = V4L2_PIX_FMT_MJPEG;
    const int second = opened.system->open("/dev/video0");
    ASSERT_EQ(opened.system->ioctl(second, VIDIOC_S_FMT, &other), 0);
    opened.system->close(second);
    test::CollectingIntake intake;
    const StreamId id = (*opened.device)->info().streams[0].id;
    ASSERT_TRUE((*opened.device)->start(id, intake).has_value());
    (*opened.device)->stop(id);
    v4l2_format now{};
    now.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    const int third = opened.system->open("/dev/video0");
    opened.system->ioctl(third, VIDIOC_G_FMT, &now);
    opened.system->close(third);
    EXPECT_EQ(now.fmt.pix.pixelformat, V4L2_PIX_FMT_YUYV);
    EXPECT_EQ(now.fmt.pix.width, 1280u);
    // A driver that gives something else now is not believed to give the same.
    opened.system->camera().row_padding = 8;
    EXPECT_FALSE((*opened.device)->start(id, intake).has_value());
}

TEST(Calibration, AFileWinsOverTheGuessAndMustFit) {
    const auto guess = open(webcam());
    const auto rig = (*guess.device)->calibration();
    ASSERT_TRUE(rig.has_value());
    EXPECT_THAT((*guess.device)->info().note, HasSubstr("guess"));
    EXPECT_NEAR(rig->color->fx, 320 / std::tan(30 * 3.14159265358979 / 180), 1e-9);
    EXPECT_TRUE(validate(*rig).has_value());

    const test::TempDir folder;
    RigParameters known = *rig;
    known.color->fx = 600;
    known.note = "measured";
    const auto path = folder / "rig & more.json";
    ASSERT_TRUE(write_rig_file(path, known).has_value());
    V4l2Address address;
    address.calibration = path.string();
    const auto opened = open(webcam(), address.to_string());
    ASSERT_EQ(opened.error(), "");
    EXPECT_EQ((*opened.device)->calibration()->color->fx, 600);
    EXPECT_EQ((*opened.device)->info().note, "measured");
    address.width = 320;
    address.height = 240;
    EXPECT_THAT(open(webcam(), address.to_string()).error(), HasSubstr("640x480"));
    address.calibration = (folder / "none.json").string();
    EXPECT_THAT(open(webcam(), address.to_string()).error(), HasSubstr("none.json"));
}

}  // namespace
}  // namespace kino
