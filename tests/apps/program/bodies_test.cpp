#include <gmock/gmock.h>
#include <gtest/gtest.h>

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

constexpr const char* kPush = "synthetic:push?size=320x240";
constexpr const char* kFrames = "80";

/// A session of kFrames frames of somebody who pushes once, with bodies and gestures.
std::string record_push(const TempDir& temp) {
    std::string session = temp / "push.mkv";
    const ProgramResult result = run({"record", kPush, "--out", session, "--codec", "fast",
                                      "--frames", kFrames, "--bodies", "recorded", "--json"});
    EXPECT_EQ(result.exit_code, kExitDone) << result.err;
    EXPECT_EQ(nlohmann::json::parse(result.out)["gestures"], 1);
    EXPECT_EQ(nlohmann::json::parse(result.out)["people"], nlohmann::json::array({1}));
    EXPECT_THAT(result.err, HasSubstr("push"));
    return session;
}

nlohmann::json bodies_of(const std::string& uri, const std::filesystem::path& out,
                         const char* mode) {
    const ProgramResult result =
        run({"replay", uri, "--headless", out, "--frames", kFrames, "--size", "64x48", "--pictures",
             "0", "--loop", "once", "--bodies", mode});
    EXPECT_EQ(result.exit_code, kExitDone) << result.err;
    return nlohmann::json::parse(
        test::read_bytes(out / "summary.json"))["deterministic"]["sources"][0]["bodies"];
}

TEST(Bodies, WhatWasRecordedIsShownAgain) {
    const TempDir temp;
    const std::string session = record_push(temp);
    const nlohmann::json recorded = bodies_of(session, temp / "off", "off");
    ASSERT_EQ(recorded["gestures"].size(), 1u);
    EXPECT_EQ(recorded["gestures"][0]["kind"], "push");
    EXPECT_EQ(recorded["gestures"][0]["body"], 1);
    EXPECT_GT(recorded["gestures"][0]["frame"], 30);
    EXPECT_EQ(recorded["frames_with_people"]["1"], 80);
    EXPECT_EQ(recorded, bodies_of(session, temp / "recorded", "recorded"));
    EXPECT_EQ(recorded, bodies_of(kPush, temp / "source", "recorded"));
    EXPECT_EQ(bodies_of(kPush, temp / "nothing", "off")["gestures"].size(), 0u);
}

TEST(Bodies, WithoutAForestTheyAreAnError) {
    const TempDir temp;
    const ProgramResult result = run({"replay", kPush, "--headless", temp / "out", "--frames", "1",
                                      "--bodies", "on", "--forest", temp / "none.forest"});
    EXPECT_EQ(result.exit_code, kExitFailed);
    EXPECT_THAT(result.err, HasSubstr("bodies cannot be tracked"));
    EXPECT_THAT(result.err, HasSubstr("none.forest"));
}

TEST(Motion, EveryFormatOfRecordedBodies) {
    const TempDir temp;
    const std::string session = record_push(temp);
    for (const auto& [name, start] : std::vector<std::pair<std::string, std::string>>{
             {"a.bvh", "HIERARCHY"}, {"a.glb", "glTF"}, {"a.csv", "moment,"}, {"a.c3d", "\x02"}}) {
        const std::string file = temp / name;
        const ProgramResult result = run({"convert", session, "--motion", file, "--json"});
        ASSERT_EQ(result.exit_code, kExitDone) << result.err;
        const nlohmann::json motion = nlohmann::json::parse(result.out)["motion"];
        EXPECT_EQ(motion["bodies"], "recorded");
        EXPECT_EQ(motion["person"], 1);
        EXPECT_EQ(motion["frames"], 80) << name;
        EXPECT_THAT(test::read_bytes(file), testing::StartsWith(start)) << name;
        const ProgramResult again = run({"convert", session, "--motion", file});
        EXPECT_EQ(again.exit_code, kExitFailed) << "written over";
        EXPECT_THAT(again.err, HasSubstr(name));
    }
    // A session and its motion at once; of some frames only.
    const ProgramResult both = run({"convert", session, temp / "b.mkv", "--motion", temp / "b.csv",
                                    "--from", "10", "--count", "20", "--json"});
    ASSERT_EQ(both.exit_code, kExitDone) << both.err;
    EXPECT_EQ(nlohmann::json::parse(both.out)["frames"]["depth"], 20);
    EXPECT_EQ(nlohmann::json::parse(both.out)["motion"]["moments"], 20);
}

TEST(Motion, WhatCannotBeExportedIsNamed) {
    const TempDir temp;
    test::write_tiny_recording(temp / "tiny", 3);
    const std::string tiny = temp / "tiny";
    ProgramResult result =
        run({"convert", tiny, "--motion", temp / "a.bvh", "--bodies", "recorded"});
    EXPECT_EQ(result.exit_code, kExitFailed);
    EXPECT_THAT(result.err, HasSubstr("no bodies were recorded"));
    result = run({"convert", tiny, "--motion", temp / "a.bvh"});
    EXPECT_EQ(result.exit_code, kExitFailed);
    EXPECT_THAT(result.err, HasSubstr("nobody was found"));
    EXPECT_FALSE(std::filesystem::exists(temp / "a.bvh"));
    result = run({"convert", kPush, "--motion", temp / "a.fbx"});
    EXPECT_EQ(result.exit_code, kExitFailed);
    EXPECT_THAT(result.err, HasSubstr("fbx"));
    result = run({"convert", kPush, "--motion", temp / "a.bvh", "--person", "9", "--count", "5"});
    EXPECT_EQ(result.exit_code, kExitFailed);
    EXPECT_THAT(result.err, HasSubstr("9"));
    result = run({"convert", kPush});
    EXPECT_EQ(result.exit_code, kExitUsage);
}

}  // namespace
}  // namespace kino
