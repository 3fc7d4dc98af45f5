#include "sensor/live/live_source.h"

#include <gtest/gtest.h>

#include <atomic>
#include <future>
#include <thread>
#include <vector>

#include "live_source_fixture.h"

namespace kino {
namespace {

using namespace test;

using LiveSourceTest = LiveSourceFixture;

TEST_F(LiveSourceTest, EveryFrameReachesTheTapOnceAndInOrder) {
    bus.plug("A");
    const auto source = open();
    const Tapped tapped(*source);
    ASSERT_TRUE(source->subscribe(kDepth));
    ASSERT_TRUE(source->subscribe(kColor));
    const auto write = [&](StreamKind kind) {
        for (int i = 0; i < 2000; ++i) EXPECT_TRUE(bus.put("A", kind, fake_frame(kind, i, i + 1)));
    };
    std::thread color([&] { write(StreamKind::color); });
    write(StreamKind::depth);
    color.join();
    for (const auto kind : {StreamKind::depth, StreamKind::color}) {
        const auto headers = tapped.of(kind);
        ASSERT_EQ(headers.size(), 2000u);
        for (int i = 0; i < 2000; ++i) {
            ASSERT_EQ(headers[static_cast<std::size_t>(i)].sequence, i);
            ASSERT_EQ(headers[static_cast<std::size_t>(i)].host_time, i + 1);
        }
    }
    EXPECT_EQ(source->stats().frames, 4000);
}

TEST_F(LiveSourceTest, ADeviceThatIsNotThereIsAnError) {
    EXPECT_FALSE(make_live_source(bus.driver(), "A", options()));
    EXPECT_EQ(bus.open_devices(), 0);
}

TEST_F(LiveSourceTest, AnUnsubscribedStreamCostsNothingAndGivesNothing) {
    bus.plug("A");
    const auto source = open();
    const Tapped tapped(*source);
    ASSERT_TRUE(source->subscribe(kDepth));
    EXPECT_TRUE(bus.running("A", StreamKind::depth));
    EXPECT_FALSE(bus.running("A", StreamKind::color));
    EXPECT_FALSE(source->subscribe({0, StreamKind::bodies}));
    EXPECT_FALSE(source->subscribe({1, StreamKind::depth}));
    source->unsubscribe(kDepth);
    EXPECT_FALSE(bus.put("A", StreamKind::depth, fake_frame(StreamKind::depth, 0, 1)));
    EXPECT_TRUE(tapped.of(StreamKind::depth).empty());
    EXPECT_FALSE(*source->next(0));
}

TEST_F(LiveSourceTest, ComesBackByItselfAndEverythingGoesOnRising) {
    bus.plug("A");
    const auto source = open();
    const Tapped tapped(*source);
    ASSERT_TRUE(source->subscribe(kDepth));
    ASSERT_TRUE(source->controls()->set("tilt", 5));
    for (int i = 0; i < 10; ++i) {
        ASSERT_TRUE(bus.put("A", StreamKind::depth,
                            fake_frame(StreamKind::depth, i, (i + 100) * kPeriod, kPeriod)));
    }
    bus.unplug("A");
    ASSERT_TRUE(eventually([&] { return !source->stats().present; }));
    EXPECT_FALSE(source->controls()->set("tilt", 9));
    bus.plug("A");
    ASSERT_TRUE(eventually([&] { return source->stats().present; }));
    EXPECT_EQ(bus.setting("A", "tilt"), 5);
    EXPECT_EQ(bus.watches(), 0);
    // The device counts from 0 again, in everything.
    for (int i = 0; i < 10; ++i) {
        ASSERT_TRUE(bus.put("A", StreamKind::depth,
                            fake_frame(StreamKind::depth, i, (i + 200) * kPeriod, 200 * kPeriod)));
    }
    EXPECT_EQ(kinds(source->take_events()),
              (std::vector{EventKind::started, EventKind::lost, EventKind::back}));
    const auto headers = tapped.of(StreamKind::depth);
    ASSERT_EQ(headers.size(), 20u);
    for (std::size_t i = 0; i < 20; ++i) {
        EXPECT_EQ(headers[i].sequence, static_cast<std::int64_t>(i));
        EXPECT_EQ(headers[i].device_time, headers[i].host_time - kPeriod);
    }
    for (int i = 0; i < 20; ++i) {
        const auto set = source->next(0);
        ASSERT_TRUE(set && *set);
        EXPECT_EQ((*set)->index, i);
        EXPECT_EQ((*set)->depth->header.sequence, i);
    }
    EXPECT_FALSE(*source->next(0));
}

TEST_F(LiveSourceTest, OnlyTheSameUnitBringsItBack) {
    bus.plug("A");
    // A driver that opens whatever there is: the source itself must look at the serial.
    DeviceDriver careless = bus.driver();
    careless.open = [any = careless.open](const std::string&) { return any(""); };
    auto source = *make_live_source(careless, "A", options());
    ASSERT_TRUE(source->subscribe(kDepth));
    bus.unplug("A");
    ASSERT_TRUE(away(*source));
    const int before = bus.openings();
    bus.plug("B");
    ASSERT_TRUE(eventually([&] { return bus.openings() >= before + 3; }));
    EXPECT_FALSE(source->stats().present);
    EXPECT_FALSE(bus.running("B", StreamKind::depth));
    EXPECT_NE(source->stats().trouble, "");
    EXPECT_EQ(kinds(source->take_events()), (std::vector{EventKind::started, EventKind::lost}));
    bus.unplug("B");
    bus.plug("A");
    ASSERT_TRUE(present(*source));
    EXPECT_EQ(source->stats().trouble, "");
    EXPECT_EQ(kinds(source->take_events()), std::vector{EventKind::back});
    EXPECT_EQ(bus.open_devices(), 1);
}

TEST_F(LiveSourceTest, IsFoundByLookingWhereNothingWatches) {
    bus.make_watches_deaf();
    bus.plug("A");
    const auto source = open();
    ASSERT_TRUE(source->subscribe(kDepth));
    bus.unplug("A");
    ASSERT_TRUE(away(*source));
    bus.plug("A");
    EXPECT_TRUE(present(*source));
}

TEST_F(LiveSourceTest, ASubscriptionMadeWhileItIsAwayIsKept) {
    bus.plug("A");
    const auto source = open();
    ASSERT_TRUE(source->subscribe(kDepth));
    bus.unplug("A");
    ASSERT_TRUE(away(*source));
    EXPECT_TRUE(source->subscribe(kColor));
    source->unsubscribe(kDepth);
    bus.plug("A");
    ASSERT_TRUE(present(*source));
    EXPECT_TRUE(bus.running("A", StreamKind::color));
    EXPECT_FALSE(bus.running("A", StreamKind::depth));
}

TEST_F(LiveSourceTest, UnpluggedDuringAStart) {
    bus.plug("A");
    const auto source = open();
    ASSERT_TRUE(source->subscribe(kDepth));
    bus.on_start([this](StreamId) {
        bus.on_start({});
        bus.unplug("A");
    });
    EXPECT_TRUE(source->subscribe(kColor));
    ASSERT_TRUE(away(*source));
    bus.plug("A");
    ASSERT_TRUE(present(*source));
    EXPECT_TRUE(bus.running("A", StreamKind::depth));
    EXPECT_TRUE(bus.running("A", StreamKind::color));
    EXPECT_EQ(kinds(source->take_events()),
              (std::vector{EventKind::started, EventKind::lost, EventKind::back}));
}

TEST_F(LiveSourceTest, UnpluggedDuringTheRestartIsToldOnceOnly) {
    bus.plug("A");
    const auto source = open();
    ASSERT_TRUE(source->subscribe(kDepth));
    ASSERT_TRUE(source->subscribe(kColor));
    bus.unplug("A");
    ASSERT_TRUE(away(*source));
    std::atomic<int> starts = 0;
    bus.on_start([&](StreamId) {
        // The second stream of the first two restarts.
        if (const int n = ++starts; n == 2 || n == 4) {
            bus.unplug("A");
            bus.plug("A");
        }
    });
    bus.plug("A");
    ASSERT_TRUE(eventually([&] { return starts >= 6 && source->stats().present; }));
    EXPECT_EQ(kinds(source->take_events()),
              (std::vector{EventKind::started, EventKind::lost, EventKind::back}));
    EXPECT_EQ(bus.open_devices(), 1);
}

TEST_F(LiveSourceTest, OneThatWasUnpluggedWhileNoStreamRanIsMissedAtTheNextStart) {
    bus.plug("A");
    const auto source = open();
    bus.unplug("A");
    EXPECT_TRUE(source->subscribe(kDepth));
    EXPECT_FALSE(source->stats().present);
    bus.plug("A");
    ASSERT_TRUE(present(*source));
    EXPECT_TRUE(bus.running("A", StreamKind::depth));
    EXPECT_EQ(kinds(source->take_events()),
              (std::vector{EventKind::started, EventKind::lost, EventKind::back}));
}

TEST_F(LiveSourceTest, OneThatWentAndCameWhileNoStreamRanIsOpenedAnew) {
    bus.plug("A");
    const auto source = open();
    const Tapped tapped(*source);
    bus.unplug("A");
    bus.plug("A");
    ASSERT_TRUE(source->subscribe(kDepth));
    EXPECT_TRUE(bus.put("A", StreamKind::depth, fake_frame(StreamKind::depth, 0, 1)));
    EXPECT_EQ(tapped.of(StreamKind::depth).size(), 1u);
    EXPECT_EQ(bus.open_devices(), 1);
}

TEST_F(LiveSourceTest, ARefusedStreamIsAnErrorAndTheOthersGoOn) {
    bus.plug("A");
    const auto source = open();
    bus.refuse(StreamKind::color, true);
    ASSERT_TRUE(source->subscribe(kDepth));
    EXPECT_FALSE(source->subscribe(kColor));
    EXPECT_TRUE(bus.put("A", StreamKind::depth, fake_frame(StreamKind::depth, 0, 1)));
    // Nothing waits for colour.
    const auto set = source->next(0);
    ASSERT_TRUE(set && *set);
    bus.refuse(StreamKind::color, false);
    EXPECT_TRUE(source->subscribe(kColor));
}

TEST_F(LiveSourceTest, AStreamThatIsRefusedAfterTheReturnIsTriedUntilItRuns) {
    bus.plug("A");
    const auto source = open();
    ASSERT_TRUE(source->subscribe(kDepth));
    bus.unplug("A");
    ASSERT_TRUE(away(*source));
    bus.refuse(StreamKind::depth, true);
    const int before = bus.openings();
    bus.plug("A");
    ASSERT_TRUE(eventually([&] { return bus.openings() >= before + 3; }));
    EXPECT_FALSE(source->stats().present);
    EXPECT_NE(source->stats().trouble.find("refused"), std::string::npos);
    bus.refuse(StreamKind::depth, false);
    ASSERT_TRUE(present(*source));
    EXPECT_EQ(kinds(source->take_events()),
              (std::vector{EventKind::started, EventKind::lost, EventKind::back}));
}

TEST_F(LiveSourceTest, SettingsComeBackInTheOrderInWhichTheyWereMade) {
    bus.plug("A");
    const auto source = open();
    ASSERT_TRUE(source->subscribe(kDepth));
    ASSERT_TRUE(source->controls()->set("tilt", 5));
    ASSERT_TRUE(source->controls()->set("led", 2));
    ASSERT_TRUE(source->controls()->set("tilt", 7));
    EXPECT_FALSE(source->controls()->set("none", 1));
    EXPECT_EQ(source->controls()->list().size(), 2u);
    bus.forget_settings();
    bus.unplug("A");
    ASSERT_TRUE(away(*source));
    bus.plug("A");
    ASSERT_TRUE(present(*source));
    EXPECT_EQ(bus.settings_made(), (std::vector<std::string>{"led 2", "tilt 7"}));
    EXPECT_EQ(*source->controls()->get("tilt"), 7);
}

TEST_F(LiveSourceTest, AControlDoesNotWaitForADeviceThatHangs) {
    bus.plug("A");
    LiveOptions impatient = options();
    impatient.control_timeout = 10 * kNsPerMs;
    std::promise<void> release;
    const auto source = open(impatient);
    bus.on_set([released = release.get_future().share()] { released.wait(); });
    EXPECT_FALSE(source->controls()->set("tilt", 5));
    EXPECT_FALSE(source->controls()->set("led", 3));
    bus.on_set({});
    release.set_value();
    // The one that was under way still counts, the one that had not begun was called off.
    ASSERT_TRUE(eventually([&] { return bus.setting("A", "tilt") == 5; }));
    ASSERT_TRUE(eventually([&] { return source->controls()->get("led").has_value(); }));
    EXPECT_EQ(bus.setting("A", "led"), 0);
}

TEST_F(LiveSourceTest, CalibrationIsKnownWhileTheDeviceIsAway) {
    bus.plug("A");
    const auto source = open();
    ASSERT_TRUE(source->subscribe(kDepth));
    EXPECT_EQ(source->calibration()->serial, "A");
    bus.unplug("A");
    ASSERT_TRUE(away(*source));
    EXPECT_EQ(source->calibration()->serial, "A");
    EXPECT_EQ(source->info().serial, "A");
}

TEST_F(LiveSourceTest, TheOpenerTakesItsSchemeAndListsWhatIsThere) {
    bus.plug("A");
    bus.plug("B");
    const SourceOpener opener = live_opener(bus.driver());
    EXPECT_TRUE(opener.probe("fake:"));
    EXPECT_FALSE(opener.probe("fakes:A"));
    EXPECT_EQ(opener.list(), (std::vector<std::string>{"fake:A", "fake:B"}));
    const auto source = opener.open("fake:B");
    ASSERT_TRUE(source);
    EXPECT_EQ((*source)->info().serial, "B");
}

}  // namespace
}  // namespace kino
