#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "fake_device.h"
#include "sensor/live/live_source.h"

namespace kino::test {

constexpr StreamId kDepth{0, StreamKind::depth};
constexpr StreamId kColor{0, StreamKind::color};
constexpr StreamId kInfrared{0, StreamKind::infrared};
constexpr TimeNs kPeriod = kNsPerSecond / 30;

/// Everything the tap saw.
class Tapped {
  public:
    struct Seen {
        StreamId id;
        FrameHeader header;
        TimeNs at = 0;  ///< now_ns() when the tap was called
        std::weak_ptr<const void> frame;
    };

    explicit Tapped(Source& source) : source_(source) {
        EXPECT_TRUE(source.set_tap([this](StreamId id, const StreamFrame& frame) {
            const TimeNs now = now_ns();
            auto any = std::visit([](auto f) { return std::shared_ptr<const void>(f); }, frame);
            const std::lock_guard lock(mutex_);
            seen_.push_back({id, header_of(frame), now, any});
        }));
    }
    ~Tapped() { stop(); }
    void stop() { EXPECT_TRUE(source_.set_tap({})); }

    std::vector<Seen> all() const {
        const std::lock_guard lock(mutex_);
        return seen_;
    }
    std::vector<FrameHeader> of(StreamKind kind) const {
        std::vector<FrameHeader> headers;
        for (const Seen& seen : all()) {
            if (seen.id.kind == kind) headers.push_back(seen.header);
        }
        return headers;
    }

  private:
    Source& source_;
    mutable std::mutex mutex_;
    std::vector<Seen> seen_;
};

/// Waits for something that another thread is about to do.
template <class Condition>
bool eventually(Condition condition) {
    const TimeNs until = now_ns() + 60 * kNsPerSecond;
    while (!condition()) {
        if (now_ns() > until) return false;
        std::this_thread::sleep_for(std::chrono::microseconds(100));
    }
    return true;
}

inline std::vector<EventKind> kinds(const std::vector<Event>& events) {
    std::vector<EventKind> result;
    for (const Event& event : events) result.push_back(event.kind);
    return result;
}

/// Sources over a FakeBus that look for a lost device without delay.
class LiveSourceFixture : public testing::Test {
  protected:
    LiveOptions options() {
        LiveOptions options;
        options.watch = [this] { return bus.watch(); };
        options.first_look = kNsPerMs;
        options.slowest_look = 20 * kNsPerMs;
        options.sets.waiting_sets = 100000;
        options.sets.history = 16;
        return options;
    }
    std::unique_ptr<LiveSource> open(const LiveOptions& opts) {
        auto source = make_live_source(bus.driver(), "A", opts);
        EXPECT_TRUE(source) << source.error().to_string();
        return source ? std::move(*source) : nullptr;
    }
    std::unique_ptr<LiveSource> open() { return open(options()); }

    static bool away(const LiveSource& source) {
        return eventually([&] { return !source.stats().present; });
    }
    static bool present(const LiveSource& source) {
        return eventually([&] { return source.stats().present; });
    }

    FakeBus bus;
};

}  // namespace kino::test
