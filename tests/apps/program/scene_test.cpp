#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "apps/exit_codes.h"
#include "program_runner.h"
#include "sensor/png_io.h"
#include "tests/support/temp_dir.h"

namespace kino {
namespace {

using test::ProgramResult;
using test::run_program;
using test::TempDir;
using testing::HasSubstr;

TEST(SceneOption, PutsThePersonOnTheStageTheSameBitsEveryTime) {
    const TempDir temp;
    std::vector<nlohmann::json> runs;
    for (const char* run : {"a", "b"}) {
        const ProgramResult result =
            run_program({.arguments = {"replay", "synthetic:wave?size=320x240", "--scene",
                                       "light-painting", "--headless", (temp / run).string(),
                                       "--frames", "3", "--size", "160x96"},
                         .environment = {"KINO_VALIDATION=1"}});
        ASSERT_EQ(result.exit_code, kExitDone) << result.err;
        EXPECT_THAT(result.err, testing::Not(HasSubstr("vulkan:")));
        EXPECT_THAT(result.out, HasSubstr("scene light-painting"));
        runs.push_back(
            nlohmann::json::parse(test::read_bytes(temp / run / "summary.json"))["deterministic"]);
    }
    EXPECT_EQ(runs[0], runs[1]);
    EXPECT_EQ(runs[0]["scene"], "light-painting");
    const auto& source = runs[0]["sources"][0];
    EXPECT_GE(source["stage"]["lights"], 900);
    EXPECT_GE(source["stage"]["meshes"], 900);
    EXPECT_EQ(source["color"], "relit");
    EXPECT_EQ(source["frames"], 3);
    const std::string passes = source["passes"].dump();
    EXPECT_THAT(passes, HasSubstr("light"));
    const auto picture = read_png_rgba8(temp / "a/frame-00002.png");
    ASSERT_TRUE(picture) << picture.error().to_string();
    // Dark, and not black.
    double sum = 0;
    for (const Rgba8& p : picture->pixels()) sum += p.r + p.g + p.b;
    const double mean = sum / (3 * 160 * 96);
    EXPECT_GT(mean, 5);
    EXPECT_LT(mean, 110);
}

TEST(SceneOption, WithoutASceneNothingOfItIsInTheSummary) {
    const TempDir temp;
    const ProgramResult result =
        run_program({.arguments = {"replay", "synthetic:?size=320x240", "--headless",
                                   temp.path().string(), "--frames", "1", "--size", "64x48"}});
    ASSERT_EQ(result.exit_code, kExitDone) << result.err;
    const auto json = nlohmann::json::parse(test::read_bytes(temp / "summary.json"));
    EXPECT_EQ(json["deterministic"]["scene"], "");
    EXPECT_TRUE(json["deterministic"]["sources"][0]["stage"].is_null());
    for (const auto& pass : json["deterministic"]["sources"][0]["passes"]) {
        EXPECT_THAT(pass.get<std::string>(), testing::Not(HasSubstr("mesh draw")));
    }
}

TEST(SceneOption, ListsItsScenesAndRefusesOthers) {
    const ProgramResult list = test::run({"replay", "--list-scenes"});
    EXPECT_EQ(list.exit_code, kExitDone) << list.err;
    for (const char* name : {"light-painting", "chair-room", "torch", "colonnade", "glass"}) {
        EXPECT_THAT(list.out, HasSubstr(name));
    }
    const ProgramResult unknown = test::run({"replay", "synthetic:", "--scene", "disco"});
    EXPECT_EQ(unknown.exit_code, kExitUsage);
    EXPECT_THAT(unknown.err + unknown.out, HasSubstr("light-painting"));
    const TempDir temp;
    const auto file =
        temp.write("mine.json", R"({"kinoscope_scene": 1, "lights": [{"raduis_m": 1}]})");
    const ProgramResult wrong = test::run({"live", "--scene", file.string()});
    EXPECT_EQ(wrong.exit_code, kExitUsage);
    EXPECT_THAT(wrong.err + wrong.out, HasSubstr("#/lights/0/raduis_m"));
}

}  // namespace
}  // namespace kino
