// What must hold of the live path in the guest machine. The guest boots once for all tests here; a
// machine that cannot run it fails them.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <limits>
#include <string>

#include "tests/sensor/device/guest_run.h"

namespace kino::guest {
namespace {

constexpr int kSecondsAtMost = 380;

class Device : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        run_ = boot_guest(KINO_BOOT_SCRIPT, KINO_GUEST_FOLDER, KINO_GUEST_PROGRAM, kSecondsAtMost);
    }
    void SetUp() override {
        ASSERT_EQ(run_.status, 0) << run_.messages << run_.output;
        ASSERT_EQ(value("all", "done"), 1) << run_.output;
    }

    /// Not a number if the scenario did not say it.
    static double value(const std::string& scenario, const std::string& key) {
        const auto found = run_.values.find(scenario);
        if (found == run_.values.end() || !found->second.contains(key)) {
            return std::numeric_limits<double>::quiet_NaN();
        }
        return found->second.at(key);
    }
    static void expect_sound(const std::string& scenario) {
        EXPECT_THAT(run_.failures[scenario], testing::IsEmpty()) << scenario;
        EXPECT_TRUE(std::isfinite(value(scenario, "seconds"))) << scenario << " did not run";
    }
    /// At least `least` frames of the stream, all as sent.
    static void expect_all_equal(const std::string& scenario, const std::string& stream,
                                 double least) {
        EXPECT_GE(value(scenario, stream + "_frames"), least) << scenario;
        EXPECT_EQ(value(scenario, stream + "_equal"), value(scenario, stream + "_frames"))
            << scenario << " " << stream;
    }

    /// At least `least` frames, in order, none unaccounted for; what is not marked is what was
    /// sent, and what is marked is exactly what did not arrive.
    static void expect_true_stream(const std::string& scenario, const std::string& stream,
                                   double least) {
        EXPECT_GE(value(scenario, stream + "_frames"), least) << scenario;
        for (const char* count :
             {"_wrong_rows", "_stale_pixels", "_unknown", "_order", "_missing"}) {
            EXPECT_EQ(value(scenario, stream + count), 0) << scenario << " " << stream << count;
        }
        EXPECT_EQ(value(scenario, stream + "_equal") + value(scenario, stream + "_marked"),
                  value(scenario, stream + "_frames"))
            << scenario << " " << stream;
    }
    static void expect_whole_stream(const std::string& scenario, const std::string& stream,
                                    double least) {
        expect_true_stream(scenario, stream, least);
        expect_all_equal(scenario, stream, least);
        EXPECT_EQ(value(scenario, stream + "_lost"), 0) << scenario << " " << stream;
    }

    static GuestRun run_;
};
GuestRun Device::run_;

// The fake is a Kinect to the library that everybody uses: bit by bit what it sent.
TEST_F(Device, LibfreenectReadsTheFakeBitByBit) {
    expect_sound("freenect_streams");
    expect_all_equal("freenect_streams", "depth", 10);
    expect_all_equal("freenect_streams", "color", 10);
    EXPECT_EQ(value("freenect_streams", "bad_commands"), 0);
    expect_sound("freenect_10bit_infrared");
    expect_all_equal("freenect_10bit_infrared", "depth", 4);
    expect_all_equal("freenect_10bit_infrared", "infrared", 4);
}

TEST_F(Device, LibfreenectMovesTheFakesMotor) {
    expect_sound("freenect_motor");
    EXPECT_EQ(value("freenect_motor", "tilt_set_deg"), 12);
    EXPECT_EQ(value("freenect_motor", "tilt_deg"), 12);
    EXPECT_EQ(value("freenect_motor", "lamp"), 6);
    EXPECT_NEAR(value("freenect_motor", "acceleration_y"), 9.80665 * 815 / 819, 1e-6);
}

constexpr const char* kLosses[] = {"loss_0.2", "loss_1", "loss_5", "loss_10"};

// Not a law of ours but the reason for one: pixels of an earlier frame, and nobody is told.
TEST_F(Device, LibfreenectHandsOutStalePixelsUnderLoss) {
    for (const std::string loss : kLosses) {
        const std::string scenario = "freenect_" + loss;
        expect_sound(scenario);
        EXPECT_GE(value(scenario, "depth_frames"), 20) << scenario;
        EXPECT_GT(value(scenario, "depth_stale_pixels"), 0) << scenario;
    }
}

