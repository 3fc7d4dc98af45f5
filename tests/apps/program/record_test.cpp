#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/exit_codes.h"
#include "program_runner.h"
#include "tests/support/temp_dir.h"

namespace kino {
namespace {

using test::ProgramResult;
using test::run;
using test::run_program;
using test::TempDir;
using testing::HasSubstr;

nlohmann::json source_of(const std::filesystem::path& folder) {
    return nlohmann::json::parse(
        test::read_bytes(folder / "summary.json"))["deterministic"]["sources"][0];
}

TEST(Record, ASessionShowsThePicturesOfWhatItWasMadeFrom) {
    const TempDir temp;
    test::write_tiny_recording(temp / "tiny", 5);
    const std::string session = temp / "tiny.mkv";
    for (const char* codec : {"ffv1", "fast", "rvl", "raw"}) {
        std::filesystem::remove(session);
        const ProgramResult recorded =
            run({"record", temp / "tiny", "--out", session, "--codec", codec, "--json"});
        ASSERT_EQ(recorded.exit_code, kExitDone) << recorded.err;
        EXPECT_EQ(nlohmann::json::parse(recorded.out)["lost"], 0);
        std::vector<std::string> hashes;
        for (const std::string& uri : {std::string(temp / "tiny"), session}) {
            const std::string out = temp / ("out" + std::to_string(hashes.size()));
            const ProgramResult played = run({"replay", uri, "--headless", out, "--frames", "5",
                                              "--size", "96x64", "--loop", "once"});
            ASSERT_EQ(played.exit_code, kExitDone) << played.err;
            EXPECT_EQ(source_of(out)["frames"], 5);
            EXPECT_EQ(source_of(out)["errors"], 0);
            hashes.push_back(source_of(out)["pictures_fnv1a"]);
        }
        EXPECT_EQ(hashes[0], hashes[1]) << codec;
    }
}

TEST(Record, NothingIsWrittenOver) {
    const TempDir temp;
    const std::string file = temp.write("there.mkv", "precious");
    const ProgramResult result = run({"record", "synthetic:", "--out", file, "--frames", "1"});
    EXPECT_EQ(result.exit_code, kExitFailed);
    EXPECT_THAT(result.err, HasSubstr("there.mkv"));
    EXPECT_EQ(test::read_bytes(file), "precious");
}

TEST(Record, AFolderWithItsSessionOpensByItsName) {
    const TempDir temp;
    const std::string folder = temp.write("visit/notes.txt", "a word").parent_path();
    const auto record = [&](const std::string& name) {
        return run({"record", "synthetic:", "--out", folder + name, "--frames", "2"}).exit_code;
    };
    const auto replay = [&] {
        return run(
            {"replay", folder, "--headless", temp / "out", "--frames", "1", "--size", "64x48"});
    };
    ASSERT_EQ(record("/first.mkv"), kExitDone);
    const ProgramResult only = replay();
    EXPECT_EQ(only.exit_code, kExitDone) << only.err;
    ASSERT_EQ(record("/second.mkv"), kExitDone);
    const ProgramResult either = replay();
    EXPECT_EQ(either.exit_code, kExitFailed);
    EXPECT_THAT(either.err, HasSubstr("first.mkv, second.mkv"));
}

TEST(Record, CtrlCEndsTheFileInOrder) {
    const TempDir temp;
    const std::filesystem::path session = temp / "long.mkv";
    const ProgramResult recorded =
        run_program({.arguments = {"record", "synthetic:?size=320x240", "--out", session},
                     .interrupt_when_exists_signal = SIGINT,
                     .interrupt_when_exists = session});
    ASSERT_EQ(recorded.exit_code, kExitDone) << recorded.err;
    const ProgramResult repaired = run({"repair", session});
    EXPECT_EQ(repaired.exit_code, kExitDone) << repaired.err;
    EXPECT_THAT(repaired.out, HasSubstr("nothing to repair"));
}

TEST(Record, ASessionCutOffPlaysAndIsRepaired) {
    const TempDir temp;
    test::write_tiny_recording(temp / "tiny", 60);
    const std::filesystem::path session = temp / "cut.mkv";
    ASSERT_EQ(run({"record", temp / "tiny", "--out", session, "--codec", "raw"}).exit_code,
              kExitDone);
    std::filesystem::resize_file(session, std::filesystem::file_size(session) * 3 / 4);
    const std::string out = temp / "out";
    const ProgramResult played =
        run({"replay", session, "--headless", out, "--size", "96x64", "--loop", "once"});
    ASSERT_EQ(played.exit_code, kExitDone) << played.err;
    const std::int64_t frames = source_of(out)["frames"];
    EXPECT_GT(frames, 20);
    EXPECT_LT(frames, 60);
    const ProgramResult repaired = run({"repair", session});
    ASSERT_EQ(repaired.exit_code, kExitDone) << repaired.err;
    EXPECT_THAT(repaired.out, HasSubstr("repaired"));
    EXPECT_THAT(run({"repair", session}).out, HasSubstr("nothing to repair"));
    ASSERT_EQ(
        run({"replay", session, "--headless", out, "--size", "96x64", "--loop", "once"}).exit_code,
        kExitDone);
    EXPECT_EQ(source_of(out)["frames"], frames);
}

TEST(Record, WhatIsNoSessionIsNotRepaired) {
    const TempDir temp;
    const std::string file = temp.write("letter.mkv", "Dear reader");
    const ProgramResult result = run({"repair", file});
    EXPECT_EQ(result.exit_code, kExitFailed);
    EXPECT_THAT(result.err, HasSubstr("letter.mkv"));
    EXPECT_EQ(test::read_bytes(file), "Dear reader");
}

TEST(Live, WithoutADisplayARecordingIsNotSilentlyLost) {
    const TempDir temp;
    const ProgramResult result = run_program(
        {.arguments = {"live", "synthetic:", "--record", "visit.mkv", "--frames", "2"},
         .environment = {"DISPLAY", "WAYLAND_DISPLAY", "XDG_CONFIG_HOME=" + temp.path().string()},
         .folder = temp.path()});
    EXPECT_EQ(result.exit_code, kExitFailed);
    EXPECT_THAT(result.err, HasSubstr("visit.mkv: not recorded"));
    EXPECT_FALSE(std::filesystem::exists(temp / "out"));
}

TEST(Live, WithoutASensorItSaysWhatToDo) {
    const ProgramResult result = run({"live", "--headless", "nowhere"});
    if (result.exit_code == kExitDone) GTEST_SKIP() << "a sensor is plugged in";
    EXPECT_EQ(result.exit_code, kExitFailed);
    EXPECT_THAT(result.err, HasSubstr("devices --watch"));
}

}  // namespace
}  // namespace kino
