#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "tests/skeleton/gestures/fuzz/gesture_event_target.h"

namespace kino {
namespace {

using testing::HasSubstr;

std::vector<GestureEvent> samples() {
    std::vector<GestureEvent> out;
    for (std::size_t i = 0; i < kGestureKindCount; ++i) {
        out.push_back({.kind = static_cast<GestureKind>(i),
                       .phase = static_cast<GesturePhase>(i % 4),
                       .hand = static_cast<Hand>(i / 2 % 4),
                       .body_id = static_cast<std::uint32_t>(4'000'000'000u + i),
                       .primary = i % 3 == 0,
                       .time = 98'765'432'101'251 + static_cast<TimeNs>(i),
                       .start_time = -5,
                       .confidence = 1.0f / static_cast<float>(i + 3),
                       .value = i == 3 ? -0.0 : 1.0 / 3 - static_cast<double>(i),
                       .name = i == 12 ? "c\xC3\xADrculo \"\n" : ""});
    }
    return out;
}

TEST(GestureJson, ReadsBackToTheSameBits) {
    for (const GestureEvent& event : samples()) {
        const std::string text = gesture_to_json(event);
        const auto read = gesture_event_from_json(text, "x");
        ASSERT_TRUE(read.has_value()) << text;
        EXPECT_EQ(*read, event) << text;
        EXPECT_EQ(std::signbit(read->value), std::signbit(event.value));
        for (const char c : text) EXPECT_TRUE(c >= 32 && c < 127);
    }
}

TEST(GestureJson, WhatIsNotFiniteIsZero) {
    GestureEvent event;
    event.value = std::numeric_limits<double>::quiet_NaN();
    event.confidence = std::numeric_limits<float>::infinity();
    const auto read = gesture_event_from_json(gesture_to_json(event), "x");
    ASSERT_TRUE(read.has_value());
    EXPECT_EQ(read->value, 0);
    EXPECT_EQ(read->confidence, 0);
}

TEST(GestureJson, MistakesAreNamed) {
    const auto problem = [](const char* text) {
        const auto read = gesture_event_from_json(text, "x");
        return read ? std::string("none") : read.error().to_string();
    };
    EXPECT_EQ(problem(R"({"gesture": "push", "body": 1, "time_ns": 5, "later": [1]})"), "none");
    EXPECT_THAT(problem(R"({"body": 1, "time_ns": 5})"), HasSubstr("gesture"));
    EXPECT_THAT(problem(R"({"gesture": "yawn", "body": 1, "time_ns": 5})"), HasSubstr("yawn"));
    EXPECT_THAT(problem(R"({"gesture": "push", "body": -1, "time_ns": 5})"), HasSubstr("body"));
    EXPECT_THAT(problem(R"({"gesture": "push", "body": 1, "time_ns": 5, "hand": "foot"})"),
                HasSubstr("foot"));
    EXPECT_THAT(problem(R"({"gesture": "push", "body": 1, "time_ns": 5, "start_ns": 6})"),
                HasSubstr("start_ns"));
    EXPECT_THAT(problem(R"({"gesture": "push", "body": 1, "time_ns": 5, "confidence": 2})"),
                HasSubstr("confidence"));
}

TEST(GestureJson, ForAPerson) {
    GestureEvent event{.kind = GestureKind::wave, .hand = Hand::right, .body_id = 2};
    EXPECT_EQ(gesture_text(event), "wave, right hand, person 2");
    event = {.kind = GestureKind::zoom,
             .phase = GesturePhase::end,
             .hand = Hand::both,
             .body_id = 1,
             .value = 1.5};
    EXPECT_EQ(gesture_text(event), "zoom ends at 1.50, both hands, person 1");
    const Event out = event_of(event);
    EXPECT_EQ(out.kind, EventKind::gesture);
    EXPECT_EQ(*gesture_event_from_json(out.detail, "x"), event);
}

TEST(GestureJson, SeededMutationsNeverCrash) {
    std::mt19937 random(11);
    const auto seeds = samples();
    const std::string words[] = {"NaN", "null", "1e999", "-1", "[[", "{", "\"", "true", "\\ud800"};
    for (int i = 0; i < 3000; ++i) {
        std::string text = gesture_to_json(seeds[static_cast<std::size_t>(i) % seeds.size()]);
        fuzz::gesture_event({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
        for (unsigned n = 1 + random() % 4; n > 0 && !text.empty(); --n) {
            const std::size_t at = random() % text.size();
            switch (random() % 3) {
                case 0:
                    text[at] = static_cast<char>(random());
                    break;
                case 1:
                    text.insert(at, words[random() % std::size(words)]);
                    break;
                default:
                    text.erase(at, random() % 12);
            }
        }
        fuzz::gesture_event({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
    }
}

}  // namespace
}  // namespace kino
