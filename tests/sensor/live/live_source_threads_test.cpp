#include <gtest/gtest.h>

#include <atomic>
#include <memory>
#include <thread>
#include <vector>

#include "live_source_fixture.h"

namespace kino {
namespace {

using namespace test;

using LiveSourceThreadsTest = LiveSourceFixture;

/// Puts depth and colour for as long as it lives, counting from 0 at each return as devices do.
class Writer {
  public:
    explicit Writer(FakeBus& bus) : thread_([this, &bus] { run(bus); }) {}
    ~Writer() { stop(); }
    void stop() {
        stop_ = true;
        if (thread_.joinable()) thread_.join();
    }
    std::int64_t depth_put() const { return depth_; }
    std::int64_t color_put() const { return color_; }

  private:
    void run(FakeBus& bus) {
        std::int64_t sequence = 0;
        TimeNs zero = now_ns();
        while (!stop_) {
            const TimeNs now = now_ns();
            const bool depth =
                bus.put("A", StreamKind::depth, fake_frame(StreamKind::depth, sequence, now, zero));
            const bool color =
                bus.put("A", StreamKind::color, fake_frame(StreamKind::color, sequence, now, zero));
            depth_ += depth;
            color_ += color;
            ++sequence;
            if (!depth && !color) {
                sequence = 0;
                zero = now;
            }
            std::this_thread::sleep_for(std::chrono::microseconds(50));
        }
    }
    std::atomic<bool> stop_{false};
    std::atomic<std::int64_t> depth_{0};
    std::atomic<std::int64_t> color_{0};
    std::thread thread_;
};

void expect_rising(const std::vector<FrameHeader>& headers) {
    for (std::size_t i = 1; i < headers.size(); ++i) {
        ASSERT_GT(headers[i].sequence, headers[i - 1].sequence);
        ASSERT_GT(headers[i].host_time, headers[i - 1].host_time);
        ASSERT_GT(headers[i].device_time, headers[i - 1].device_time);
    }
}

/// lost, back, lost, back ... after the one start.
void expect_alternating(const std::vector<Event>& events) {
    ASSERT_FALSE(events.empty());
    EXPECT_EQ(events[0].kind, EventKind::started);
    for (std::size_t i = 1; i < events.size(); ++i) {
        ASSERT_EQ(events[i].kind, i % 2 == 1 ? EventKind::lost : EventKind::back) << i;
        ASSERT_GE(events[i].time, events[i - 1].time);
    }
}

void expect_silence_while_lost(const std::vector<Event>& events,
                               const std::vector<Tapped::Seen>& seen) {
    std::size_t event = 0;
    for (const Tapped::Seen& frame : seen) {
        while (event + 1 < events.size() && events[event + 1].time <= frame.at) ++event;
        // At one and the same nanosecond the order is not known.
        if (events[event].time == frame.at) continue;
        ASSERT_NE(events[event].kind, EventKind::lost) << "frame at " << frame.at;
    }
}

TEST_F(LiveSourceThreadsTest, AThousandTimesUnpluggedAndPluggedInAgain) {
    bus.plug("A");
    auto source = open();
    auto tapped = std::make_unique<Tapped>(*source);
    ASSERT_TRUE(source->subscribe(kDepth));
    ASSERT_TRUE(source->subscribe(kColor));

    std::atomic<bool> reading = true;
    std::int64_t sets = 0;
    std::thread reader([&] {
        TimeNs last = 0;
        while (true) {
            const bool final_round = !reading;
            const auto set = source->next(kNsPerMs);
            if (!set || !*set) {
                if (final_round) return;
                continue;
            }
            EXPECT_EQ((*set)->index, sets);
            EXPECT_GT((*set)->time, last);
            last = (*set)->time;
            ++sets;
        }
    });
    Writer writer(bus);
    for (int cycle = 0; cycle < 1000; ++cycle) {
        const auto put_before = writer.depth_put();
        ASSERT_TRUE(eventually([&] { return writer.depth_put() > put_before; })) << cycle;
        bus.unplug("A");
        ASSERT_TRUE(away(*source)) << cycle;
        bus.plug("A");
        ASSERT_TRUE(present(*source)) << cycle;
    }
    // The last return shows itself by a frame.
    const auto before = writer.depth_put();
    ASSERT_TRUE(eventually([&] { return writer.depth_put() > before; }));
    writer.stop();
    reading = false;
    reader.join();

    const auto depth = tapped->of(StreamKind::depth);
    const auto color = tapped->of(StreamKind::color);
    EXPECT_EQ(static_cast<std::int64_t>(depth.size()), writer.depth_put());
    EXPECT_EQ(static_cast<std::int64_t>(color.size()), writer.color_put());
    EXPECT_EQ(source->stats().frames, writer.depth_put() + writer.color_put());
    EXPECT_EQ(sets + source->stats().overtaken, writer.depth_put());
    EXPECT_EQ(source->stats().losses, 1000);
    expect_rising(depth);
    expect_rising(color);

    const auto events = source->take_events();
    EXPECT_EQ(events.size(), 2001u);
    expect_alternating(events);
    const auto seen = tapped->all();
    expect_silence_while_lost(events, seen);

    EXPECT_EQ(bus.open_devices(), 1);
    tapped.reset();
    source.reset();
    EXPECT_EQ(bus.open_devices(), 0);
    EXPECT_EQ(bus.watches(), 0);
    for (const auto& frame : seen) ASSERT_TRUE(frame.frame.expired());
}

TEST_F(LiveSourceThreadsTest, UnplugsFasterThanItCanFollow) {
    bus.plug("A");
    const auto source = open();
    Tapped tapped(*source);
    ASSERT_TRUE(source->subscribe(kDepth));
    ASSERT_TRUE(source->subscribe(kColor));
    Writer writer(bus);
    for (int cycle = 0; cycle < 500; ++cycle) {
        bus.unplug("A");
        if (cycle % 3 == 0) std::this_thread::yield();
        bus.plug("A");
        if (cycle % 7 == 0) std::this_thread::sleep_for(std::chrono::microseconds(300));
    }
    const auto before = writer.depth_put();
    ASSERT_TRUE(eventually([&] { return writer.depth_put() > before && source->stats().present; }));
    writer.stop();
    EXPECT_EQ(source->stats().frames, writer.depth_put() + writer.color_put());
    expect_rising(tapped.of(StreamKind::depth));
    const auto events = source->take_events();
    expect_alternating(events);
    expect_silence_while_lost(events, tapped.all());
}

TEST_F(LiveSourceThreadsTest, ControlsFromAnotherThreadWhileItComesAndGoes) {
    bus.plug("A");
    const auto source = open();
    ASSERT_TRUE(source->subscribe(kDepth));
    std::atomic<bool> stop = false;
    std::atomic<int> done = 0;
    std::atomic<double> last_set = 0;
    std::thread controls([&] {
        for (int i = 1; !stop; ++i) {
            const double value = i % 27;
            if (source->controls()->set("tilt", value)) last_set = value;
            (void)source->controls()->get("tilt");
            (void)source->controls()->list();
            (void)source->calibration();
            (void)source->stats();
            ++done;
        }
    });
    for (int cycle = 0; cycle < 300; ++cycle) {
        bus.unplug("A");
        if (cycle % 2 == 0) {
            ASSERT_TRUE(away(*source));
        }
        bus.plug("A");
        if (cycle % 5 == 0) {
            ASSERT_TRUE(present(*source));
        }
    }
    ASSERT_TRUE(present(*source));
    const int before = done;
    ASSERT_TRUE(eventually([&] { return done > before + 10; }));
    stop = true;
    controls.join();
    EXPECT_EQ(bus.setting("A", "tilt"), last_set);
}

TEST_F(LiveSourceThreadsTest, UnpluggedDuringAControlCall) {
    bus.plug("A");
    const auto source = open();
    ASSERT_TRUE(source->subscribe(kDepth));
    bus.on_set([this] {
        bus.on_set({});
        bus.unplug("A");
    });
    EXPECT_FALSE(source->controls()->set("tilt", 5));
    ASSERT_TRUE(away(*source));
    bus.plug("A");
    ASSERT_TRUE(present(*source));
    EXPECT_EQ(bus.setting("A", "tilt"), 0);
}

TEST_F(LiveSourceThreadsTest, DestroyedWhileItIsUnpluggedOrAwayOrComingBack) {
    for (int round = 0; round < 200; ++round) {
        bus.plug("A");
        auto source = open();
        ASSERT_TRUE(source->subscribe(kDepth));
        std::thread plugger([&] {
            bus.unplug("A");
            if (round % 2 == 0) bus.plug("A");
            if (round % 4 == 0) bus.unplug("A");
        });
        if (round % 3 == 0) std::this_thread::sleep_for(std::chrono::microseconds(round));
        source.reset();
        plugger.join();
        ASSERT_EQ(bus.open_devices(), 0);
        ASSERT_EQ(bus.watches(), 0);
    }
}

TEST_F(LiveSourceThreadsTest, AReplacedTapIsNotUnderWayAnyMore) {
    bus.plug("A");
    const auto source = open();
    ASSERT_TRUE(source->subscribe(kDepth));
    const Writer writer(bus);
    std::atomic<int> calls = 0;
    std::vector<std::unique_ptr<std::atomic<bool>>> states;
    for (int round = 0; round < 300; ++round) {
        states.push_back(std::make_unique<std::atomic<bool>>(true));
        std::atomic<bool>& alive = *states.back();
        ASSERT_TRUE(source->set_tap([&calls, state = &alive](StreamId, const StreamFrame&) {
            EXPECT_TRUE(*state);
            std::this_thread::sleep_for(std::chrono::microseconds(100));
            EXPECT_TRUE(*state);
            ++calls;
        }));
        const int before = calls;
        if (round % 10 == 0) {
            ASSERT_TRUE(eventually([&] { return calls > before; }));
        }
        ASSERT_TRUE(source->set_tap({}));
        alive = false;
    }
    EXPECT_GE(calls, 30);
}

TEST_F(LiveSourceThreadsTest, SubscriptionsChangeWhileFramesFlow) {
    bus.plug("A");
    const auto source = open();
    const Writer writer(bus);
    for (int round = 0; round < 200; ++round) {
        ASSERT_TRUE(source->subscribe(kColor));
        ASSERT_TRUE(source->subscribe(kDepth));
        const auto set = source->next(round % 10 == 0 ? 5 * kNsPerMs : 0);
        ASSERT_TRUE(set);
        source->unsubscribe(kDepth);
        Tapped tapped(*source);
        EXPECT_TRUE(tapped.of(StreamKind::depth).empty());
        source->unsubscribe(kColor);
    }
    EXPECT_EQ(bus.openings(), 1);
}

}  // namespace
}  // namespace kino
