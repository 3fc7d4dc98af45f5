// What must hold of the live path in the guest machine. The guest boots once for all tests here; a
// machine that cannot run it fails them.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
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

// Not a law of ours but the reason for one: pixels of an earlier frame, and nobody is told.
TEST_F(Device, LibfreenectHandsOutStalePixelsUnderLoss) {
    for (const char* scenario : {"freenect_loss_1", "freenect_loss_5", "freenect_loss_10"}) {
        expect_sound(scenario);
        EXPECT_GE(value(scenario, "depth_frames"), 12) << scenario;
        EXPECT_GT(value(scenario, "depth_stale_pixels"), 0) << scenario;
    }
}

TEST_F(Device, LibfreenectSeesTheFakeLeave) {
    expect_sound("freenect_unplug");
    EXPECT_EQ(value("freenect_unplug", "noticed"), 1);
}

TEST_F(Device, KernelDriverReadsTheFakeBitByBit) {
    for (const char* scenario : {"gspca_depth", "gspca_color", "gspca_infrared"}) {
        expect_sound(scenario);
        EXPECT_GE(value(scenario, "frames"), 4) << scenario;
        EXPECT_EQ(value(scenario, "equal"), value(scenario, "frames")) << scenario;
        EXPECT_EQ(value(scenario, "in_order"), value(scenario, "frames")) << scenario;
        EXPECT_EQ(value(scenario, "bad_commands"), 0) << scenario;
    }
}

// The kernel gives short frames as if nothing were wrong: only their size tells.
TEST_F(Device, KernelDriverDoesNotMarkShortFrames) {
    expect_sound("gspca_loss_1");
    EXPECT_LT(value("gspca_loss_1", "full_size"), value("gspca_loss_1", "frames"));
    EXPECT_EQ(value("gspca_loss_1", "equal"), value("gspca_loss_1", "full_size"));
    EXPECT_EQ(value("gspca_loss_1", "marked_bad"), 0);
}

TEST_F(Device, KernelDriverSaysThatTheFakeHasLeft) {
    expect_sound("gspca_unplug");
    EXPECT_EQ(value("gspca_unplug", "no_such_device"), 1);
}

TEST_F(Device, VividGivesEveryFormat) {
    expect_sound("vivid_formats");
    for (const char* format : {"Y16", "Y10", "Y12", "GREY", "GRBG", "UYVY", "YUYV"}) {
        EXPECT_EQ(value("vivid_formats", std::string(format) + "_frames"), 3) << format;
    }
}

TEST_F(Device, VividMarksTheBufferItSpoilt) {
    expect_sound("vivid_flagged_buffers");
    EXPECT_EQ(value("vivid_flagged_buffers", "marked_bad"), 1);
}

}  // namespace
}  // namespace kino::guest
