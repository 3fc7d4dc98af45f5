#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "tests/skeleton/gestures/fuzz/target.h"
#include "tests/support/temp_dir.h"

namespace kino {
namespace {

using testing::HasSubstr;

GestureTemplate circle() {
    std::vector<HandPath> paths(3);
    for (std::size_t e = 0; e < 3; ++e)
        for (int i = 0; i <= 30; ++i) {
            const double a = 6.283 * i / 30;
            const glm::dvec3 p(-0.3 + 0.3 * std::cos(a), 0.3 * std::sin(a),
                               0.6 + 0.01 * static_cast<double>(e));
            paths[e].samples.push_back({i / 30.0, {p, p}});
        }
    return *GestureTemplate::learn("circle", Hand::right, paths);
}

TEST(Definitions, RoundTrip) {
    GestureDefinitions defaults;
    const std::string text = gestures_to_json(defaults);
    auto back = gestures_from_json(text, "x");
    ASSERT_TRUE(back.has_value()) << back.error().to_string();
    EXPECT_EQ(gestures_to_json(*back), text);
    defaults.learned = {circle()};
    defaults.wave.min_swing = 0.22;
    back = gestures_from_json(gestures_to_json(defaults), "x");
    ASSERT_TRUE(back.has_value()) << back.error().to_string();
    EXPECT_EQ(back->wave.min_swing, 0.22);
    ASSERT_EQ(back->learned.size(), 1u);
    EXPECT_EQ(back->learned[0], defaults.learned[0]);
}

TEST(Definitions, TheManualListsTheDefaults) {
    const std::string manual = test::read_bytes("docs/gestures.md");
    EXPECT_THAT(manual, HasSubstr(gestures_to_json({})));
}

TEST(Definitions, WhatIsNotThereKeepsItsDefault) {
    const auto read =
        gestures_from_json(R"({"kinoscope_gestures": 1, "push": {"min_reach": 0.8}})", "x");
    ASSERT_TRUE(read.has_value());
    EXPECT_EQ(read->push.min_reach, 0.8);
    GestureDefinitions expected;
    expected.push.min_reach = 0.8;
    EXPECT_EQ(gestures_to_json(*read), gestures_to_json(expected));
}

TEST(Definitions, MistakesNameTheirJsonPointer) {
    const std::vector<std::array<const char*, 3>> cases = {
        {R"({})", "x#/", "kinoscope_gestures"},
        {R"({"kinoscope_gestures": 2})", "x#/kinoscope_gestures", ""},
        {R"({"kinoscope_gestures": 1, "waves": {}})", "x#/", "unknown key \"waves\""},
        {R"({"kinoscope_gestures": 1, "wave": {"swing": 1}})", "x#/wave", "unknown key \"swing\""},
        {R"({"kinoscope_gestures": 1, "wave": 3})", "x#/wave", "object"},
        {R"({"kinoscope_gestures": 1, "wave": {"min_swing": "a"}})", "x#/wave/min_swing", "number"},
        {R"({"kinoscope_gestures": 1, "wave": {"min_swing": -1}})", "x#/wave/min_swing", "between"},
        {R"({"kinoscope_gestures": 1, "dwell": {"radius": 0.5}})", "x#/dwell", "release_radius"},
        {R"({"kinoscope_gestures": 1, "stroke": {"max_s": 0.06}})", "x#/stroke", "min_s"},
        {R"({"kinoscope_gestures": 1, "learned": [3]})", "x#/learned/0", "object"},
        {R"({"kinoscope_gestures": 1, "learned": [{"name": "a", "hand": "foot"}]})",
         "x#/learned/0/hand", "left"},
        {R"([1])", "x#/", "object"},
    };
    for (const auto& [text, where, what] : cases) {
        const auto read = gestures_from_json(text, "x");
        ASSERT_FALSE(read.has_value()) << text;
        EXPECT_EQ(read.error().where, where) << text;
        EXPECT_THAT(read.error().what, HasSubstr(what)) << text;
    }
    EXPECT_FALSE(gestures_from_json("{", "x").has_value());
    GestureDefinitions twice;
    twice.learned = {circle(), circle()};
    EXPECT_EQ(gestures_from_json(gestures_to_json(twice), "x").error().where, "x#/learned/1");
}

TEST(Definitions, SeededMutationsNeverCrash) {
    GestureDefinitions full;
    full.learned = {circle()};
    const std::string seeds[] = {gestures_to_json({}), gestures_to_json(full),
                                 R"({"kinoscope_gestures":1,"wave":{"min_swing":0.2}})"};
    const std::string words[] = {
        "NaN", "null",   "1e999", "-1", "[", "{", "\"",       "true",   "18446744073709551615",
        "0.0", "1e-320", ",",     "]",  "}", ":", "\"wave\"", "\\ud800"};
    std::mt19937 random(9);
    for (int i = 0; i < 3000; ++i) {
        std::string text = seeds[static_cast<std::size_t>(i) % 3];
        for (unsigned n = 1 + random() % 4; n > 0; --n) {
            const std::size_t at = text.empty() ? 0 : random() % text.size();
            switch (random() % 4) {
                case 0:
                    if (!text.empty()) text[at] = static_cast<char>(random());
                    break;
                case 1:
                    text.insert(at, words[random() % std::size(words)]);
                    break;
                case 2:
                    text.erase(at, random() % 12);
                    break;
                default:
                    text.resize(i % 7 == 0 ? at : text.size());
            }
        }
        fuzz::gestures({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
    }
}

}  // namespace
}  // namespace kino
