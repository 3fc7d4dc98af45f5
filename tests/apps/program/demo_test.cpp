#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/exit_codes.h"
#include "program_runner.h"
#include "tests/support/temp_dir.h"

namespace kino {
namespace {

namespace fs = std::filesystem;
using test::ProgramResult;
using test::run;
using test::run_program;
using test::TempDir;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

nlohmann::json summary_in(const fs::path& folder) {
    return nlohmann::json::parse(test::read_bytes(folder / "summary.json"));
}

nlohmann::json show(const fs::path& out, std::vector<std::string> more) {
    std::vector<std::string> arguments = {"demo", "--headless", out.string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const ProgramResult result =
        run_program({.arguments = arguments, .environment = {"KINO_VALIDATION=1"}});
    EXPECT_EQ(result.exit_code, kExitDone) << result.err;
    EXPECT_THAT(result.err, Not(HasSubstr("vulkan:")));
    return summary_in(out)["deterministic"];
}

TEST(Demo, PlaysThePerformanceTheSameBitsEveryTime) {
    const TempDir temp;
    std::vector<nlohmann::json> runs;
    for (const char* name : {"a", "b"}) {
        // The wave is told at 6.2 s.
        runs.push_back(show(temp / name, {"--frames", "195", "--size", "64x36"}));
    }
    EXPECT_EQ(runs[0], runs[1]);
    EXPECT_THAT(runs[0]["name"].get<std::string>(), HasSubstr("performance"));
    EXPECT_EQ(runs[0]["frames"], 195);
    ASSERT_EQ(runs[0]["gestures"].size(), 2u);
    EXPECT_EQ(runs[0]["gestures"][1]["kind"], "engaged");
    EXPECT_NEAR(runs[0]["gestures"][1]["time_s"].get<double>(), 6.2, 0.5);
    EXPECT_EQ(runs[0]["gestures"][1]["frame"], runs[0]["gestures"][1]["picture"]);
    EXPECT_EQ(runs[0]["longest_delay_ms"], 0);
    std::vector<std::string> events;
    for (const auto& event : runs[0]["events"]) events.push_back(event["what"]);
    EXPECT_EQ(events, (std::vector<std::string>{"visitor", "engaged"}));
    EXPECT_GT(runs[0]["most_lights"], 500);
    EXPECT_THAT(runs[0]["passes"].get<std::vector<std::string>>(), Not(testing::IsEmpty()));
    for (const char* file : {"frame-00000.png", "frame-00194.png", "video.mp4"}) {
        EXPECT_TRUE(fs::exists(temp / "a" / file)) << file;
    }
}

TEST(Demo, WhatIsLeftOutCostsNothing) {
    const TempDir temp;
    const std::vector<std::string> brief = {"synthetic:idle?size=320x240", "--frames", "12",
                                            "--size", "64x36"};
    const auto with = [&](const char* name, std::vector<std::string> more) {
        more.insert(more.begin(), brief.begin(), brief.end());
        return show(temp / name, more);
    };
    const auto body = with("body", {}), none = with("none", {"--no-body"}),
               avatar = with("avatar", {"--no-body", "--avatar", "mannequin"});
    EXPECT_LT(none["device_bytes"], body["device_bytes"]);
    EXPECT_LT(none["passes"].size(), body["passes"].size());
    EXPECT_LT(none["device_bytes"], avatar["device_bytes"]);
    EXPECT_LE(none["passes"].size(), avatar["passes"].size());
    EXPECT_NE(none["pictures_fnv1a"], avatar["pictures_fnv1a"]);
}

TEST(Demo, WrongUsageEndsWith2) {
    const std::vector<std::vector<std::string>> wrong = {
        {"--lod", "0.5"},     {"--lod", "nan"},    {"--target-ms", "soon"}, {"--size", "12"},
        {"--frames", "0"},    {"--scene", "moon"}, {"--avatar", "nobody"},  {"--pictures", "-7"},
        {"--color", "relit"}, {"one", "two"}};
    for (std::vector<std::string> arguments : wrong) {
        arguments.insert(arguments.begin(), "demo");
        const ProgramResult result = run(arguments);
        EXPECT_EQ(result.exit_code, kExitUsage) << testing::PrintToString(arguments);
        EXPECT_FALSE(result.err.empty());
    }
}

TEST(Demo, WhatCannotBeOpenedIsNamed) {
    const TempDir temp;
    const ProgramResult missing = run({"demo", "no/such/thing", "--headless", temp / "out"});
    EXPECT_EQ(missing.exit_code, kExitFailed);
    EXPECT_THAT(missing.err, HasSubstr("no/such/thing"));
    const ProgramResult nowhere =
        run({"demo", "--headless", temp.write("file", "x") / "below", "--frames", "1"});
    EXPECT_EQ(nowhere.exit_code, kExitFailed);
}

TEST(Demo, HelpHasKeysScenesAndAvatars) {
    const ProgramResult help = run({"demo", "--help"});
    EXPECT_EQ(help.exit_code, kExitDone);
    for (const char* word : {"light-painting", "mannequin", "Esc", "--no-mirror", "Wave"}) {
        EXPECT_THAT(help.out, HasSubstr(word));
    }
}

}  // namespace
}  // namespace kino
