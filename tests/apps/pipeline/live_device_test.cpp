#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <thread>

#include "apps/pipeline/controls_desk.h"
#include "apps/pipeline/live_runner.h"
#include "fake_device.h"
#include "sensor/live/live_source.h"
#include "sensor/session/session_source.h"
#include "tests/support/temp_dir.h"

/// A device that comes and goes, through everything between it and the picture: source, runner,
/// recorder, knobs.
namespace kino {
namespace {

using test::fake_frame;
using test::FakeBus;
using testing::HasSubstr;

constexpr TimeNs kDevicePatience = 20 * kNsPerSecond;

bool eventually(const std::function<bool()>& holds) {
    const TimeNs until = now_ns() + kDevicePatience;
    while (!holds()) {
        if (now_ns() > until) return false;
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return true;
}

class PlayedDevice : public testing::Test {
  protected:
    void SetUp() override {
        bus.plug("A");
        LiveOptions options;
        options.watch = [this] { return bus.watch(); };
        auto source = make_live_source(bus.driver(), "A", options);
        ASSERT_TRUE(source) << source.error().to_string();
        auto opened = prepare_for_playing(std::move(*source));
        ASSERT_TRUE(opened) << opened.error().to_string();
        runner = std::make_unique<LiveRunner>(std::move(*opened));
    }
    void TearDown() override { runner.reset(); }

    void put(std::int64_t sequence) {
        const TimeNs time = now_ns();
        ASSERT_TRUE(bus.put("A", StreamKind::depth, fake_frame(StreamKind::depth, sequence, time)));
        ASSERT_TRUE(bus.put("A", StreamKind::color, fake_frame(StreamKind::color, sequence, time)));
    }

    /// Plays a session through and counts its depth and colour frames and its events.
    struct Counted {
        std::int64_t depth = 0, color = 0;
        std::vector<EventKind> events;
    };
    static Counted count(const std::filesystem::path& file) {
        Counted counted;
        auto source = session_opener().open(file.string());
        EXPECT_TRUE(source) << source.error().to_string();
        if (!source) return counted;
        EXPECT_TRUE(subscribe_all(**source));
        while (true) {
            auto set = (*source)->next(0);
            EXPECT_TRUE(set) << set.error().to_string();
            for (const Event& event : (*source)->take_events()) {
                counted.events.push_back(event.kind);
            }
            if (!set || !*set) break;
            counted.depth += (*set)->depth != nullptr;
            counted.color += (*set)->color != nullptr;
        }
        return counted;
    }

    FakeBus bus;
    test::TempDir temp;
    std::unique_ptr<LiveRunner> runner;
};

TEST_F(PlayedDevice, FramesCarryTheirLatency) {
    put(1);
    const auto frame = runner->wait(kDevicePatience);
    ASSERT_TRUE(frame);
    EXPECT_GE(frame->arrived, frame->set.time);
    EXPECT_GE(frame->ready, frame->arrived);
    EXPECT_LE(frame->ready, now_ns());
}

TEST_F(PlayedDevice, EveryFrameIsRecordedAlsoThoseOvertaken) {
    const auto file = temp / "all.mkv";
    ASSERT_TRUE(runner->start_recording(file, SessionCodec::raw));
    // The tap is laid by the runner's thread.
    ASSERT_TRUE(eventually([&] {
        put(1);
        return runner->status().recording->frames > 0;
    }));
    runner->stop_recording();
    ASSERT_TRUE(eventually([&] { return !runner->status().is_recording; }));
    const RecorderStatus before = *runner->status().recording;
    EXPECT_EQ(count(file).depth + count(file).color, before.frames);

    const auto burst = temp / "burst.mkv";
    ASSERT_TRUE(runner->start_recording(burst, SessionCodec::raw));
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    constexpr int kFrames = 200;
    for (int i = 0; i < kFrames; ++i) put(1000 + i);
    runner->stop_recording();
    ASSERT_TRUE(eventually([&] { return !runner->status().is_recording; }));
    EXPECT_EQ(runner->status().recording->dropped, 0);
    EXPECT_EQ(count(burst).depth, kFrames);
}

TEST_F(PlayedDevice, ARecordingGoesOnAfterUnplugging) {
    const auto file = temp / "unplugged.mkv";
    ASSERT_TRUE(runner->start_recording(file, SessionCodec::raw));
    ASSERT_TRUE(eventually([&] {
        put(1);
        return runner->status().recording->frames > 0;
    }));
    bus.unplug("A");
    ASSERT_TRUE(eventually([&] { return !runner->status().present; }));
    EXPECT_TRUE(runner->status().is_recording);
    const std::int64_t lost_at = runner->status().recording->frames;
    bus.plug("A");
    ASSERT_TRUE(eventually([&] { return runner->status().present; }));
    ASSERT_TRUE(eventually([&] {
        put(5);
        return runner->status().recording->frames > lost_at + 4;
    }));
    runner->stop();
    const Counted counted = count(file);
    EXPECT_EQ(counted.depth + counted.color, runner->status().recording->frames);
    EXPECT_THAT(counted.events, testing::Contains(EventKind::lost));
    EXPECT_THAT(counted.events, testing::Contains(EventKind::back));
}

TEST_F(PlayedDevice, ASecondRecordingAndAFileThatExistsAreRefused) {
    const auto file = temp / "one.mkv";
    ASSERT_TRUE(runner->start_recording(file, SessionCodec::raw));
    EXPECT_FALSE(runner->start_recording(temp / "two.mkv", SessionCodec::raw));
    runner->stop_recording();
    ASSERT_TRUE(eventually([&] { return !runner->status().is_recording; }));
    EXPECT_FALSE(runner->start_recording(file, SessionCodec::raw));
    EXPECT_FALSE(runner->status().is_recording);
    EXPECT_FALSE(std::filesystem::exists(temp / "two.mkv"));
}

TEST_F(PlayedDevice, KnobsAreSetWithoutWaiting) {
    put(1);
    ASSERT_NE(runner->controls(), nullptr);
    // A device that is slow to obey.
    bus.on_set([] { std::this_thread::sleep_for(std::chrono::milliseconds(50)); });
    ControlsDesk desk(*runner->controls());
    ASSERT_TRUE(eventually([&] { return !desk.knobs().empty(); }));
    for (int i = 1; i <= 20; ++i) desk.set("tilt", i);
    for (const ControlsDesk::Knob& knob : desk.knobs()) {
        if (knob.control.id == "tilt") {
            EXPECT_EQ(knob.value, 20);
        }
    }
    ASSERT_TRUE(eventually([&] { return bus.setting("A", "tilt") == 20; }));
    // Values in between were overtaken, not queued.
    EXPECT_LT(bus.settings_made().size(), 20u);
}

TEST_F(PlayedDevice, AKnobOfADeviceThatHasGoneSaysSo) {
    put(1);
    ControlsDesk desk(*runner->controls());
    ASSERT_TRUE(eventually([&] { return !desk.knobs().empty(); }));
    bus.unplug("A");
    ASSERT_TRUE(eventually([&] { return !runner->status().present; }));
    desk.set("tilt", 3);
    EXPECT_TRUE(eventually([&] {
        for (const ControlsDesk::Knob& knob : desk.knobs()) {
            if (knob.control.id == "tilt" && !knob.error.empty()) return true;
        }
        return false;
    }));
}

}  // namespace
}  // namespace kino
