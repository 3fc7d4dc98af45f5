#include "sensor/kinect1/kinect1_driver.h"

#include <gtest/gtest.h>

#include <cmath>

#include "collected.h"
#include "fake_kinect.h"
#include "sensor/kinect1/kinect1_address.h"
#include "sensor/kinect1/kinect1_units.h"
#include "sensor/kinect1/motor.h"

namespace kino::kinect1 {
namespace {

using test::Collected;
using test::FakeKinect;
using usb::Failure;
using Writes = std::vector<std::pair<int, int>>;

constexpr StreamId kDepth{0, StreamKind::depth};
constexpr StreamId kColor{0, StreamKind::color};
constexpr StreamId kInfrared{0, StreamKind::infrared};
constexpr StreamId kMotion{0, StreamKind::motion};
constexpr const char* kSerial = "A00364A07684047A";

std::unique_ptr<LiveDevice> open(const std::shared_ptr<FakeKinect>& fake,
                                 const std::string& address = {}) {
    auto opened = kinect1_driver(fake).open(address);
    EXPECT_TRUE(opened) << opened.error().to_string();
    return opened ? std::move(*opened) : nullptr;
}

TEST(Kinect1Driver, ListsAndOpensBySerial) {
    const auto fake = FakeKinect::make();
    const DeviceDriver driver = kinect1_driver(fake);
    const auto entries = driver.list();
    ASSERT_EQ(entries.size(), 1u);
    EXPECT_EQ(entries[0].uri, std::string("kinect1:") + kSerial);
    EXPECT_EQ(entries[0].problem, "");
    const auto device = open(fake, kSerial);
    EXPECT_EQ(device->address(), kSerial);
    EXPECT_EQ(device->info().serial, kSerial);
    EXPECT_EQ(device->info().name, "Kinect v1, model 1414");
    EXPECT_EQ(device->info().streams.size(), 4u);
    EXPECT_EQ(fake->open_handles(), 2);
}

TEST(Kinect1Driver, ClosesEverything) {
    const auto fake = FakeKinect::make();
    {
        Collected collected;
        const auto device = open(fake);
        ASSERT_TRUE(device->start(kDepth, collected));
        ASSERT_TRUE(device->start(kColor, collected));
        ASSERT_TRUE(device->start(kMotion, collected));
    }
    EXPECT_EQ(fake->open_handles(), 0);
    // Nothing is left running, nor the projector on.
    EXPECT_EQ(fake->camera.camera_register(0x05), 0);
    EXPECT_EQ(fake->camera.camera_register(0x06), 0);
}

TEST(Kinect1Driver, RegistersInTheOrderThatIsKnownToWork) {
    const auto fake = FakeKinect::make();
    const auto device = open(fake);
    Collected collected;
    ASSERT_TRUE(device->start(kDepth, collected));
    ASSERT_TRUE(device->start(kColor, collected));
    device->stop(kDepth);
    EXPECT_EQ(fake->camera.writes(), (Writes{{0x105, 0},
                                             {0x06, 0},
                                             {0x12, 3},
                                             {0x13, 1},
                                             {0x14, 0x1e},
                                             {0x06, 2},
                                             {0x17, 0},
                                             {0x0c, 0},
                                             {0x0d, 1},
                                             {0x0e, 0x1e},
                                             {0x05, 1},
                                             {0x47, 0},
                                             {0x06, 0}}));
    device->stop(kColor);
    ASSERT_TRUE(device->start(kInfrared, collected));
    EXPECT_EQ(fake->camera.camera_register(0x05), 3);
}

TEST(Kinect1Driver, ColourAndInfraredExcludeEachOther) {
    const auto fake = FakeKinect::make();
    const auto device = open(fake);
    Collected collected;
    ASSERT_TRUE(device->start(kColor, collected));
    const auto second = device->start(kInfrared, collected);
    ASSERT_FALSE(second);
    EXPECT_NE(second.error().what.find("at the same time"), std::string::npos);
    EXPECT_NE(second.error().hint.find("stop"), std::string::npos);
    device->stop(kColor);
    EXPECT_TRUE(device->start(kInfrared, collected));
    EXPECT_TRUE(device->start(kInfrared, collected));  // runs already
    EXPECT_FALSE(device->start({1, StreamKind::depth}, collected));
    EXPECT_FALSE(device->start({0, StreamKind::bodies}, collected));
}

TEST(Kinect1Driver, NothingIsPutAfterStop) {
    const auto fake = FakeKinect::make();
    const auto device = open(fake);
    Collected collected;
    ASSERT_TRUE(device->start(kDepth, collected));
    ASSERT_TRUE(
        fake->send_frame(CameraMode::depth_11bit, test::random_frame(CameraMode::depth_11bit, 1)));
    device->stop(kDepth);
    EXPECT_FALSE(
        fake->send_frame(CameraMode::depth_11bit, test::random_frame(CameraMode::depth_11bit, 1)));
    EXPECT_EQ(collected.count(), 1u);
    // And it starts again.
    ASSERT_TRUE(device->start(kDepth, collected));
    ASSERT_TRUE(
        fake->send_frame(CameraMode::depth_11bit, test::random_frame(CameraMode::depth_11bit, 1)));
    EXPECT_EQ(collected.count(), 2u);
}

TEST(Kinect1Driver, UnpluggingIsSaidOnce) {
    const auto fake = FakeKinect::make();
    auto device = open(fake);
    Collected collected;
    ASSERT_TRUE(device->start(kDepth, collected));
    ASSERT_TRUE(device->start(kColor, collected));
    ASSERT_TRUE(device->start(kMotion, collected));
    fake->unplug();
    EXPECT_FALSE(device->start(kInfrared, collected));
    const auto control = device->controls()->get("ir_brightness");
    ASSERT_FALSE(control);
    EXPECT_FALSE(control.error().what.empty());
    device->stop(kMotion);
    EXPECT_EQ(collected.losses().size(), 1u);
    EXPECT_EQ(collected.after_loss(), 0);
    device.reset();
    EXPECT_EQ(collected.losses().size(), 1u);
    EXPECT_EQ(fake->open_handles(), 0);
}

TEST(Kinect1Driver, AStreamThatEndsIsALoss) {
    for (const auto why : {Failure::io, Failure::no_memory, Failure::no_device}) {
        const auto fake = FakeKinect::make();
        const auto device = open(fake);
        Collected collected;
        ASSERT_TRUE(device->start(kDepth, collected));
        fake->end_stream(0x82, why);
        ASSERT_EQ(collected.losses().size(), 1u);
        EXPECT_NE(collected.losses()[0].find(usb::describe(why)), std::string::npos);
    }
}

TEST(Kinect1Driver, EveryFailureToOpenIsReadable) {
    using Failures = FakeKinect::Failures;
    for (const auto failure :
         {Failure::no_permission, Failure::busy, Failure::no_device, Failure::io,
          Failure::not_found, Failure::no_memory, Failure::timeout, Failure::unsupported}) {
        for (const Failures& failures :
             {Failures{.list = failure}, Failures{.open_camera = failure},
              Failures{.claim = failure}}) {
            const auto fake = FakeKinect::make();
            fake->set_failures(failures);
            const auto opened = kinect1_driver(fake).open("");
            ASSERT_FALSE(opened);
            EXPECT_FALSE(opened.error().what.empty());
            EXPECT_EQ(opened.error().where, "kinect1:");
            if (failure == Failure::no_permission) {
                EXPECT_NE(opened.error().hint.find("udev"), std::string::npos);
            }
            if (failure == Failure::busy) {
                EXPECT_NE(opened.error().hint.find("other program"), std::string::npos);
            }
            EXPECT_EQ(fake->open_handles(), 0);
        }
    }
}

TEST(Kinect1Driver, AClosedDeviceIsListedWithTheRule) {
    const auto fake = FakeKinect::make();
    fake->set_failures({.open_camera = Failure::no_permission});
    const auto entries = kinect1_driver(fake).list();
    ASSERT_EQ(entries.size(), 1u);
    EXPECT_EQ(entries[0].serial, kSerial);
    EXPECT_NE(entries[0].problem.find("udev"), std::string::npos) << entries[0].problem;
}

TEST(Kinect1Driver, EveryFailureToStreamIsReadable) {
    for (const auto failure :
         {Failure::no_memory, Failure::io, Failure::no_device, Failure::not_found, Failure::busy}) {
        const auto fake = FakeKinect::make();
        const auto device = open(fake);
        fake->set_failures({.stream = failure});
        Collected collected;
        const auto started = device->start(kDepth, collected);
        ASSERT_FALSE(started);
        EXPECT_NE(started.error().what.find("depth does not start"), std::string::npos);
        fake->set_failures({});
        EXPECT_TRUE(device->start(kDepth, collected));
    }
}

TEST(Kinect1Driver, ACameraThatDoesNotAnswerFailsToStartAndLeavesNothingRunning) {
    const auto fake = FakeKinect::make();
    const auto device = open(fake);
    fake->camera.fail_out({Failure::stall, Failure::stall, Failure::stall});
    Collected collected;
    const auto started = device->start(kDepth, collected);
    ASSERT_FALSE(started);
    EXPECT_NE(started.error().what.find("register 0x105"), std::string::npos)
        << started.error().what;
    EXPECT_FALSE(fake->running(0x82));
    EXPECT_TRUE(device->start(kDepth, collected));
}

TEST(Kinect1Driver, WithoutMotorOnlyMotionIsMissing) {
    const auto fake = FakeKinect::make({.has_motor = false});
    const auto device = open(fake);
    EXPECT_EQ(device->info().streams.size(), 3u);
    Collected collected;
    EXPECT_TRUE(device->start(kDepth, collected));
    EXPECT_FALSE(device->start(kMotion, collected));
    EXPECT_FALSE(device->controls()->set("tilt", 3));
}

TEST(Kinect1Driver, AClosedMotorDoesNotCostThePictures) {
    const auto fake = FakeKinect::make();
    fake->set_failures({.open_motor = Failure::no_permission});
    const auto device = open(fake);
    EXPECT_NE(device->info().note.find("permission denied"), std::string::npos);
    Collected collected;
    EXPECT_TRUE(device->start(kDepth, collected));
}

TEST(Kinect1Driver, LaterModelsNameTheFirmware) {
    const auto fake = FakeKinect::make({.release = 0x0114,
                                        .camera_serial = "0000000000000000",
                                        .has_motor = false,
                                        .audio_serial = "B44886123456789A"});
    const auto device = open(fake);
    EXPECT_EQ(device->address(), "B44886123456789A");
    EXPECT_EQ(device->info().name, "Kinect v1, model 1473");
    const auto tilt = device->controls()->set("tilt", 0);
    ASSERT_FALSE(tilt);
    EXPECT_NE(tilt.error().what.find("firmware"), std::string::npos);
    EXPECT_NE(tilt.error().what.find("1473"), std::string::npos);
    for (const Control& control : device->controls()->list()) {
        EXPECT_NE(control.id, "tilt");
        EXPECT_NE(control.id, "led");
    }
    // By the serial that the audio part gave.
    EXPECT_TRUE(kinect1_driver(fake).open("B44886123456789A"));
}

TEST(Kinect1Driver, TheOneForWindowsTakesItsSecondSetting) {
    const auto fake = FakeKinect::make({.camera_product = 0x02bf, .has_motor = false});
    const auto device = open(fake);
    EXPECT_EQ(fake->alternate_setting(), 1);
    EXPECT_EQ(device->info().name, "Kinect v1, model for Windows");
    fake->set_failures({.alternate = Failure::io});
    EXPECT_FALSE(kinect1_driver(fake).open(""));
}

TEST(Kinect1Driver, WhatIsNotThereIsSaid) {
    const auto fake = FakeKinect::make();
    const auto other = kinect1_driver(fake).open("B1");
    ASSERT_FALSE(other);
    EXPECT_NE(other.error().hint.find(kSerial), std::string::npos);
    fake->unplug();
    const auto none = kinect1_driver(fake).open("");
    ASSERT_FALSE(none);
    EXPECT_NE(none.error().what.find("no Kinect v1"), std::string::npos);
    EXPECT_TRUE(kinect1_driver(fake).list().empty());

    const auto powerless = FakeKinect::make({.has_camera = false});
    const auto entries = kinect1_driver(powerless).list();
    ASSERT_EQ(entries.size(), 1u);
    EXPECT_NE(entries[0].problem.find("power supply"), std::string::npos);
    EXPECT_NE(kinect1_driver(powerless).open("").error().hint.find("power supply"),
              std::string::npos);
}

TEST(Kinect1Driver, FactoryCalibrationIsRead) {
    const auto fake = FakeKinect::make();
    fake->camera.set_block(Command::fixed_parameters, 0,
                           test::zero_plane_block(7.6F, 2.4F, 121, 0.105F));
    fake->camera.set_block(Command::algorithm_parameters, 0, {0, 0, 201, 0});
    const auto rig = open(fake)->calibration();
    ASSERT_TRUE(rig);
    EXPECT_NEAR(rig->disparity.emitter_distance_cm, 7.6, 1e-6);
    EXPECT_NEAR(rig->disparity.reference_distance_cm, 121, 1e-6);
    EXPECT_NEAR(rig->disparity.reference_pixel_size_mm, 0.105, 1e-6);
    EXPECT_EQ(rig->disparity.const_shift, 201);
    EXPECT_EQ(rig->serial, kSerial);
    EXPECT_EQ(rig->note.substr(0, 19), "factory calibration") << rig->note;
}

TEST(Kinect1Driver, WithoutFactoryCalibrationItOpensAndSaysSo) {
    const auto fake = FakeKinect::make();
    fake->camera.set_block(Command::algorithm_parameters, 0x40, test::Bytes(60));
    const auto rig = open(fake)->calibration();
    ASSERT_TRUE(rig);
    EXPECT_NE(rig->note.find("default cameras"), std::string::npos);
    EXPECT_NE(rig->note.find("registration"), std::string::npos);
}

TEST(Kinect1Controls, SetWhatTheDeviceHas) {
    const auto fake = FakeKinect::make();
    const auto device = open(fake);
    Controls& controls = *device->controls();
    std::vector<std::string> ids;
    for (const Control& control : controls.list()) ids.push_back(control.id);
    EXPECT_EQ(ids, (std::vector<std::string>{"tilt", "led", "white_balance_auto", "exposure_auto",
                                             "ir_brightness"}));
    ASSERT_TRUE(controls.set("tilt", -10.5));
    EXPECT_EQ(fake->motor_angle_halves, -21);
    EXPECT_EQ(controls.get("tilt").value(), -10.5);
    ASSERT_TRUE(controls.set("led", 5));
    EXPECT_EQ(fake->led, 6);
    EXPECT_EQ(controls.get("led").value(), 5);
    const std::uint16_t flags = fake->camera.color_register(0x106);
    ASSERT_TRUE(controls.set("white_balance_auto", 0));
    EXPECT_EQ(fake->camera.color_register(0x106), flags & ~2);
    ASSERT_TRUE(controls.set("exposure_auto", 0));
    EXPECT_EQ(fake->camera.color_register(0x106), flags & ~2 & ~(1 << 14));
    EXPECT_EQ(controls.get("exposure_auto").value(), 0);
    ASSERT_TRUE(controls.set("white_balance_auto", 1));
    EXPECT_EQ(controls.get("white_balance_auto").value(), 1);
    EXPECT_EQ(fake->camera.color_register(0x106), flags & ~(1 << 14));
    ASSERT_TRUE(controls.set("ir_brightness", 7));
    EXPECT_EQ(fake->camera.camera_register(0x15), 7);
    EXPECT_EQ(controls.get("ir_brightness").value(), 7);
}

TEST(Kinect1Controls, RefuseWhatIsOutOfRange) {
    const auto fake = FakeKinect::make();
    const auto device = open(fake);
    for (const auto& [id, value] : std::vector<std::pair<const char*, double>>{
             {"tilt", 31.5}, {"tilt", -32}, {"tilt", NAN}, {"led", 6}, {"ir_brightness", 0}}) {
        EXPECT_FALSE(device->controls()->set(id, value)) << id << " " << value;
    }
    EXPECT_FALSE(device->controls()->set("warp", 1));
    EXPECT_FALSE(device->controls()->get("warp"));
    EXPECT_EQ(fake->motor_angle_halves, 0);
}

TEST(Motor, AxesAndAngle) {
    // Level: the chip feels 1 g upwards, which is -y of the camera.
    const test::Bytes level = {0, 0, 0, 0, 0x03, 0x33, 0, 0, 20, 0};
    const auto state = parse_motor_state(level);
    ASSERT_TRUE(state);
    EXPECT_NEAR(state->acceleration_m_s2[1], -9.80665, 1e-9);
    EXPECT_EQ(state->tilt_deg, 10.0);
    test::Bytes moving = level;
    moving[8] = 0x80;
    EXPECT_FALSE(parse_motor_state(moving)->tilt_deg);
    moving = level;
    moving[9] = 4;
    EXPECT_FALSE(parse_motor_state(moving)->tilt_deg);
    test::Bytes negative = level;
    negative[2] = 0xFF;
    negative[3] = 0xFF;
    EXPECT_NEAR(parse_motor_state(negative)->acceleration_m_s2[0], 9.80665 / 819, 1e-9);
    EXPECT_FALSE(parse_motor_state(test::Bytes(9)));
}

// Whatever this machine has plugged in, or no USB at all.
TEST(LibusbBus, CanBeAsked) {
    const auto devices = usb::libusb_bus()->list(0x045e);
    EXPECT_TRUE(devices || !devices.error().what.empty());
    const auto opened = usb::libusb_bus()->open({.port = "99-9", .address = 999});
    ASSERT_FALSE(opened);
    EXPECT_FALSE(opened.error().what.empty());
}

TEST(Units, PartsBehindOneHubBelongTogether) {
    const auto id = [](std::uint16_t product, const char* port, const char* parent,
                       const char* serial) {
        return usb::DeviceId{0x045e, product, 0x010b, port, parent, 1, serial, 1};
    };
    const auto units = group_units({id(0x02ae, "1-1.1", "1-1", "A"), id(0x02b0, "1-2.2", "1-2", ""),
                                    id(0x02ae, "1-2.1", "1-2", "B"), id(0x02b0, "1-1.2", "1-1", ""),
                                    id(0x02b0, "1-3.2", "1-3", ""), id(0x0719, "1-4", "1", "")});
    ASSERT_EQ(units.size(), 3u);
    EXPECT_EQ(units[0].motor->port, "1-1.2");
    EXPECT_EQ(units[1].motor->port, "1-2.2");
    EXPECT_EQ(units[1].serial, "B");
    EXPECT_FALSE(units[2].camera);
}

TEST(Address, SurvivesItsText) {
    for (const char* text :
         {"", "A1", "A1?color=yuv", "?color=bayer-high&depth=10", "A1?depth=10"}) {
        const auto address = parse_address(text);
        ASSERT_TRUE(address) << text;
        EXPECT_EQ(to_text(*address), text);
    }
    EXPECT_EQ(to_text(parse_address("A1?color=bayer&depth=11").value()), "A1");
    for (const char* text : {"?", "A1?depth=12", "A1?color=", "?color=yuv&", "A1?depth=10?x"}) {
        const auto address = parse_address(text);
        ASSERT_FALSE(address) << text;
        EXPECT_NE(address.error().hint.find("color=bayer|bayer-high|yuv"), std::string::npos);
    }
}

}  // namespace
}  // namespace kino::kinect1
