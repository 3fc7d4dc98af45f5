#include "apps/viewer/frame_pacer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "tests/support/random.h"

namespace kino {
namespace {

constexpr TimeNs kPeriod = 33 * kNsPerMs;

/// Draws pictures one after the other, as a window does.
struct PacedWindow {
    FramePacer pacer{kPeriod};
    TimeNs now = 5 * kNsPerSecond;
    std::vector<TimeNs> shown;
    TimeNs longest_wait = 0;

    /// Returns the age of what the picture shows.
    TimeNs draw(TimeNs takes, TimeNs expected) {
        const TimeNs begin = pacer.begin_at(now, expected);
        EXPECT_GE(begin, now);
        const TimeNs ready = begin + takes;
        const TimeNs show = pacer.show_at(ready);
        EXPECT_GE(show, ready);
        longest_wait = std::max({longest_wait, begin - now, show - ready});
        pacer.shown(show);
        now = show;
        shown.push_back(show);
        return show - begin;
    }
    [[nodiscard]] TimeNs interval(std::size_t i) const { return shown[i] - shown[i - 1]; }
};

TEST(FramePacer, WhatIsReadyInTimeIsShownAtOneRateWithoutDrift) {
    test::Random random(1);
    PacedWindow window;
    constexpr int kPictures = 5000;
    for (int i = 0; i <= kPictures; ++i) {
        const auto takes = static_cast<TimeNs>(random.real(0.05, 1) * kPeriod);
        // A wrong expectation makes the picture older, not later.
        window.draw(takes, std::max(takes, static_cast<TimeNs>(random.real(0, 1) * kPeriod)));
    }
    for (std::size_t i = 1; i < window.shown.size(); ++i) ASSERT_EQ(window.interval(i), kPeriod);
    EXPECT_EQ(window.shown.back() - window.shown.front(), kPictures * kPeriod);
}

TEST(FramePacer, WaitsBeforeDrawingSoThatPicturesAreNew) {
    PacedWindow window;
    constexpr TimeNs kTakes = kPeriod / 4;
    window.draw(kTakes, kTakes);
    for (int i = 0; i < 20; ++i)
        EXPECT_EQ(window.draw(kTakes, kTakes + kNsPerMs), kTakes + kNsPerMs);
    // Knowing nothing of how long it takes, it is begun at once, and is older.
    EXPECT_EQ(window.draw(kTakes, kPeriod), kPeriod);
}

TEST(FramePacer, CatchesUpWithoutBursts) {
    test::Random random(2);
    PacedWindow window;
    for (int i = 0; i < 5000; ++i) {
        const double periods = random.chance(0.1) ? random.real(1, 4) : random.real(0.1, 0.9);
        window.draw(static_cast<TimeNs>(periods * kPeriod),
                    static_cast<TimeNs>(random.real(0, 1) * kPeriod));
    }
    for (std::size_t i = 1; i < window.shown.size(); ++i) {
        ASSERT_GE(window.interval(i), kPeriod - kPeriod / 10 - 1);
    }
    EXPECT_LE(window.longest_wait, kPeriod);

    // Four tenths late: four pictures later the turns are what they would have been.
    PacedWindow late;
    late.draw(0, 0);
    const TimeNs first = late.shown.front();
    late.draw(14 * kPeriod / 10, kPeriod);
    for (int i = 0; i < 4; ++i) late.draw(kPeriod / 4, kPeriod / 2);
    EXPECT_EQ(late.shown.back(), first + 5 * kPeriod);
    // Missed turns are not made up for.
    late.draw(10 * kPeriod, kPeriod);
    late.draw(kPeriod / 4, kPeriod / 2);
    EXPECT_EQ(late.interval(late.shown.size() - 1), kPeriod);
}

TEST(FramePacer, WhatIsAlwaysLateNeverWaits) {
    PacedWindow window;
    window.draw(0, 0);
    window.longest_wait = 0;
    for (int i = 0; i < 50; ++i) window.draw(13 * kPeriod / 10, 13 * kPeriod / 10);
    EXPECT_EQ(window.longest_wait, 0);
    for (std::size_t i = 1; i < window.shown.size(); ++i) {
        ASSERT_EQ(window.interval(i), 13 * kPeriod / 10);
    }
}

TEST(FramePacer, ClocksAndPeriodsThatJumpNeverMakeItWaitLonger) {
    test::Random random(3);
    FramePacer pacer(kPeriod);
    constexpr TimeNs kFar = std::numeric_limits<TimeNs>::max() / 8;
    TimeNs now = 0;
    for (int i = 0; i < 2000; ++i) {
        if (random.chance(0.1)) now = random.integer(0, 1) == 0 ? kFar : 0;
        if (random.chance(0.1)) {
            pacer.set_period(static_cast<TimeNs>(random.real(-5, 200) * kNsPerMs));
            ASSERT_GE(pacer.period(), kNsPerMs);
        }
        if (random.chance(0.05)) {
            pacer.restart();
            ASSERT_EQ(pacer.show_at(now), now);
        }
        const TimeNs begin = pacer.begin_at(now, random.chance(0.2) ? -5 : kPeriod / 2);
        ASSERT_GE(begin, now);
        ASSERT_LE(begin, now + pacer.period());
        const TimeNs show = pacer.show_at(begin);
        ASSERT_GE(show, begin);
        ASSERT_LE(show, begin + pacer.period());
        pacer.shown(show);
        now = show;
    }
}

}  // namespace
}  // namespace kino
