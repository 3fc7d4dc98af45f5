#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/exit_codes.h"
#include "program_runner.h"
#include "tests/support/temp_dir.h"

namespace kino {
namespace {

using test::ProgramResult;
using test::run_program;
using test::TempDir;
using testing::HasSubstr;

nlohmann::json draw(const std::filesystem::path& out, const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"replay",     "synthetic:wave?size=320x240",
                                          "--headless", out.string(),
                                          "--frames",   "3",
                                          "--size",     "192x112",
                                          "--pictures", "0"};
    if (std::find(more.begin(), more.end(), "--scene") == more.end()) {
        arguments.insert(arguments.end(), {"--scene", "light-painting"});
    }
    arguments.insert(arguments.end(), more.begin(), more.end());
    const ProgramResult result = run_program({.arguments = arguments});
    EXPECT_EQ(result.exit_code, kExitDone) << result.err;
    return nlohmann::json::parse(
        test::read_bytes(out / "summary.json"))["deterministic"]["sources"][0];
}

TEST(Levels, OfAnEarlierRunAreRepeated) {
    const TempDir temp;
    const auto log = temp.write("run.json", R"({"levels": [{"frame": 1, "lod": 2, "zoom": 1},
                                   {"frame": 2, "lod": 1.5, "zoom": 2, "bilinear": true}]})");
    const auto replayed = draw(temp / "a", {"--lod", log.string()});
    ASSERT_EQ(replayed["levels"].size(), 3u);
    EXPECT_EQ(replayed["levels"][0]["lod"], 1);
    EXPECT_EQ(replayed["levels"][1]["lod"], 2);
    EXPECT_EQ(replayed["levels"][2]["zoom"], 2);
    EXPECT_EQ(replayed["levels"][2]["bilinear"], true);
    EXPECT_THAT(replayed["passes"].dump(), HasSubstr("zoom/"));
    // And its own summary is such a log.
    const auto again = draw(temp / "b", {"--lod", (temp / "a/summary.json").string()});
    EXPECT_EQ(again["pictures_fnv1a"], replayed["pictures_fnv1a"]);
    EXPECT_EQ(again["levels"], replayed["levels"]);
}

TEST(Levels, WithoutAWindowAutomaticIsInFull) {
    const TempDir temp;
    const auto off = draw(temp / "off", {});
    const auto automatic =
        draw(temp / "auto", {"--lod", "auto", "--target-ms", "1", "--true-error"});
    EXPECT_EQ(off["pictures_fnv1a"], automatic["pictures_fnv1a"]);
    ASSERT_EQ(automatic["levels"].size(), 1u);
    EXPECT_EQ(automatic["levels"][0]["lod"], 1);
    EXPECT_EQ(automatic["levels"][0]["zoom"], 1);
    EXPECT_EQ(automatic["true_error"]["pictures"], 1);
    EXPECT_EQ(automatic["true_error"]["mean_flip"], 0);
    EXPECT_TRUE(off["true_error"].is_null());
    const auto coarse = draw(temp / "coarse", {"--lod", "4", "--true-error"});
    EXPECT_NE(coarse["pictures_fnv1a"], off["pictures_fnv1a"]);
    EXPECT_GT(coarse["true_error"]["mean_flip"], 0);
    EXPECT_LT(coarse["true_error"]["mean_flip"], 0.1);
}

// A scene asks, and a command line goes before it.
TEST(Levels, SceneFilesAskForThem) {
    const TempDir temp;
    const auto scene = [&](const char* quality) {
        return temp.write("stage.json", std::string(R"({"kinoscope_scene": 1, "name": "stage",
            "materials": [{"name": "a"}], "meshes": [{"material": "a", "size_m": [1, 1, 1]}],
            "lights": [{"at_m": [0, 2, 1]}], "quality": )") +
                                            quality + "}");
    };
    const auto level = [&](const char* quality, const std::vector<std::string>& more) {
        std::vector<std::string> arguments = {"--scene", scene(quality).string()};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return draw(temp / "out", arguments);
    };
    auto source = level(R"({"lod": 2, "zoom": 2})", {});
    EXPECT_EQ(source["levels"].dump(), R"([{"bilinear":false,"frame":0,"lod":2.0,"zoom":2}])");
    EXPECT_EQ(source["zoom_by"], "fixed");
    source = level(R"({"lod": 2, "zoom": 2})", {"--lod", "off", "--zoom", "3"});
    EXPECT_EQ(source["levels"].dump(), R"([{"bilinear":false,"frame":0,"lod":1.0,"zoom":3}])");
    // Whoever reads the clock is not asked without a window; the head's recorded motion is.
    source = level(R"({"zoom": "predictive"})", {"--target-ms", "1"});
    EXPECT_EQ(source["levels"][0]["zoom"], 1);
    EXPECT_EQ(source["zoom_by"], "fixed");
    source = level(R"({"zoom": "predictive"})", {"--zoom", "head"});
    EXPECT_EQ(source["zoom_by"], "head");
    source = level(R"({"samples": 4})", {});
    EXPECT_THAT(source["passes"].dump(), HasSubstr("mesh depths"));
}

TEST(Levels, OnlyOneChooses) {
    for (const std::vector<std::string>& both :
         {std::vector<std::string>{"--lod", "auto", "--zoom", "reactive"},
          {"--lod", "auto", "--zoom", "head"},
          {"--lod", "2", "--zoom", "auto"},
          {"--zoom", "sometimes"},
          {"--zoom", "2.5"},
          {"--sync", "never"}}) {
        std::vector<std::string> arguments = {"replay", "synthetic:"};
        arguments.insert(arguments.end(), both.begin(), both.end());
        const ProgramResult result = test::run(arguments);
        EXPECT_EQ(result.exit_code, kExitUsage) << testing::PrintToString(both);
        EXPECT_THAT(result.err, HasSubstr(both[both.size() - 2])) << testing::PrintToString(both);
    }
}

TEST(Levels, WhatIsNoLevelIsRefused) {
    const TempDir temp;
    const auto log = temp.write("bad.json", R"({"levels": [{"frame": 0, "lod": 99, "zoom": 1}]})");
    for (const std::string& word :
         {log.string(), std::string("nowhere.json"), std::string("0.5")}) {
        const ProgramResult result = test::run({"replay", "synthetic:", "--lod", word});
        EXPECT_EQ(result.exit_code, kExitUsage) << word;
        EXPECT_THAT(result.err + result.out, HasSubstr("--lod")) << word;
    }
    EXPECT_EQ(test::run({"replay", "synthetic:", "--zoom", "9"}).exit_code, kExitUsage);
}

}  // namespace
}  // namespace kino
