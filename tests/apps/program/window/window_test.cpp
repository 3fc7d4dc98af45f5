#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "../program_runner.h"
#include "tests/support/temp_dir.h"

namespace kino {
namespace {

using test::ProgramResult;
using test::TempDir;
using testing::HasSubstr;

class WindowTest : public testing::Test {
  protected:
    void SetUp() override {
        ASSERT_TRUE(std::filesystem::exists("/usr/bin/xvfb-run")) << "xvfb is in packages.txt";
    }
    ProgramResult run(std::vector<std::string> arguments) {
        return test::run_program({.arguments = std::move(arguments),
                                  .environment = {"XDG_CONFIG_HOME=" + temp.path().string(),
                                                  "KINO_VALIDATION=1", "WAYLAND_DISPLAY"},
                                  .wrapper = {"xvfb-run", "-a", "-s", "-screen 0 1280x800x24"}});
    }
    [[nodiscard]] std::filesystem::path settings_file() const {
        return temp / "kinoscope/settings.json";
    }
    TempDir temp;
};

TEST_F(WindowTest, ShowsTheOfficeAndEndsByItself) {
    const ProgramResult result = run({"replay", test::bundled("office"), "--frames", "30"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_THAT(result.err, testing::Not(HasSubstr("vulkan:"))) << result.err;
}

TEST_F(WindowTest, RemembersSettings) {
    ASSERT_EQ(run({"replay", test::bundled("office"), "--frames", "3", "--size", "500x400",
                   "--style", "cloud", "--view", "sensor"})
                  .exit_code,
              0);
    const auto saved = nlohmann::json::parse(test::read_bytes(settings_file()));
    EXPECT_EQ(saved["style"], "cloud");
    EXPECT_EQ(saved["view"], "sensor");
    EXPECT_EQ(saved["width"], 500);
    EXPECT_EQ(saved["height"], 400);
    ASSERT_EQ(run({"replay", test::bundled("office"), "--frames", "3"}).exit_code, 0);
    EXPECT_EQ(nlohmann::json::parse(test::read_bytes(settings_file())), saved);
}

TEST_F(WindowTest, DamagedSettingsAreToldAndReplaced) {
    temp.write("kinoscope/settings.json", "{\"width\": 1280, \"hei");
    const ProgramResult result = run({"replay", test::bundled("office"), "--frames", "3"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_THAT(result.err, HasSubstr("settings.json"));
    EXPECT_EQ(nlohmann::json::parse(test::read_bytes(settings_file()))["width"], 1280);
}

TEST_F(WindowTest, SteppedAndSeveralSources) {
    const auto recording = test::write_tiny_recording(temp / "tiny", 4);
    const ProgramResult result = run({"replay", recording.string(), test::bundled("office"),
                                      "--stepped", "--frames", "12", "--size", "400x300"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_THAT(result.err, testing::Not(HasSubstr("vulkan:"))) << result.err;
}

TEST_F(WindowTest, DemoWithoutASensorPlaysItsPerformance) {
    const ProgramResult result = run({"demo", "--frames", "25", "--size", "320x180", "--json"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_THAT(result.err, testing::Not(HasSubstr("vulkan:"))) << result.err;
    const auto report = nlohmann::json::parse(result.out);
    EXPECT_EQ(report["pictures"], 25);
    EXPECT_GT(report["first_picture_ms"], 0);
}

}  // namespace
}  // namespace kino
