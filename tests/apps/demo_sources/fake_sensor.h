#pragma once

#include <atomic>
#include <chrono>
#include <memory>
#include <thread>
#include <utility>
#include <vector>

#include "apps/pipeline/live_runner.h"
#include "base/check.h"
#include "sensor/source.h"

namespace kino::test {

/// What a test tells a fake sensor, from outside while a runner owns it.
struct SensorWord {
    std::atomic<int> people{0};
    std::atomic<bool> present{true};
};

/// A device of 8x6 pixels, a frame every two milliseconds, with as many people as it is told.
class FakeSensor final : public Source {
  public:
    explicit FakeSensor(std::shared_ptr<SensorWord> word) : word_(std::move(word)) {
        info_.uri = "fake:";
        info_.name = "fake sensor";
        info_.streams = {{.id = {0, StreamKind::depth}, .width = 8, .height = 6, .nominal_hz = 30},
                         {.id = {0, StreamKind::bodies}, .nominal_hz = 30}};
        rig_.depth = {.width = 8, .height = 6, .fx = 8, .fy = 8, .cx = 3.5, .cy = 2.5};
    }

    const SourceInfo& info() const override { return info_; }
    Result<RigParameters> calibration() const override { return rig_; }
    Result<void> subscribe(StreamId) override { return {}; }
    void unsubscribe(StreamId) override {}
    std::vector<Event> take_events() override { return std::exchange(events_, {}); }

    Result<std::optional<FrameSet>> next(TimeNs) override {
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
        const bool present = word_->present;
        if (std::exchange(present_, present) != present) {
            events_.push_back({present ? EventKind::back : EventKind::lost, 0, "fake sensor"});
        }
        if (!present) return std::nullopt;
        FrameSet set;
        set.index = index_++;
        set.time = set.index * (kNsPerSecond / 30);
        auto depth = std::make_shared<DepthFrame>();
        depth->header = {set.time, set.time, set.index, 0};
        depth->metres_per_unit = 0.001;
        depth->raw = Image<std::uint16_t>(8, 6, 2000);
        set.depth = std::move(depth);
        auto bodies = std::make_shared<BodyFrame>();
        bodies->time = set.time;
        for (int i = 0; i < word_->people; ++i) {
            Body body;
            body.id = static_cast<std::uint32_t>(i + 1);
            bodies->bodies.push_back(body);
        }
        set.bodies = std::move(bodies);
        return set;
    }

  private:
    std::shared_ptr<SensorWord> word_;
    SourceInfo info_;
    RigParameters rig_;
    std::vector<Event> events_;
    std::int64_t index_ = 0;
    bool present_ = true;
};

inline std::unique_ptr<LiveRunner> runner_of(std::unique_ptr<Source> source) {
    auto opened = prepare_for_playing(std::move(source));
    KINO_CHECK(opened.has_value());
    return std::make_unique<LiveRunner>(std::move(*opened));
}

}  // namespace kino::test