// The same losses, packet by packet: what is not marked is what was sent.
TEST_F(Device, OursHandsOutNoStalePixelUnderLoss) {
    for (const std::string loss : kLosses) {
        const std::string scenario = "kinect1_" + loss;
        expect_sound(scenario);
        expect_true_stream(scenario, "depth", 20);
        EXPECT_GT(value(scenario, "depth_marked"), 0) << scenario;
        std::printf(
            "%-8s  libfreenect: %6.0f stale pixels in %2.0f frames, none marked   "
            "ours: %3.0f in %2.0f frames, %2.0f marked\n",
            loss.c_str(), value("freenect_" + loss, "depth_stale_pixels"),
            value("freenect_" + loss, "depth_frames"), value(scenario, "depth_stale_pixels"),
            value(scenario, "depth_frames"), value(scenario, "depth_marked"));
    }
    EXPECT_GT(value("kinect1_loss_0.2", "depth_equal"), 0) << "no frame came whole";
    EXPECT_GT(value("kinect1_loss_10", "depth_lost"), 0) << "no frame lost its first packet";
}

TEST_F(Device, OursReadsTheFakeBitByBit) {
    expect_sound("kinect1_streams");
    expect_whole_stream("kinect1_streams", "depth", 12);
    expect_whole_stream("kinect1_streams", "color", 10);
    EXPECT_EQ(value("kinect1_streams", "bad_commands"), 0);
    EXPECT_EQ(value("kinect1_streams", "serial_known"), 1);
    EXPECT_EQ(value("kinect1_streams", "factory_constants"), 1);
    // The 60 MHz counter wraps in the first second; between frames its count is exact to a tick.
    EXPECT_LT(value("kinect1_streams", "depth_clock_us"), 0.02);
    expect_sound("kinect1_10bit_infrared");
    expect_whole_stream("kinect1_10bit_infrared", "depth", 5);
    expect_whole_stream("kinect1_10bit_infrared", "infrared", 5);
    for (const char* scenario : {"kinect1_large_color", "kinect1_yuv"}) {
        expect_sound(scenario);
        expect_whole_stream(scenario, "color", 2);
    }
}

TEST_F(Device, OursMovesTheFakesMotorAndFeelsItsWeight) {
    EXPECT_GE(value("kinect1_streams", "motion_frames"), 3);
    EXPECT_NEAR(value("kinect1_streams", "acceleration"),
                9.80665 / 819 * std::hypot(20.0, 815.0, 40.0), 1e-6);
    EXPECT_EQ(value("kinect1_streams", "tilt_set_deg"), -9);
    EXPECT_EQ(value("kinect1_streams", "lamp"), 2);
    EXPECT_EQ(value("kinect1_streams", "refuses_too_much"), 1);
}

TEST_F(Device, OursMarksEveryKindOfFaultRowByRow) {
    expect_sound("kinect1_every_fault");
    expect_true_stream("kinect1_every_fault", "depth", 12);
    EXPECT_GT(value("kinect1_every_fault", "depth_marked"), 0);
}

TEST_F(Device, OursTakesTheCameraFromTheKernelsDriver) {
    expect_sound("kinect1_over_kernel_driver");
    expect_whole_stream("kinect1_over_kernel_driver", "depth", 4);
}

TEST_F(Device, LibfreenectSeesTheFakeLeave) {
    expect_sound("freenect_unplug");
    EXPECT_EQ(value("freenect_unplug", "noticed"), 1);
}

TEST_F(Device, KernelDriverReadsTheFakeBitByBit) {
    expect_sound("gspca_depth");
    EXPECT_GE(value("gspca_depth", "frames"), 4);
    EXPECT_EQ(value("gspca_depth", "equal"), value("gspca_depth", "frames"));
    EXPECT_EQ(value("gspca_depth", "in_order"), value("gspca_depth", "frames"));
    EXPECT_EQ(value("gspca_depth", "bad_commands"), 0);
}

// The kernel gives short frames as if nothing were wrong: only their size tells.
TEST_F(Device, KernelDriverDoesNotMarkShortFrames) {
    expect_sound("gspca_loss_1");
    EXPECT_LT(value("gspca_loss_1", "full_size"), value("gspca_loss_1", "frames"));
    EXPECT_EQ(value("gspca_loss_1", "equal"), value("gspca_loss_1", "full_size"));
    EXPECT_EQ(value("gspca_loss_1", "marked_bad"), 0);
}

