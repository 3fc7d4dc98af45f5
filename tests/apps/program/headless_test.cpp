#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "apps/exit_codes.h"
#include "program_runner.h"
#include "sensor/png_io.h"
#include "tests/support/temp_dir.h"

namespace kino {
namespace {

namespace fs = std::filesystem;
using test::ProgramResult;
using test::run_program;
using test::TempDir;
using testing::HasSubstr;

std::string frame_name(int i) {
    return "frame-0000" + std::to_string(i) + ".png";
}

nlohmann::json summary_of(const fs::path& folder) {
    return nlohmann::json::parse(test::read_bytes(folder / "summary.json"));
}

/// Colours in a picture; a background alone has a few shades of grey-blue.
std::size_t colors_in(const Image<Rgba8>& picture) {
    std::set<std::uint32_t> seen;
    for (const Rgba8& p : picture.pixels()) seen.insert(p.r << 16 | p.g << 8 | p.b);
    return seen.size();
}

ProgramResult play(const std::string& uri, const fs::path& out, std::vector<std::string> more) {
    std::vector<std::string> arguments = {"replay", uri, "--headless", out.string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_program({.arguments = arguments, .environment = {"KINO_VALIDATION=1"}});
}

TEST(Headless, OfficeGivesPicturesVideoAndSummary) {
    const TempDir temp;
    const ProgramResult result =
        play(test::bundled("office"), temp.path(), {"--frames", "2", "--size", "320x180"});
    ASSERT_EQ(result.exit_code, kExitDone) << result.err;
    EXPECT_THAT(result.err, testing::Not(HasSubstr("vulkan:")));
    const auto picture = read_png_rgba8(temp / frame_name(1));
    ASSERT_TRUE(picture) << picture.error().to_string();
    EXPECT_EQ(picture->width(), 320);
    EXPECT_EQ(picture->height(), 180);
    EXPECT_GT(colors_in(*picture), 1000u);
    const auto json = summary_of(temp.path());
    const auto& source = json["deterministic"]["sources"][0];
    EXPECT_EQ(source["frames"], 2);
    EXPECT_EQ(source["dropped"], 0);
    EXPECT_EQ(source["errors"], 0);
    EXPECT_EQ(source["color"], "captured");
    EXPECT_GT(source["points"], 100000);
    EXPECT_FALSE(source["passes"].empty());
    EXPECT_GT(source["device_bytes"], 0);
    EXPECT_EQ(json["timing"]["sources"][0]["render"]["count"], 2);
    const std::string video = test::read_bytes(temp / "video.mp4");
    EXPECT_NE(video.find("ftyp"), std::string::npos);
    EXPECT_NE(video.find("moov"), std::string::npos);
}

TEST(Headless, SteppedTwiceGivesTheSameBits) {
    const TempDir temp;
    const fs::path recording = test::write_tiny_recording(temp / "tiny", 4);
    for (const std::string& uri : {recording.string(), std::string("synthetic:?size=320x240")}) {
        std::vector<nlohmann::json> parts;
        for (const char* run : {"a", "b"}) {
            fs::remove_all(temp / run);
            const ProgramResult result =
                play(uri, temp / run, {"--stepped", "--frames", "6", "--size", "160x120"});
            ASSERT_EQ(result.exit_code, kExitDone) << result.err;
            parts.push_back(summary_of(temp / run)["deterministic"]);
        }
        EXPECT_EQ(parts[0], parts[1]);
        for (int i = 0; i < 6; ++i) {
            EXPECT_EQ(test::read_bytes(temp / "a" / frame_name(i)),
                      test::read_bytes(temp / "b" / frame_name(i)))
                << uri << " frame " << i;
        }
        // Not the same picture all the time, or the above would prove little.
        EXPECT_NE(test::read_bytes(temp / "a" / frame_name(0)),
                  test::read_bytes(temp / "a" / frame_name(3)));
    }
}

TEST(Headless, EveryPathAndLookDrawsSomething) {
    const TempDir temp;
    const fs::path recording = test::write_tiny_recording(temp / "tiny", 2);
    for (const char* raster : {"compute", "compute32", "hardware"}) {
        for (const char* style : {"cloud", "mesh"}) {
            for (const char* color : {"captured", "mixed", "relit"}) {
                const ProgramResult result =
                    play(recording.string(), temp / "out",
                         {"--raster", raster, "--style", style, "--color", color, "--frames", "1",
                          "--size", "96x64", "--splat", "8", "--view", "sensor"});
                ASSERT_EQ(result.exit_code, kExitDone) << result.err;
                EXPECT_THAT(result.err, testing::Not(HasSubstr("vulkan:")));
                const auto picture = read_png_rgba8(temp / "out" / frame_name(0));
                ASSERT_TRUE(picture);
                EXPECT_GT(colors_in(*picture), 200u) << raster << " " << style << " " << color;
            }
        }
    }
}

TEST(Headless, SeveralSourcesOneAfterTheOther) {
    const TempDir temp;
    const fs::path one = test::write_tiny_recording(temp / "one", 2);
    const fs::path two = test::write_tiny_recording(temp / "t\xc3\xbcr", 2);
    const ProgramResult result =
        run_program({.arguments = {"replay", one, "no-such-thing", two, "--headless", temp / "out",
                                   "--frames", "2", "--size", "64x48", "--json"}});
    // The one that fails is told and the others are played.
    EXPECT_EQ(result.exit_code, kExitFailed);
    EXPECT_THAT(result.err, HasSubstr("no-such-thing"));
    const auto json = nlohmann::json::parse(result.out);
    ASSERT_EQ(json["deterministic"]["sources"].size(), 2u);
    EXPECT_TRUE(fs::exists(temp / "out" / "1-one" / frame_name(1)));
    EXPECT_EQ(summary_of(temp / "out")["deterministic"]["sources"][1]["frames"], 2);
    std::size_t folders = 0;
    for (const auto& entry : fs::directory_iterator(temp / "out")) folders += entry.is_directory();
    EXPECT_EQ(folders, 2u);
}

TEST(Headless, DamagedFramesAreCountedAndSkipped) {
    const TempDir temp;
    const fs::path recording = test::write_tiny_recording(temp / "tiny", 4);
    fs::resize_file(recording / "depth" / "002.png", 60);
    const ProgramResult result = play(recording.string(), temp / "out",
                                      {"--frames", "4", "--loop", "once", "--size", "64x48"});
    ASSERT_EQ(result.exit_code, kExitDone) << result.err;
    const auto source = summary_of(temp / "out")["deterministic"]["sources"][0];
    EXPECT_EQ(source["frames"], 3);
    EXPECT_EQ(source["errors"], 1);
    EXPECT_THAT(source["first_error"].get<std::string>(), HasSubstr("002.png"));
}

TEST(Headless, OnlyDamagedFramesIsAFailure) {
    const TempDir temp;
    const fs::path recording = test::write_tiny_recording(temp / "tiny", 2);
    for (const char* name : {"000.png", "001.png"}) fs::resize_file(recording / "depth" / name, 60);
    const ProgramResult result =
        play(recording.string(), temp / "out", {"--frames", "9", "--size", "64x48"});
    EXPECT_EQ(result.exit_code, kExitFailed);
    EXPECT_FALSE(result.err.empty());
}

TEST(Headless, PicturesAreChosenEvenly) {
    const TempDir temp;
    const fs::path recording = test::write_tiny_recording(temp / "tiny", 5);
    ASSERT_EQ(play(recording.string(), temp / "out",
                   {"--frames", "9", "--pictures", "3", "--size", "64x48"})
                  .exit_code,
              kExitDone);
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(temp / "out")) {
        if (entry.path().extension() == ".png") names.insert(entry.path().filename());
    }
    EXPECT_EQ(names, (std::set<std::string>{frame_name(0), frame_name(4), frame_name(8)}));
}

TEST(Headless, CtrlCFinishesTheFiles) {
    const TempDir temp;
    const fs::path recording = test::write_tiny_recording(temp / "tiny", 3);
    const ProgramResult result =
        run_program({.arguments = {"replay", recording, "--headless", temp / "out", "--frames",
                                   "100000000", "--size", "64x48", "--pictures", "-1"},
                     .interrupt_when_exists_signal = SIGINT,
                     .interrupt_when_exists = temp / "out" / frame_name(5)});
    EXPECT_EQ(result.exit_code, kExitDone) << result.err;
    EXPECT_EQ(summary_of(temp / "out")["deterministic"]["interrupted"], true);
    EXPECT_NE(test::read_bytes(temp / "out" / "video.mp4").find("moov"), std::string::npos);
}

TEST(Headless, WithoutADisplayPicturesAreWrittenInstead) {
    const TempDir temp;
    const fs::path recording = test::write_tiny_recording(temp / "tiny", 2);
    const ProgramResult result = run_program(
        {.arguments = {"replay", recording, "--frames", "2", "--size", "64x48"},
         .environment = {"DISPLAY", "WAYLAND_DISPLAY", "XDG_CONFIG_HOME=" + temp.path().string()},
         .folder = temp.path()});
    EXPECT_EQ(result.exit_code, kExitDone) << result.err;
    EXPECT_THAT(result.err, HasSubstr("window"));
    EXPECT_TRUE(fs::exists(temp / "out" / "summary.json"));
    EXPECT_TRUE(fs::exists(temp / "out" / frame_name(1)));
}

}  // namespace
}  // namespace kino
