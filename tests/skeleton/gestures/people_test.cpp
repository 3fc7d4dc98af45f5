#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <glm/geometric.hpp>

#include "tests/skeleton/gestures/scripts.h"

/// Who is in control, what everyday motion does, and learned gestures.
namespace kino {
namespace {

using test::arm;
using test::Key;
using test::keyed;
using test::kinds;
using test::recognize;
using test::record;
using test::scripted;
using test::together;
using testing::IsEmpty;
using K = GestureKind;

std::vector<BodyFrame> moved(std::vector<BodyFrame> frames, const glm::vec3& by,
                             double later_s = 0) {
    for (BodyFrame& frame : frames) {
        frame.time += from_seconds(later_s);
        for (Body& body : frame.bodies)
            for (JointPosition& joint : body.joints) joint.position_m += by;
    }
    return frames;
}

std::vector<GestureEvent> only(const std::vector<GestureEvent>& events, K kind) {
    std::vector<GestureEvent> out;
    for (const GestureEvent& e : events)
        if (e.kind == kind) out.push_back(e);
    return out;
}

test::Take take(std::uint32_t id, double start_s = 100) {
    test::Take out;
    out.id = id;
    out.start_s = start_s;
    return out;
}

TEST(Primary, AWaveEngagesAndAPasserByDoesNotSteal) {
    const auto first = record(scripted(Motion::wave), take(1));
    // Another waves from half a second later on, and goes on when the first has stopped.
    auto both = together(record(scripted(Motion::idle), take(1, 110)),
                         moved(record(scripted(Motion::wave), take(2, 110)), {1.2f, 0, 0.3f}));
    GestureRecognizer recognizer;
    auto events = recognize(first, recognizer);
    ASSERT_EQ(only(events, K::engaged).size(), 1u);
    EXPECT_EQ(only(events, K::engaged)[0].body_id, 1u);
    EXPECT_EQ(recognizer.primary_id(), 1u);
    // The first one's own second wave would be an offer: let it run out.
    events = recognize(both, recognizer);
    EXPECT_THAT(only(events, K::engaged), IsEmpty());
    EXPECT_EQ(only(events, K::wave).size(), 1u);
    EXPECT_FALSE(only(events, K::wave)[0].primary);
    EXPECT_EQ(recognizer.primary_id(), 1u);
}

TEST(Primary, IsReleasedWhenLostAndThenFree) {
    GestureRecognizer recognizer;
    recognize(record(scripted(Motion::wave), take(1)), recognizer);
    auto alone = record(scripted(Motion::idle), take(2, 110));
    const auto events = recognize(alone, recognizer);
    const auto released = only(events, K::released);
    ASSERT_EQ(released.size(), 1u);
    EXPECT_EQ(released[0].body_id, 1u);
    EXPECT_NEAR(to_seconds(released[0].time), 110 + 1.5, 0.1);
    EXPECT_EQ(recognizer.primary_id(), 0u);
    recognize(record(scripted(Motion::wave), take(2, 120)), recognizer);
    EXPECT_EQ(recognizer.primary_id(), 2u);
}

TEST(Primary, IsReleasedAfterLeavingButNotByAShortOcclusion) {
    GestureRecognizer recognizer;
    recognize(record(scripted(Motion::wave), take(1)), recognizer);
    auto frames = record(scripted(Motion::idle), take(1, 110));
    for (std::size_t i = 60; i < 90; ++i) frames[i].bodies.clear();
    EXPECT_THAT(only(recognize(frames, recognizer), K::released), IsEmpty());
    EXPECT_EQ(recognizer.primary_id(), 1u);
    const auto far = moved(record(scripted(Motion::idle), take(1, 120)), {0, 0, 2});
    const auto released = only(recognize(far, recognizer), K::released);
    ASSERT_EQ(released.size(), 1u);
    EXPECT_NEAR(to_seconds(released[0].time), 122, 0.2);
}

TEST(Primary, HandsOverByWavingAgain) {
    PrimaryUser user;
    const PrimaryDefinition d;
    EXPECT_TRUE(user.wave(1, 0, 2, d));
    EXPECT_FALSE(user.wave(2, kNsPerSecond, 2, d)) << "stolen";
    EXPECT_FALSE(user.wave(1, 2 * kNsPerSecond, 2, d));
    EXPECT_TRUE(user.wave(2, 4 * kNsPerSecond, 2, d));
    EXPECT_FALSE(user.wave(1, 5 * kNsPerSecond, 2, d)) << "the offer was for one";
    EXPECT_FALSE(user.wave(2, 6 * kNsPerSecond, 2, d));
    EXPECT_FALSE(user.wave(1, 12 * kNsPerSecond, 2, d)) << "the offer has run out";
    EXPECT_FALSE(user.wave(3, 12 * kNsPerSecond, 9, d)) << "too far away";
    user.hand_over(0, 13 * kNsPerSecond);
    EXPECT_TRUE(user.wave(3, 14 * kNsPerSecond, 2, d));
}

TEST(Everyday, FiveMinutesGiveAtMostOneFalseEvent) {
    int total = 0;
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
        test::Take long_take = take(1);
        long_take.seconds = 300;
        long_take.noise_m = 0.008;
        long_take.seed = seed;
        const auto got = kinds(recognize(record(test::everyday(seed, 300), long_take)));
        for (const K k : got)
            std::printf("false %s, seed %d\n", std::string(gesture_name(k)).c_str(),
                        static_cast<int>(seed));
        total += static_cast<int>(got.size());
    }
    EXPECT_LE(total, 4);
}

// A circle before the chest, at another speed and size each time.
test::PoseAt circling(double seconds, double size, double start_s, bool backwards = false) {
    return [=](double t) {
        BodyPose pose = pose_at(Motion::idle, t);
        const double w = std::clamp((t - start_s) / seconds, 0.0, 1.0);
        const double a = (backwards ? -1 : 1) * 2 * std::numbers::pi * test::smooth_step(w);
        const double up = test::smooth_step((t - start_s + 1.2) / 0.8) *
                          test::smooth_step((start_s + seconds + 1.3 - t) / 0.8);
        BodyPose on = pose;
        on.arm[1] = arm(1, {0.2 + 0.8 * size * std::sin(a), -0.35 - 0.8 * size * std::cos(a), 0.9},
                        {0.1 + size * std::sin(a), 0.1 - size * std::cos(a), 1});
        return blend(pose, on, up);
    };
}

HandPath example(double seconds, double size, std::uint64_t seed) {
    test::Take one = take(1);
    one.seconds = 2 + seconds;
    one.noise_m = 0.005;
    one.seed = seed;
    GestureRecognizer recognizer;
    recognize(record(circling(seconds, size, 2), one), recognizer);
    return recognizer.recent_hands(1, seconds);
}

TEST(Learned, ACircleFromThreeExamplesIsFoundAndOthersAreNot) {
    const std::vector<HandPath> examples = {example(1.2, 0.5, 1), example(1.4, 0.55, 2),
                                            example(1.1, 0.45, 3)};
    const auto learned = GestureTemplate::learn("circle", Hand::right, examples);
    ASSERT_TRUE(learned.has_value()) << learned.error().to_string();
    GestureDefinitions definitions;
    definitions.learned = {*learned};
    const auto found = [&](const test::PoseAt& pose, double rate_hz) {
        GestureRecognizer recognizer(definitions);
        test::Take one = take(1);
        one.rate_hz = rate_hz;
        one.noise_m = 0.005;
        one.seed = 77;
        return only(recognize(record(pose, one), recognizer), K::learned).size();
    };
    for (const double rate_hz : {15.0, 30.0, 60.0}) {
        EXPECT_EQ(found(circling(1.3, 0.5, 3), rate_hz), 1u) << rate_hz;
        EXPECT_EQ(found(circling(1.0, 0.55, 3), rate_hz), 1u) << rate_hz;
        EXPECT_EQ(found(circling(1.3, 0.5, 3, true), rate_hz), 0u) << "backwards, " << rate_hz;
    }
    for (const Motion motion : {Motion::idle, Motion::walk, Motion::swipe, Motion::wave,
                                Motion::raise, Motion::push, Motion::tpose, Motion::squat})
        EXPECT_EQ(found(scripted(motion), 30), 0u) << motion_name(motion);
}

TEST(Learned, BadExamplesAreRefused) {
    const HandPath good = example(1.2, 0.5, 1);
    HandPath still = good;
    for (auto& s : still.samples) s.hand = good.samples[0].hand;
    HandPath reversed = good;
    for (std::size_t i = 0; i < good.samples.size(); ++i)
        reversed.samples[i].hand = good.samples[good.samples.size() - 1 - i].hand;
    for (auto& s : reversed.samples) s.hand[1] *= 2.5;
    HandPath nan = good;
    nan.samples[3].hand[1].x = std::nan("");
    const auto learn = [&](std::vector<HandPath> paths) {
        return GestureTemplate::learn("a", Hand::right, paths).has_value();
    };
    EXPECT_TRUE(learn({good, good, good}));
    EXPECT_FALSE(learn({good, good}));
    EXPECT_FALSE(learn({good, good, still}));
    EXPECT_FALSE(learn({good, good, reversed}));
    EXPECT_FALSE(learn({good, good, nan}));
    EXPECT_FALSE(learn({good, good, {}}));
}

// The recursion of the whole table; 64 is the weight of every way through it.
TEST(Learned, DistanceIsThatOfThePlainTable) {
    test::Random random(3);
    for (int round = 0; round < 20; ++round) {
        HandPath a, b;
        for (HandPath* path : {&a, &b}) {
            glm::dvec3 p(0);
            for (int i = 0; i < 32; ++i) {
                p += glm::dvec3(random.real(-0.1, 0.1), random.real(-0.1, 0.1),
                                random.real(-0.1, 0.1));
                path->samples.push_back({i / 31.0, {p, p}});
            }
        }
        double table[32][32];
        for (int i = 0; i < 32; ++i)
            for (int j = 0; j < 32; ++j) {
                table[i][j] = 1e9;
                if (std::abs(i - j) > 6) continue;
                const double cost = glm::distance(a.samples[static_cast<std::size_t>(i)].hand[1],
                                                  b.samples[static_cast<std::size_t>(j)].hand[1]);
                if (i == 0 && j == 0) table[i][j] = 2 * cost;
                if (i > 0 && j > 0) table[i][j] = table[i - 1][j - 1] + 2 * cost;
                if (i > 0) table[i][j] = std::min(table[i][j], table[i - 1][j] + cost);
                if (j > 0) table[i][j] = std::min(table[i][j], table[i][j - 1] + cost);
            }
        const auto one = GestureTemplate::learn("a", Hand::right, std::vector<HandPath>(3, b));
        ASSERT_TRUE(one.has_value());
        EXPECT_NEAR(one->distance(a), table[31][31] / 64, 1e-9);
    }
}

TEST(Learned, DistanceIsZeroToItselfAndBlindToSpeed) {
    const HandPath path = example(1.2, 0.5, 1);
    const auto one = *GestureTemplate::learn("a", Hand::right, std::vector<HandPath>(3, path));
    EXPECT_NEAR(one.distance(path), 0, 1e-12);
    HandPath slow = path;
    for (auto& s : slow.samples) s.time_s = 3 * s.time_s + 7;
    EXPECT_NEAR(one.distance(slow), 0, 1e-9);
    HandPath aside = path;
    for (auto& s : aside.samples) s.hand[1].x += 0.3;
    EXPECT_GT(one.distance(aside), 0.1);
    EXPECT_LE(one.distance(aside), 0.3 + 1e-12);
}

}  // namespace
}  // namespace kino
