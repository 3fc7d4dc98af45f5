#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/skeleton/gestures/logs.h"
#include "tests/skeleton/gestures/stage.h"

/// What people did before real trackers.
namespace kino {
namespace {

using test::kinds;
using test::motion_log;
using test::recognize;
using testing::ElementsAre;
using testing::IsEmpty;
using K = GestureKind;

TEST(Logs, TheWaveEngages) {
    const auto frames = motion_log("laban-wave");
    ASSERT_GT(frames.size(), 100u);
    const auto events = recognize(frames);
    EXPECT_THAT(kinds(events), ElementsAre(K::wave));
    ASSERT_EQ(events.size(), 2u);
    EXPECT_EQ(events[0].hand, Hand::right);
    EXPECT_EQ(events[1].kind, K::engaged);
}

// Somebody draws four long lines in the air before them, to and fro: those are swipes.
TEST(Logs, LinesInTheAirAreSwipes) {
    const auto frames = motion_log("laban-draw");
    ASSERT_GT(frames.size(), 100u);
    EXPECT_THAT(kinds(recognize(frames)),
                ElementsAre(K::swipe_right, K::swipe_left, K::swipe_right, K::swipe_left));
}

TEST(Logs, EverydayMotionGivesNothing) {
    double seconds = 0;
    for (const char* name : {"laban-point", "laban-arms", "keraal-ctk", "multitrack-4-2",
                             "multitrack-4-3", "multitrack-24-0", "multitrack-24-1"}) {
        const auto frames = motion_log(name);
        ASSERT_GT(frames.size(), 100u) << name;
        seconds += to_seconds(frames.back().time - frames.front().time);
        EXPECT_THAT(kinds(recognize(frames)), IsEmpty()) << name;
    }
    EXPECT_GT(seconds, 50);
}

// Whoever is in control keeps it while others pass by, stand beside and wave.
TEST(Logs, PassersByDoNotTakeOver) {
    const auto primary = test::record(test::scripted(Motion::wave), {});
    const auto calm = test::record(test::scripted(Motion::idle), {.start_s = 110});
    for (const char* name : {"multitrack-4-2", "multitrack-24-0", "laban-wave", "laban-draw"}) {
        GestureRecognizer recognizer;
        recognize(primary, recognizer);
        ASSERT_EQ(recognizer.primary_id(), 1u);
        auto others = motion_log(name, 110);
        for (BodyFrame& frame : others) frame.bodies[0].id = 2;
        auto both = test::together(calm, others);
        for (const GestureEvent& event : recognize(both, recognizer)) {
            EXPECT_FALSE(event.kind == K::engaged || event.kind == K::released) << name;
            EXPECT_EQ(event.primary, event.body_id == 1) << name;
        }
        EXPECT_EQ(recognizer.primary_id(), 1u) << name;
    }
}

}  // namespace
}  // namespace kino
