#include "apps/viewer/budget_log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/apps/viewer/fuzz/target.h"
#include "tests/support/random.h"
#include "tests/support/temp_dir.h"

namespace kino {
namespace {

using testing::HasSubstr;
using Log = std::vector<FrameBudget::Logged>;

TEST(BudgetLog, IsReadAsItWasWritten) {
    const Log log = {{.frame = 0, .lod = 1, .zoom = 1},
                     {.frame = 17, .lod = 2.5, .zoom = 1, .bilinear = true},
                     {.frame = 1'000'000'000'000, .lod = 8, .zoom = 8}};
    nlohmann::ordered_json summary;
    summary["deterministic"]["sources"][0]["levels"] = budget_log_json(log);
    const test::TempDir temp;
    const auto file = temp.write("summary.json", summary.dump());
    const auto read = read_budget_log(file);
    ASSERT_TRUE(read) << read.error().to_string();
    EXPECT_EQ(*read, log);
    nlohmann::ordered_json window;
    window["levels"] = budget_log_json(log);
    EXPECT_EQ(*parse_budget_log(window.dump(), "window"), log);
    EXPECT_TRUE(parse_budget_log(R"({"levels": []})", "none")->empty());
}

TEST(BudgetLog, SaysWhatIsWrong) {
    const test::TempDir temp;
    EXPECT_FALSE(read_budget_log(temp / "nowhere.json"));
    const auto error_of = [](const std::string& text) {
        const auto read = parse_budget_log(text, "file");
        return read ? std::string() : read.error().to_string();
    };
    EXPECT_THAT(error_of("{"), HasSubstr("no JSON"));
    EXPECT_THAT(error_of("[]"), HasSubstr("levels"));
    EXPECT_THAT(error_of(R"({"deterministic": {"sources": []}})"), HasSubstr("levels"));
    EXPECT_THAT(error_of(R"({"levels": [{"frame": 0, "lod": 1, "zoom": 1}, 3]})"),
                HasSubstr("#/levels/1"));
    for (const char* line :
         {R"({"frame": -1, "lod": 1, "zoom": 1})", R"({"frame": 0, "lod": 0.5, "zoom": 1})",
          R"({"frame": 0, "lod": 1e9, "zoom": 1})", R"({"frame": 0, "lod": 1, "zoom": 0})",
          R"({"frame": 0, "lod": 1, "zoom": 99999999999999})",
          R"({"frame": 0.5, "lod": 1, "zoom": 1})", R"({"frame": 0, "lod": "2", "zoom": 1})",
          R"({"lod": 1, "zoom": 1})", R"({"frame": 0, "lod": 1, "zoom": 1, "bilinear": 1})"}) {
        EXPECT_NE(error_of(std::string("{\"levels\": [") + line + "]}"), "") << line;
    }
    const std::string twice = R"({"frame": 5, "lod": 1, "zoom": 1})";
    EXPECT_THAT(error_of("{\"levels\": [" + twice + "," + twice + "]}"),
                HasSubstr("one after the other"));
}

TEST(BudgetLog, AnyBytesAreRefusedOrSound) {
    test::Random random(41);
    for (const auto& file : std::filesystem::directory_iterator("tests/data/fuzz/budget_log")) {
        const std::string seed = test::read_bytes(file.path());
        for (int round = 0; round < 1500; ++round) {
            std::string text = seed;
            for (int i = random.integer(1, 6); i > 0; --i) {
                const auto at =
                    static_cast<std::size_t>(random.integer(0, static_cast<int>(text.size()) - 1));
                if (random.chance(0.3)) {
                    text.erase(at, static_cast<std::size_t>(random.integer(1, 8)));
                } else {
                    text[at] = random.chance(0.5) ? "0123456789.-eE[]{}\","[random.integer(0, 19)]
                                                  : static_cast<char>(random.integer(0, 255));
                }
                if (text.empty()) break;
            }
            fuzz::budget_log({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
        }
    }
}

}  // namespace
}  // namespace kino
