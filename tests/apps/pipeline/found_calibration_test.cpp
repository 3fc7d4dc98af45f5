#include "apps/pipeline/found_calibration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <thread>

#include "apps/pipeline/live_runner.h"
#include "calibration/files/calibration_store.h"
#include "counting_source.h"
#include "fake_device.h"
#include "sensor/live/live_source.h"
#include "sensor/rig_json.h"
#include "sensor/session/session_source.h"
#include "tests/support/temp_dir.h"

namespace kino {
namespace {

using testing::HasSubstr;

// What the fake device would not say of itself.
RigParameters calibrated(const std::string& serial, int size = 2) {
    RigParameters rig;
    rig.serial = serial;
    rig.depth = {.width = size, .height = size, .fx = 1.25 * size, .fy = 1.25 * size};
    rig.depth.cx = rig.depth.cy = (size - 1) / 2.0 + 0.01 * size;
    rig.color = rig.depth;
    rig.color->k1 = 0.125;
    rig.color_from_depth.translation = {-0.0625, 0, 0};
    return rig;
}

class FoundCalibrationOfADevice : public testing::Test {
  protected:
    void SetUp() override {
        if (const char* old = std::getenv("XDG_CONFIG_HOME")) former_ = old;
        ::setenv("XDG_CONFIG_HOME", temp.path().c_str(), 1);
        folder = calibration_folder().value();
        bus.plug("A1/b");
    }
    void TearDown() override {
        if (former_.empty()) {
            ::unsetenv("XDG_CONFIG_HOME");
        } else {
            ::setenv("XDG_CONFIG_HOME", former_.c_str(), 1);
        }
    }

    std::unique_ptr<Source> device() {
        LiveOptions options;
        options.watch = [this] { return bus.watch(); };
        auto source = make_live_source(bus.driver(), "A1/b", options);
        EXPECT_TRUE(source) << source.error().to_string();
        return std::move(*source);
    }

    Result<FoundCalibration> find(const std::string& choice = {}) {
        const auto source = device();
        return find_calibration(*source, choice);
    }

    test::TempDir temp;
    test::FakeBus bus;
    std::filesystem::path folder;

  private:
    std::string former_;
};

TEST_F(FoundCalibrationOfADevice, WithoutAFileItIsItsOwn) {
    const auto found = find();
    ASSERT_TRUE(found) << found.error().to_string();
    EXPECT_EQ(found->file, "");
    EXPECT_EQ(found->rig.depth.fx, 2);
    // Another device's file is nothing to it.
    ASSERT_TRUE(store_calibration(folder, calibrated("A1")));
    EXPECT_EQ(find()->file, "");
}

TEST_F(FoundCalibrationOfADevice, TheFileOfItsSerialNumberIsUsed) {
    const auto file = store_calibration(folder, calibrated("A1/b"));
    ASSERT_TRUE(file);
    const auto found = find();
    ASSERT_TRUE(found) << found.error().to_string();
    EXPECT_EQ(found->file, file->string());
    EXPECT_EQ(found->rig, calibrated("A1/b"));
    EXPECT_EQ(find("none")->rig.depth.fx, 2);
    EXPECT_EQ(find("none")->file, "");
}

TEST_F(FoundCalibrationOfADevice, AnotherModeOfTheSameCameraIsScaled) {
    ASSERT_TRUE(store_calibration(folder, calibrated("A1/b", 4)));
    const auto found = find();
    ASSERT_TRUE(found) << found.error().to_string();
    EXPECT_EQ(found->rig.depth.width, 2);
    EXPECT_EQ(found->rig.depth.fx, 2.5);
    EXPECT_NEAR(found->rig.depth.cx, (1.54 + 0.5) / 2 - 0.5, 1e-12);
    EXPECT_EQ(found->rig.color->width, 2);
    EXPECT_EQ(found->rig.color->k1, 0.125);
}

TEST_F(FoundCalibrationOfADevice, WhatCannotBeUsedIsSaid) {
    RigParameters wide = calibrated("A1/b");
    wide.depth.width = 3;
    ASSERT_TRUE(store_calibration(folder, wide));
    auto found = find();
    ASSERT_FALSE(found);
    EXPECT_THAT(found.error().to_string(), HasSubstr("the depth camera is calibrated at 3x2"));
    EXPECT_THAT(found.error().to_string(), HasSubstr("--calibration none"));
    EXPECT_TRUE(find("none"));

    std::ofstream(calibration_file(folder, "A1/b")) << "{";
    found = find();
    ASSERT_FALSE(found);
    EXPECT_THAT(found.error().to_string(), HasSubstr("A1%2Fb.json"));
    EXPECT_THAT(found.error().to_string(), HasSubstr("--calibration none"));

    EXPECT_FALSE(find((temp / "nowhere.json").string()));

    SourceInfo registered;
    registered.uri = "openni2:?registration=on";
    const auto refused = fit_calibration(calibrated("A"), calibrated("A"), registered);
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().what, HasSubstr("registered depth to colour itself"));
}

TEST_F(FoundCalibrationOfADevice, AFileThatIsNamedGoesForAnySource) {
    const auto file = temp / "mine.json";
    RigParameters mine = calibrated("");
    ASSERT_TRUE(write_rig_file(file, mine));
    const auto found = find(file.string());
    ASSERT_TRUE(found) << found.error().to_string();
    mine.serial = "A1/b";
    EXPECT_EQ(found->rig, mine);

    // A recording keeps its own unless told otherwise.
    mine.depth = {.width = 16, .height = 12, .fx = 20, .fy = 20, .cx = 7.5, .cy = 5.5};
    ASSERT_TRUE(write_rig_file(temp / "eight.json", mine));
    test::CountingSource recording({.with_timeline = true, .with_color = false});
    EXPECT_EQ(find_calibration(recording, "")->rig.depth.fx, 8);
    const auto forced = find_calibration(recording, (temp / "eight.json").string());
    ASSERT_TRUE(forced) << forced.error().to_string();
    EXPECT_EQ(forced->rig.depth.fx, 10);
    EXPECT_FALSE(forced->rig.color);
}

TEST_F(FoundCalibrationOfADevice, SessionsCarryIt) {
    const auto kept = store_calibration(folder, calibrated("A1/b"));
    ASSERT_TRUE(kept);
    testing::internal::CaptureStderr();
    auto opened = prepare_for_playing(device());
    const std::string said = testing::internal::GetCapturedStderr();
    ASSERT_TRUE(opened) << opened.error().to_string();
    EXPECT_THAT(said, HasSubstr("calibration of A1/b from " + kept->string()));
    EXPECT_EQ(opened->calibration.file, kept->string());
    EXPECT_EQ(opened->processor.rig().parameters(), calibrated("A1/b"));

    const auto session = temp / "with.mkv";
    LiveRunner runner(std::move(*opened));
    ASSERT_TRUE(runner.start_recording(session, SessionCodec::raw));
    const TimeNs until = now_ns() + 20 * kNsPerSecond;
    while (runner.status().recording->frames == 0 && now_ns() < until) {
        const TimeNs time = now_ns();
        ASSERT_TRUE(
            bus.put("A1/b", StreamKind::depth, test::fake_frame(StreamKind::depth, 1, time)));
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    runner.stop();
    auto source = session_opener().open(session.string());
    ASSERT_TRUE(source) << source.error().to_string();
    EXPECT_EQ((*source)->calibration().value(), calibrated("A1/b"));
}

}  // namespace
}  // namespace kino
