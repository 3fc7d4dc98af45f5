#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "tests/skeleton/gestures/scripts.h"

namespace kino {
namespace {

using test::arm;
using test::Key;
using test::keyed;
using test::kHangL;
using test::kHangR;
using test::kinds;
using test::recognize;
using test::record;
using test::scripted;
using testing::IsEmpty;
using K = GestureKind;

class AtRate : public testing::TestWithParam<double> {};

TEST_P(AtRate, EveryScriptGivesItsGesturesAndNoOther) {
    for (const test::Script& scene : test::scripts()) {
        const auto events = recognize(record(scene.pose, {scene.seconds, GetParam()}));
        EXPECT_EQ(kinds(events), scene.expected) << scene.name;
        for (const GestureEvent& e : events) {
            EXPECT_LE(e.start_time, e.time);
            EXPECT_GE(e.start_time, from_seconds(100));
            EXPECT_TRUE(e.confidence > 0.3f && e.confidence <= 1) << scene.name;
        }
    }
}
INSTANTIATE_TEST_SUITE_P(Gestures, AtRate, testing::Values(15.0, 30.0, 60.0));

TEST(Gestures, HappenAtTheSameTimeAtEveryRate) {
    for (const test::Script& scene : test::scripts()) {
        const auto slow = recognize(record(scene.pose, {scene.seconds, 15}));
        const auto fast = recognize(record(scene.pose, {scene.seconds, 60}));
        for (const GestureEvent& a : slow) {
            if (a.phase == GesturePhase::change) continue;
            double nearest_s = 1e9;
            for (const GestureEvent& b : fast)
                if (a.kind == b.kind && a.phase == b.phase)
                    nearest_s = std::min(nearest_s, std::abs(to_seconds(a.time - b.time)));
            EXPECT_LT(nearest_s, 0.2) << scene.name << " " << gesture_name(a.kind);
        }
    }
}

TEST(Gestures, RecallAndPrecisionWithNoise) {
    std::map<K, std::array<int, 3>> score;  // expected, found, seen
    int expected = 0, found = 0, seen = 0;
    for (const double noise_m : {0.005, 0.01, 0.015}) {
        for (std::uint64_t seed = 1; seed <= 3; ++seed) {
            for (const test::Script& scene : test::scripts()) {
                auto want = scene.expected;
                const auto got =
                    kinds(recognize(record(scene.pose, {scene.seconds, 30, noise_m, seed})));
                expected += static_cast<int>(want.size());
                seen += static_cast<int>(got.size());
                for (const K k : want) ++score[k][0];
                for (const K k : got) {
                    ++score[k][2];
                    const auto hit = std::find(want.begin(), want.end(), k);
                    if (hit == want.end()) {
                        std::printf("false %s in %s, noise %.3f seed %d\n",
                                    std::string(gesture_name(k)).c_str(), scene.name, noise_m,
                                    static_cast<int>(seed));
                        continue;
                    }
                    want.erase(hit);
                    ++found;
                    ++score[k][1];
                }
                for (const K k : want)
                    std::printf("missed %s in %s, noise %.3f seed %d\n",
                                std::string(gesture_name(k)).c_str(), scene.name, noise_m,
                                static_cast<int>(seed));
            }
        }
    }
    for (const auto& [kind, s] : score)
        std::printf("%-12s expected %3d found %3d seen %3d\n",
                    std::string(gesture_name(kind)).c_str(), s[0], s[1], s[2]);
    EXPECT_GE(found, 0.95 * expected);
    EXPECT_GE(found, 0.95 * seen);
}

TEST(Gestures, ScaleWithTheBody) {
    // A child's arms are as long in their own measure: the same events at 0.6 of the size.
    for (const test::Script& scene : test::scripts()) {
        auto frames = record(scene.pose, {scene.seconds, 30});
        for (BodyFrame& frame : frames)
            for (Body& body : frame.bodies) {
                const glm::vec3 base(0, 0.9f, 2.7f);
                for (JointPosition& j : body.joints)
                    j.position_m = base + 0.6f * (j.position_m - base);
            }
        EXPECT_EQ(kinds(recognize(frames)), scene.expected) << scene.name;
    }
}

TEST(Zoom, ValueIsTheRatioOfTheDistances) {
    for (const test::Script& scene : test::scripts()) {
        if (std::string_view(scene.name) != "zoom") continue;
        const auto events = recognize(record(scene.pose, {scene.seconds, 30}));
        std::vector<double> values;
        int begins = 0, ends = 0;
        for (const GestureEvent& e : events) {
            begins += e.phase == GesturePhase::begin;
            ends += e.phase == GesturePhase::end;
            values.push_back(e.value);
        }
        EXPECT_EQ(begins, 1);
        EXPECT_EQ(ends, 1);
        ASSERT_FALSE(values.empty());
        EXPECT_GT(*std::max_element(values.begin(), values.end()), 1.8);
    }
}

TEST(Rotate, ValueIsTheTurnWithItsSign) {
    const ArmPose level_l = arm(0, {0.4, -0.4, 0.9}, {0.2, 0.3, 1});
    const ArmPose level_r = arm(1, {0.4, -0.4, 0.9}, {0.2, 0.3, 1});
    for (const std::size_t high : {0u, 1u}) {
        const ArmPose up = arm(high, {0.4, -0.2, 0.9}, {0.2, 1, 0.8});
        const ArmPose down = arm(1 - high, {0.4, -0.7, 0.8}, {0.2, -0.15, 1});
        const ArmPose end_l = high == 0 ? up : down, end_r = high == 0 ? down : up;
        const auto events = recognize(record(keyed({{0, kHangL, kHangR},
                                                    {1, kHangL, kHangR},
                                                    {1.8, level_l, level_r},
                                                    {2.4, level_l, level_r},
                                                    {3.4, end_l, end_r},
                                                    {4, end_l, end_r},
                                                    {4.8, kHangL, kHangR}}),
                                             {6, 30}));
        double most = 0;
        int ends = 0;
        for (const GestureEvent& e : events) {
            if (e.kind != K::rotate) continue;
            if (std::abs(e.value) > std::abs(most)) most = e.value;
            ends += e.phase == GesturePhase::end;
        }
        EXPECT_EQ(ends, 1);
        EXPECT_GT(high == 0 ? most : -most, 0.43) << "the person's left hand goes up: clockwise";
        EXPECT_LT(std::abs(most), 1.2);
    }
}

TEST(Gestures, SameFramesGiveTheSameEventsAndAJumpBackStartsAnew) {
    const auto frames = record(scripted(Motion::swipe), {10, 30, 0.01, 4});
    GestureRecognizer recognizer;
    const auto first = recognize(frames, recognizer);
    EXPECT_EQ(first, recognize(frames, recognizer));
    EXPECT_THAT(recognizer.update(frames.back()), IsEmpty()) << "the same frame twice";
}

TEST(Gestures, NotANumberAndLostJointsMakeNoEventsAndNoHarm) {
    test::Random random(5);
    GestureRecognizer recognizer;
    for (BodyFrame frame : record(scripted(Motion::dance), {10, 30})) {
        for (JointPosition& joint : frame.bodies[0].joints) {
            if (random.chance(0.2)) joint.state = JointState::lost;
            if (random.chance(0.1)) joint.position_m.x = std::nanf("");
            if (random.chance(0.05)) joint.position_m = glm::vec3(0);
            if (random.chance(0.05)) joint.position_m.z = 3e38f;
            if (random.chance(0.05)) joint.confidence = std::nanf("");
        }
        for (const GestureEvent& e : recognizer.update(frame)) {
            EXPECT_TRUE(std::isfinite(e.value) && e.confidence >= 0 && e.confidence <= 1);
            EXPECT_LE(e.start_time, e.time);
        }
    }
    for (BodyFrame frame : record(scripted(Motion::wave), {10, 30})) {
        for (JointPosition& joint : frame.bodies[0].joints) joint.state = JointState::lost;
        EXPECT_THAT(recognizer.update(frame), IsEmpty());
    }
}

}  // namespace
}  // namespace kino
