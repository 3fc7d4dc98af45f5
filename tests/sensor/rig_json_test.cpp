#include "sensor/rig_json.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <limits>
#include <random>

#include "test_folder.h"

namespace kino {
namespace {

using ::testing::HasSubstr;

RigParameters random_rig(unsigned seed) {
    std::mt19937_64 random(seed);
    // Any finite bits make the hardest digits; the size is kept where validate() accepts it.
    const auto any = [&] {
        return std::bit_cast<double>((random() & 0x800FFFFFFFFFFFFF) |
                                     ((1023 - 40 + random() % 50) << 52));
    };
    RigParameters rig;
    rig.depth = {.width = 640,
                 .height = 480,
                 .fx = std::abs(any()),
                 .fy = std::abs(any()),
                 .cx = any(),
                 .cy = any(),
                 .k1 = any(),
                 .k2 = any(),
                 .k3 = any(),
                 .k4 = any(),
                 .k5 = any(),
                 .k6 = any(),
                 .p1 = any(),
                 .p2 = any()};
    if (random() % 2 == 0) {
        rig.color = rig.depth;
        rig.color->cx = any();
    }
    const glm::dquat q(any(), any(), any(), any());
    rig.color_from_depth = {glm::normalize(q), {any(), any(), any()}};
    rig.disparity = {any(), std::abs(any()), std::abs(any()), std::abs(any())};
    rig.min_depth_m = std::abs(any());
    rig.max_depth_m = rig.min_depth_m + 1 + std::abs(any());
    rig.serial = "A00 \"quoted\" \\ ü";
    rig.note = "line\nbreak";
    return rig;
}

TEST(RigJson, WritingAndReadingBackGivesTheSameBits) {
    const test::TestFolder folder;
    for (unsigned seed = 0; seed < 200; ++seed) {
        const RigParameters rig = random_rig(seed);
        const auto back = rig_from_json(rig_to_json(rig), "test");
        ASSERT_TRUE(back) << back.error().to_string();
        EXPECT_EQ(*back, rig) << rig_to_json(rig);
    }
    const RigParameters rig = random_rig(1);
    ASSERT_TRUE(write_rig_file(folder.path() / "rig.json", rig));
    EXPECT_EQ(*read_rig_file(folder.path() / "rig.json"), rig);
}

TEST(RigJson, NanAndInfinityCannotBeWrittenNorRead) {
    const test::TestFolder folder;
    for (const double bad :
         {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
        RigParameters rig = random_rig(3);
        rig.depth.k1 = bad;
        EXPECT_FALSE(write_rig_file(folder.path() / "rig.json", rig));
        EXPECT_FALSE(rig_from_json(rig_to_json(rig), "test"));
    }
}

std::string with_depth(const std::string& depth, const std::string& more = "") {
    return R"({"kinoscope_rig": 1, "cameras": {"depth": )" + depth + "}" + more + "}";
}

std::string error_of(const std::string& text) {
    const auto result = rig_from_json(text, "rig.json");
    EXPECT_FALSE(result) << text;
    return result ? "" : result.error().to_string();
}

TEST(RigJson, HostileValuesAreRefusedByName) {
    const auto camera = [](const std::string& fx) {
        return R"({"width": 4, "height": 3, "fx": )" + fx + R"(, "fy": 2, "cx": 1, "cy": 1})";
    };
    EXPECT_TRUE(rig_from_json(with_depth(camera("2.5")), "ok"));
    EXPECT_THAT(error_of(with_depth(camera("0"))), HasSubstr("focal length"));
    EXPECT_THAT(error_of(with_depth(camera("-1"))), HasSubstr("rig.json: depth camera"));
    EXPECT_THAT(error_of(with_depth(camera("NaN"))), HasSubstr("not valid JSON"));
    EXPECT_THAT(error_of(with_depth(camera("1e999"))), HasSubstr("not valid JSON"));
    EXPECT_THAT(error_of(with_depth(camera("null"))),
                HasSubstr("rig.json#/cameras/depth/fx: must be a number"));
    EXPECT_THAT(error_of(with_depth(camera("\"nan\""))), HasSubstr("must be a number"));
    EXPECT_THAT(error_of(with_depth(R"({"width": 4.5})")),
                HasSubstr("/cameras/depth/width: must be a whole number"));
    EXPECT_THAT(error_of(with_depth(R"({"width": 18446744073709551615})")), HasSubstr("whole"));
    EXPECT_THAT(error_of(with_depth(R"({"width": 4, "heigth": 3})")),
                HasSubstr("unknown key \"heigth\""));
    EXPECT_THAT(error_of(with_depth(R"({"width": 4})")), HasSubstr("\"height\" is missing"));
    EXPECT_THAT(error_of(with_depth(camera("1"), R"(, "range_m": [3, 2])")), HasSubstr("range"));
    EXPECT_THAT(error_of(with_depth(camera("1"), R"(, "range_m": [3])")),
                HasSubstr("#/range_m: must be a list of 2"));
    EXPECT_THAT(
        error_of(with_depth(camera("1"), R"(, "color_from_depth": {"rotation_wxyz": [0,0,0,0]})")),
        HasSubstr("rigid"));
    EXPECT_THAT(error_of(R"({"kinoscope_rig": 2, "cameras": {}})"), HasSubstr("/kinoscope_rig"));
    for (const char* text : {"", "[]", "7", "null", "{", "\xFF\xFE", "{\"kinoscope_rig\": 1}"}) {
        EXPECT_FALSE(rig_from_json(text, "rig.json")) << text;
    }
    EXPECT_FALSE(rig_from_json(std::string(200'000, '['), "deep"));
}

}  // namespace
}  // namespace kino
