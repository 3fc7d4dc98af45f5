#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/exit_codes.h"
#include "program_runner.h"
#include "sensor/png_io.h"
#include "tests/support/temp_dir.h"

namespace kino {
namespace {

using test::ProgramCall;
using test::ProgramResult;
using test::run;
using test::run_program;
using test::TempDir;
using testing::HasSubstr;

TEST(CommandLine, WrongUsageEndsWith2AndSaysWhy) {
    const std::vector<std::vector<std::string>> wrong = {
        {},
        {"dance"},
        {"replay"},
        {"replay", "synthetic:", "--raster", "crayon"},
        {"replay", "synthetic:", "--size", "12"},
        {"replay", "synthetic:", "--size", "640x480x3"},
        {"replay", "synthetic:", "--size", "0x0"},
        {"replay", "synthetic:", "--size", "99999x99999"},
        {"replay", "synthetic:", "--frames", "0"},
        {"replay", "synthetic:", "--frames", "many"},
        {"replay", "synthetic:", "--speed", "nan"},
        {"replay", "synthetic:", "--speed", "100"},
        {"replay", "synthetic:", "--splat", "-3"},
        {"replay", "synthetic:", "--wheels", "4"},
        {"replay", "synthetic:", "--filter", "rainbow"},
        {"live", "synthetic:", "--record", "a.mkv", "--headless", "out"},
        {"record", "synthetic:"},
        {"record", "synthetic:", "--out", "a.mkv", "--codec", "mp3"},
        {"record", "synthetic:", "--out", "a.mkv", "--seconds", "-1"},
        {"record", "synthetic:", "--out", "a.mkv", "--seconds", "nan"},
        {"record", "synthetic:", "--out", "a.mkv", "--out", "b.mkv"},
        {"convert", "recordings/desk", "a.mkv", "--scale", "nan"},
        {"convert", "recordings/desk", "--motion", "a.bvh", "--rate", "nan"},
        {"repair"},
        {"compare", "one.png"},
    };
    for (const auto& arguments : wrong) {
        const ProgramResult result = run(arguments);
        EXPECT_EQ(result.exit_code, kExitUsage) << testing::PrintToString(arguments);
        EXPECT_FALSE(result.err.empty()) << testing::PrintToString(arguments);
    }
}

TEST(CommandLine, HelpAndVersionEndWell) {
    const ProgramResult help = run({"--help"});
    EXPECT_EQ(help.exit_code, kExitDone);
    EXPECT_THAT(help.out, HasSubstr("Exit status"));
    const ProgramResult replay = run({"replay", "--help"});
    EXPECT_EQ(replay.exit_code, kExitDone);
    EXPECT_THAT(replay.out, HasSubstr("--headless"));
    EXPECT_THAT(replay.out, HasSubstr("pause, go on"));
    EXPECT_THAT(run({"--version"}).out, HasSubstr("kinoscope 0."));
}

TEST(CommandLine, EveryCommandsHelpEndsWithTheExitCodes) {
    for (const char* command :
         {"demo", "live", "replay", "record", "convert", "repair", "devices", "compare"}) {
        EXPECT_THAT(run({command, "--help"}).out, HasSubstr(kExitCodesText)) << command;
    }
}

TEST(CommandLine, AMistypedCommandIsToldTheNearest) {
    const ProgramResult result = run({"repaly", "recordings/desk"});
    EXPECT_EQ(result.exit_code, kExitUsage);
    EXPECT_THAT(result.err, HasSubstr("\"repaly\" (did you mean \"replay\"?"));
    EXPECT_THAT(run({"xylophone"}).err, testing::Not(HasSubstr("did you mean")));
}

TEST(CommandLine, OutputThatCannotBeWrittenIsAFailure) {
    const ProgramResult result = run_program(
        {.arguments = {"devices"}, .wrapper = {"sh", "-c", R"(exec "$0" "$@" > /dev/full)"}});
    EXPECT_EQ(result.exit_code, kExitFailed);
    EXPECT_THAT(result.err, HasSubstr("standard output"));
}

TEST(CommandLine, WhatCannotBeOpenedIsNamed) {
    const TempDir temp;
    const std::string out = temp / "out";
    const ProgramResult missing = run({"replay", "no/such/folder", "--headless", out});
    EXPECT_EQ(missing.exit_code, kExitFailed);
    EXPECT_THAT(missing.err, HasSubstr("no/such/folder"));
    const ProgramResult scheme = run({"replay", "teleport:home", "--headless", out});
    EXPECT_EQ(scheme.exit_code, kExitFailed);
    EXPECT_THAT(scheme.err, HasSubstr("teleport"));
    EXPECT_THAT(scheme.err, HasSubstr("synthetic:"));
    const ProgramResult empty = run({"replay", temp.path(), "--headless", out});
    EXPECT_EQ(empty.exit_code, kExitFailed);
    EXPECT_THAT(empty.out, testing::IsEmpty()) << "nothing was drawn";
}

TEST(CommandLine, AFolderThatCannotBeMadeIsNamed) {
    const TempDir temp;
    const std::filesystem::path file = temp.write("file", "x");
    const ProgramResult result = run({"replay", "synthetic:", "--headless", file / "below"});
    EXPECT_EQ(result.exit_code, kExitFailed);
    EXPECT_THAT(result.err, HasSubstr("below"));
}

TEST(CommandLine, NoVulkanDeviceEndsWith3) {
    const TempDir temp;
    const std::vector<std::string> none = {"VK_ICD_FILENAMES=/nowhere.json",
                                           "VK_DRIVER_FILES=/nowhere.json"};
    const ProgramResult replay = run_program(
        {.arguments = {"replay", "synthetic:", "--headless", temp / "out"}, .environment = none});
    EXPECT_EQ(replay.exit_code, kExitNoVulkan);
    EXPECT_THAT(replay.err, HasSubstr("mesa-vulkan-drivers"));
    const ProgramResult devices = run_program({.arguments = {"devices"}, .environment = none});
    EXPECT_EQ(devices.exit_code, kExitNoVulkan);
}

TEST(CommandLine, AnUnknownDeviceEndsWith3AndListsThoseThere) {
    const TempDir temp;
    const ProgramResult result =
        run({"replay", "synthetic:", "--device", "abacus", "--headless", temp / "out"});
    EXPECT_EQ(result.exit_code, kExitNoVulkan);
    EXPECT_THAT(result.err, HasSubstr("abacus"));
}

TEST(CommandLine, DevicesListsWhatCanBeOpened) {
    const ProgramResult result = run({"devices", "--json"});
    ASSERT_EQ(result.exit_code, kExitDone) << result.err;
    const auto json = nlohmann::json::parse(result.out);
    ASSERT_FALSE(json["vulkan"].empty());
    EXPECT_FALSE(json["vulkan"][0]["name"].get<std::string>().empty());
    bool synthetic = false;
    for (const auto& source : json["sources"]) {
        synthetic = synthetic || source["uri_pattern"].get<std::string>().find("synthetic:") !=
                                     std::string::npos;
    }
    EXPECT_TRUE(synthetic);
    EXPECT_THAT(run({"devices"}).out, HasSubstr("synthetic:"));
}

class Compare : public testing::Test {
  protected:
    std::string write(const char* name, int width, Rgba8 fill, Rgba8 corner) {
        Image<Rgba8> image(width, 4, fill);
        image.at(0, 0) = corner;
        const std::filesystem::path path = temp / name;
        const Image<Rgba8>& fixed = image;
        EXPECT_TRUE(write_png_rgba8(path, fixed.view()));
        return path.string();
    }
    TempDir temp;
    std::string base = write("base.png", 6, {10, 20, 30, 255}, {10, 20, 30, 255});
    std::string other = write("other.png", 6, {10, 20, 30, 255}, {13, 20, 30, 255});
    std::string wide = write("wide.png", 7, {10, 20, 30, 255}, {10, 20, 30, 255});
};

TEST_F(Compare, Verdicts) {
    EXPECT_EQ(run({"compare", base, base}).exit_code, kExitDone);
    EXPECT_EQ(run({"compare", base, other}).exit_code, kExitDiffer);
    EXPECT_EQ(run({"compare", base, other, "--tolerance", "2"}).exit_code, kExitDiffer);
    EXPECT_EQ(run({"compare", base, other, "--tolerance", "3"}).exit_code, kExitDone);
    EXPECT_EQ(run({"compare", base, wide}).exit_code, kExitFailed);
    EXPECT_EQ(run({"compare", base, temp / "missing.png"}).exit_code, kExitFailed);
}

TEST_F(Compare, JsonAndPictureOfTheDifference) {
    const std::string out = temp / "difference.png";
    const ProgramResult result = run({"compare", base, other, "--json", "--out", out});
    EXPECT_EQ(result.exit_code, kExitDiffer);
    const auto json = nlohmann::json::parse(result.out);
    EXPECT_EQ(json["same"], false);
    EXPECT_EQ(json["failing_pixels"], 1);
    EXPECT_EQ(json["max_abs"][0], 3);
    const auto picture = read_png_rgba8(out);
    ASSERT_TRUE(picture);
    EXPECT_EQ(picture->width(), 6);
    const auto same = nlohmann::json::parse(run({"compare", base, base, "--json"}).out);
    EXPECT_EQ(same["same"], true);
    EXPECT_TRUE(same["psnr_db"].is_null());
}

}  // namespace
}  // namespace kino