TEST_F(Device, OurV4l2ReadsTheKernelDriverBitByBit) {
    expect_sound("v4l2_kinect_depth");
    expect_whole_stream("v4l2_kinect_depth", "depth", 6);
    expect_sound("v4l2_kinect_color");
    expect_whole_stream("v4l2_kinect_color", "color", 5);
    expect_sound("v4l2_kinect_infrared");
    expect_whole_stream("v4l2_kinect_infrared", "infrared", 4);
}

// What the kernel hands on short is counted as lost, not shown.
TEST_F(Device, OurV4l2DropsTheKernelDriversShortFrames) {
    expect_sound("v4l2_kinect_loss_0.2");
    EXPECT_GE(value("v4l2_kinect_loss_0.2", "depth_frames"), 6);
    EXPECT_EQ(value("v4l2_kinect_loss_0.2", "depth_equal"),
              value("v4l2_kinect_loss_0.2", "depth_frames"));
    EXPECT_GT(value("v4l2_kinect_loss_0.2", "depth_lost"), 0);
}

TEST_F(Device, OurV4l2GoesOnWhenTheKinectIsPluggedInAgain) {
    expect_sound("v4l2_kinect_unplug");
    EXPECT_EQ(value("v4l2_kinect_unplug", "lost"), 1);
    EXPECT_EQ(value("v4l2_kinect_unplug", "back"), 1);
    EXPECT_GT(value("v4l2_kinect_unplug", "frames_before"), 0);
    expect_all_equal("v4l2_kinect_unplug", "resumed", 4);
}

TEST_F(Device, OurV4l2ReadsEveryFormatAsPlainCaptureDoes) {
    expect_sound("v4l2_vivid_formats");
    for (const char* format : {"Y16_depth", "Y16_infrared", "Y12_infrared", "Y10_infrared",
                               "GREY_infrared", "GRBG_color", "UYVY_color", "YUYV_color"}) {
        EXPECT_EQ(value("v4l2_vivid_formats", format), 1) << format;
    }
}

TEST_F(Device, OurV4l2OutlivesEveryErrorThatVividInjects) {
    for (const char* scenario : {"v4l2_vivid_flagged", "v4l2_vivid_dropped", "v4l2_vivid_fatal",
                                 "v4l2_vivid_disconnect"}) {
        expect_sound(scenario);
        EXPECT_GE(value(scenario, "frames_after"), 12) << scenario;
        EXPECT_EQ(value(scenario, "damaged"), 0) << scenario;
    }
    EXPECT_GE(value("v4l2_vivid_flagged", "lost_frames"), 1);
    EXPECT_EQ(value("v4l2_vivid_disconnect", "lost_events"), 1);
    EXPECT_EQ(value("v4l2_vivid_disconnect", "back_events"), 1);
    EXPECT_EQ(value("v4l2_vivid_flagged", "lost_events"), 0);
}

TEST_F(Device, RecordingGoesOnAcrossUnplugging) {
    for (const char* scenario : {"recording_ffv1", "recording_fast"}) {
        expect_sound(scenario);
        EXPECT_EQ(value(scenario, "lost"), 1) << scenario;
        EXPECT_EQ(value(scenario, "back"), 1) << scenario;
        EXPECT_GT(value(scenario, "frames_before"), 0) << scenario;
        EXPECT_GE(value(scenario, "frames_after"), 5) << scenario;
        EXPECT_EQ(value(scenario, "resumed_as_sent"), value(scenario, "frames_after")) << scenario;
        EXPECT_EQ(value(scenario, "rising"), 1) << scenario;
        EXPECT_EQ(value(scenario, "dropped"), 0) << scenario;
        EXPECT_EQ(value(scenario, "depth_same"), 1) << scenario;
        EXPECT_EQ(value(scenario, "color_same"), 1) << scenario;
        EXPECT_EQ(value(scenario, "lost_events"), 1) << scenario;
        EXPECT_EQ(value(scenario, "back_events"), 1) << scenario;
    }
}

}  // namespace
}  // namespace kino::guest
