#include "sensor/live/composite.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "live_source_fixture.h"
#include "sensor/pairing.h"
#include "sensor/recording_source.h"
#include "tests/support/temp_dir.h"

namespace kino {
namespace {

using namespace test;

/// A frame's own index is its sequence.
class NumberedReader final : public FrameReader {
  public:
    Result<std::shared_ptr<const DepthFrame>> depth(std::int64_t index) override {
        return std::get<std::shared_ptr<const DepthFrame>>(
            fake_frame(StreamKind::depth, index, index));
    }
    Result<std::shared_ptr<const ColorFrame>> color(std::int64_t index) override {
        if (index == 13) return fail("unreadable", "frame 13");
        return std::get<std::shared_ptr<const ColorFrame>>(
            fake_frame(StreamKind::color, index, index));
    }
};

std::unique_ptr<Source> recording(const std::string& name, const std::vector<TimeNs>& times,
                                  const std::vector<StreamKind>& with) {
    Recording recording;
    recording.info.uri = recording.info.name = name;
    recording.rig.serial = name;
    for (const StreamKind kind : with) recording.info.streams.push_back({{0, kind}, 2, 2, 30, ""});
    if (with.back() == StreamKind::color)
        recording.rig.color = CameraModel{.width = 640, .height = 480};
    for (std::size_t i = 0; i < times.size(); ++i) {
        recording.frames.push_back({times[i], static_cast<std::int64_t>(i), true, {}});
    }
    recording.reader = std::make_unique<NumberedReader>();
    return make_recording_source(std::move(recording));
}

std::vector<TimeNs> every(TimeNs period, int count) {
    std::vector<TimeNs> times;
    for (int i = 0; i < count; ++i) times.push_back(5 * kNsPerSecond + i * period);
    return times;
}

TEST(RecordedComposite, PairsByTimeFromTheFirstFramesOnAndSeeksExactly) {
    const auto depth_times = every(kPeriod, 60);
    auto color_times = every(kPeriod * 3 / 2, 30);
    for (TimeNs& time : color_times) time += kNsPerSecond;
    const auto made = make_composite_source(recording("d", depth_times, {StreamKind::depth}),
                                            recording("c", color_times, {StreamKind::color}));
    ASSERT_TRUE(made);
    Source& source = **made;
    ASSERT_TRUE(subscribe_all(source));
    ASSERT_EQ(source.timeline()->frame_count(), 60);
    for (TimeNs& time : color_times) time -= 6 * kNsPerSecond;
    const auto check = [&](std::int64_t index) {
        const auto set = source.next(0);
        const auto expected =
            pair_in_time(color_times, index * kPeriod, pairing_limit(color_times));
        if (expected->index == 13) {
            EXPECT_FALSE(set);
            return;
        }
        ASSERT_TRUE(set && *set);
        EXPECT_EQ((*set)->index, index);
        EXPECT_EQ((*set)->depth->header.sequence, index);
        EXPECT_EQ((*set)->color->header.sequence, static_cast<std::int64_t>(expected->index));
        EXPECT_EQ((*set)->color_paired, expected->paired);
    };
    for (std::int64_t i = 0; i < 60; ++i) check(i);
    EXPECT_FALSE(*source.next(0));
    EXPECT_EQ(kinds(source.take_events()), (std::vector{EventKind::started, EventKind::ended}));
    for (const std::int64_t i : {59, 3, 3, 40, 0}) {
        ASSERT_TRUE(source.timeline()->seek(i));
        check(i);
    }
    source.unsubscribe(kColor);
    EXPECT_EQ((*source.next(0))->color, nullptr);
}

TEST(Composite, TakesDepthFromWhicheverHasIt) {
    const auto made = make_composite_source(recording("c", every(kPeriod, 3), {StreamKind::color}),
                                            recording("d", every(kPeriod, 5), {StreamKind::depth}));
    ASSERT_TRUE(made);
    EXPECT_EQ((*made)->info().uri, "d+c");
    EXPECT_EQ((*made)->timeline()->frame_count(), 5);
    const auto rig = (*made)->calibration();
    ASSERT_TRUE(rig);
    EXPECT_EQ(rig->serial, "d");
    EXPECT_EQ(rig->color->width, 640);
    EXPECT_NE(rig->note, "");
}

TEST(Composite, ColorOfTheDepthSourceGivesWay) {
    const auto made = make_composite_source(
        recording("both", every(kPeriod, 3), {StreamKind::depth, StreamKind::color}),
        recording("c", every(kPeriod, 3), {StreamKind::color}));
    ASSERT_TRUE(made);
    EXPECT_EQ((*made)->info().streams.size(), 2u);
}

struct CompositeTest : LiveSourceFixture {
    std::unique_ptr<Source> live(const std::string& serial) {
        return *make_live_source(bus.driver(), serial, options());
    }
};

TEST_F(CompositeTest, WhatDoesNotBelongTogetherIsRefused) {
    bus.plug("A");
    const auto depth = [] { return recording("d", every(kPeriod, 3), {StreamKind::depth}); };
    const auto color = [] { return recording("c", every(kPeriod, 3), {StreamKind::color}); };
    EXPECT_FALSE(make_composite_source(live("A"), color()));
    EXPECT_FALSE(make_composite_source(depth(), depth()));
    EXPECT_FALSE(make_composite_source(color(), color()));
    EXPECT_EQ(bus.open_devices(), 0);
}

TEST_F(CompositeTest, TwoDevicesGiveOneStreamOfSets) {
    bus.plug("A");
    bus.plug("B");
    const auto made = make_composite_source(
        live("A"), live("B"),
        {.waiting_sets = 1000, .history = 1000, .patience = 3600 * kNsPerSecond});
    ASSERT_TRUE(made);
    Source& source = **made;
    Tapped tapped(source);
    ASSERT_TRUE(source.subscribe(kDepth));
    ASSERT_TRUE(source.subscribe(kColor));
    EXPECT_TRUE(bus.running("A", StreamKind::depth));
    EXPECT_FALSE(bus.running("A", StreamKind::color));
    EXPECT_TRUE(bus.running("B", StreamKind::color));
    const auto put_both = [&](int from, int to) {
        for (int i = from; i < to; ++i) {
            const TimeNs time = (i + 1) * kPeriod;
            (void)bus.put("B", StreamKind::color, fake_frame(StreamKind::color, i, time - 1));
            (void)bus.put("A", StreamKind::depth, fake_frame(StreamKind::depth, i, time));
            (void)bus.put("A", StreamKind::color, fake_frame(StreamKind::color, 1000, time));
        }
    };
    put_both(0, 20);
    (void)bus.put("B", StreamKind::color, fake_frame(StreamKind::color, 20, 21 * kPeriod));
    for (int i = 0; i < 20; ++i) {
        const auto set = source.next(0);
        ASSERT_TRUE(set && *set) << i;
        EXPECT_EQ((*set)->depth->header.sequence, i);
        ASSERT_TRUE((*set)->color_paired);
        EXPECT_EQ((*set)->color->header.sequence, i);
    }
    EXPECT_EQ(tapped.of(StreamKind::depth).size(), 20u);
    EXPECT_EQ(tapped.of(StreamKind::color).size(), 21u);

    // One of the two may come and go: the other goes on.
    bus.unplug("B");
    auto& stats = dynamic_cast<LiveSource&>(source);
    ASSERT_TRUE(away(stats));
    put_both(30, 32);
    ASSERT_TRUE(*source.next(0));
    bus.plug("B");
    ASSERT_TRUE(present(stats));
    const auto events = source.take_events();
    EXPECT_EQ(test::kinds(events),
              (std::vector{EventKind::started, EventKind::lost, EventKind::back}));
    EXPECT_NE(events[1].text.find("Fake B"), std::string::npos);
    EXPECT_EQ(stats.stats().losses, 1);
}

TEST_F(CompositeTest, ControlsOfBothAreReached) {
    bus.plug("A");
    bus.plug("B");
    const auto made = make_composite_source(live("A"), live("B"));
    Controls& controls = *(*made)->controls();
    std::vector<std::string> ids;
    for (const Control& control : controls.list()) ids.push_back(control.id);
    EXPECT_EQ(ids, (std::vector<std::string>{"tilt", "led", "color.tilt", "color.led"}));
    ASSERT_TRUE(controls.set("tilt", 3));
    ASSERT_TRUE(controls.set("color.tilt", 4));
    EXPECT_EQ(bus.setting("A", "tilt"), 3);
    EXPECT_EQ(bus.setting("B", "tilt"), 4);
    EXPECT_EQ(*controls.get("color.tilt"), 4);
    EXPECT_FALSE(controls.set("color.none", 1));
}

TEST_F(CompositeTest, TheOpenerSplitsOnlyWhatIsTwo) {
    register_source(live_opener(bus.driver()));
    const SourceOpener opener = composite_opener();
    register_source(opener);
    bus.plug("A");
    bus.plug("B+C");
    EXPECT_TRUE(opener.probe("fake:A+fake:A"));
    // A scheme knows what a '+' in its own part means.
    EXPECT_FALSE(opener.probe("fake:B+C"));
    EXPECT_FALSE(opener.probe("fake:A"));
    EXPECT_FALSE(opener.probe("+"));
    EXPECT_FALSE(opener.probe("no+such"));
    const TempDir dir;
    const auto odd = dir.write("one+two/depth.txt", "");
    EXPECT_FALSE(opener.probe(odd.string()));
    EXPECT_FALSE(opener.probe((dir / "one+two").string()));
    EXPECT_TRUE(opener.probe((dir / "one+fake:A").string()));
    std::filesystem::create_directory(dir / "one+fake:A");
    EXPECT_FALSE(opener.probe((dir / "one+fake:A").string()));

    auto made = open_source("fake:A+fake:B+C");
    ASSERT_TRUE(made) << made.error().to_string();
    EXPECT_EQ((*made)->info().uri, "fake:A+fake:B+C");
    const auto half = open_source("/no/such/recording+fake:A");
    ASSERT_FALSE(half);
    EXPECT_NE(half.error().to_string().find("/no/such/recording"), std::string::npos);
    made = fail("closed");
    EXPECT_EQ(bus.open_devices(), 0);
}

}  // namespace
}  // namespace kino
