#include "sensor/live/live_source.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "fake_device.h"

namespace kino {
namespace {

using test::fake_frame;
using test::FakeBus;
using test::header_of;

constexpr StreamId kDepth{0, StreamKind::depth};
constexpr StreamId kColor{0, StreamKind::color};
constexpr TimeNs kPeriod = kNsPerSecond / 30;

LiveOptions options_for(FakeBus& bus) {
    LiveOptions options;
    options.watch = [&bus] { return bus.watch(); };
    options.first_look = kNsPerMs;
    options.slowest_look = 20 * kNsPerMs;
    options.sets.waiting_sets = 1000;
    options.sets.history = 1000;
    return options;
}

/// Everything the tap saw.
class Tapped {
  public:
    explicit Tapped(Source& source) : source_(source) {
        EXPECT_TRUE(source.set_tap([this](StreamId id, const StreamFrame& frame) {
            const std::lock_guard lock(mutex_);
            frames_.emplace_back(id, header_of(frame));
        }));
    }
    ~Tapped() { EXPECT_TRUE(source_.set_tap({})); }
    std::vector<FrameHeader> of(StreamKind kind) const {
        const std::lock_guard lock(mutex_);
        std::vector<FrameHeader> headers;
        for (const auto& [id, header] : frames_) {
            if (id.kind == kind) headers.push_back(header);
        }
        return headers;
    }

  private:
    Source& source_;
    mutable std::mutex mutex_;
    std::vector<std::pair<StreamId, FrameHeader>> frames_;
};

/// Waits for something that another thread is about to do.
template <class Condition>
bool eventually(Condition condition) {
    const TimeNs until = now_ns() + 60 * kNsPerSecond;
    while (!condition()) {
        if (now_ns() > until) return false;
        std::this_thread::sleep_for(std::chrono::microseconds(200));
    }
    return true;
}

std::vector<EventKind> kinds(const std::vector<Event>& events) {
    std::vector<EventKind> result;
    for (const Event& event : events) result.push_back(event.kind);
    return result;
}

struct LiveSourceTest : testing::Test {
    std::unique_ptr<LiveSource> open(const std::string& address = "A") {
        auto source = make_live_source(bus.driver(), address, options_for(bus));
        EXPECT_TRUE(source) << source.error().to_string();
        return source ? std::move(*source) : nullptr;
    }
    FakeBus bus;
};

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
    EXPECT_FALSE(make_live_source(bus.driver(), "A", options_for(bus)));
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

}  // namespace
}  // namespace kino
