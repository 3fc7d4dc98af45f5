#include <gtest/gtest.h>

#include <atomic>
#include <condition_variable>
#include <thread>

#include "collected.h"
#include "fake_kinect.h"
#include "sensor/kinect1/kinect1_driver.h"
#include "sensor/live/live_source.h"
#include "support/random.h"

namespace kino::kinect1 {
namespace {

using test::FakeKinect;

constexpr StreamId kDepthStream{0, StreamKind::depth};
constexpr StreamId kColorStream{0, StreamKind::color};
constexpr StreamId kMotionStream{0, StreamKind::motion};

/// Never says anything: the source looks by itself.
class SilentWatch : public HotplugWatch {
  public:
    std::vector<HotplugEvent> wait(TimeNs timeout) override {
        std::unique_lock lock(mutex_);
        changed_.wait_for(lock, std::chrono::nanoseconds(timeout), [this] { return interrupted_; });
        interrupted_ = false;
        return {};
    }
    void interrupt() override {
        const std::lock_guard lock(mutex_);
        interrupted_ = true;
        changed_.notify_all();
    }

  private:
    std::mutex mutex_;
    std::condition_variable changed_;
    bool interrupted_ = false;
};

/// Sends frames of both endpoints as fast as they are taken, from a thread of its own.
class Sender {
  public:
    explicit Sender(std::shared_ptr<FakeKinect> fake)
        : fake_(std::move(fake)),
          depth_(test::random_frame(CameraMode::depth_11bit, 1)),
          color_(test::random_frame(CameraMode::color_bayer, 2)),
          thread_([this] { run(); }) {}
    ~Sender() {
        stop_ = true;
        thread_.join();
    }

  private:
    void run() {
        while (!stop_) {
            const bool sent = fake_->send_frame(CameraMode::depth_11bit, depth_);
            if (!fake_->send_frame(CameraMode::color_bayer, color_) && !sent) {
                std::this_thread::sleep_for(std::chrono::microseconds(200));
            }
        }
    }
    std::shared_ptr<FakeKinect> fake_;
    test::Bytes depth_;
    test::Bytes color_;
    std::atomic<bool> stop_ = false;
    std::thread thread_;
};

struct Seen {
    int lost = 0;
    int back = 0;
};

void note_events(LiveSource& source, Seen& seen) {
    for (const Event& event : source.take_events()) {
        seen.lost += event.kind == EventKind::lost ? 1 : 0;
        seen.back += event.kind == EventKind::back ? 1 : 0;
    }
}

TEST(LiveCycles, UnpluggedAtAnyByteAndPluggedInAgain) {
    constexpr int kCycles = 200;
    const auto fake = FakeKinect::make();
    LiveOptions options;
    options.watch = [] { return std::make_unique<SilentWatch>(); };
    options.first_look = kNsPerMs;
    options.slowest_look = 2 * kNsPerMs;
    auto opened = make_live_source(kinect1_driver(fake), "", options);
    ASSERT_TRUE(opened) << opened.error().to_string();
    LiveSource& source = **opened;
    ASSERT_TRUE(source.subscribe(kDepthStream));
    ASSERT_TRUE(source.subscribe(kColorStream));
    ASSERT_TRUE(source.subscribe(kMotionStream));
    const Sender sender(fake);
    test::Random random(8);
    Seen seen;
    TimeNs last_time = -1;
    std::int64_t frames = 0;
    for (int cycle = 0; cycle < kCycles; ++cycle) {
        fake->unplug_after(random.integer(0, 900'000));
        // No wall clock here: whatever the machine does, each loss and each return comes.
        while (seen.lost <= cycle) {
            const auto set = source.next(kNsPerMs);
            if (set && *set && (*set)->depth) {
                EXPECT_GT((*set)->depth->header.device_time, last_time);
                last_time = (*set)->depth->header.device_time;
                ++frames;
            }
            note_events(source, seen);
        }
        fake->plug_in();
        while (seen.back <= cycle) {
            (void)source.next(kNsPerMs);
            note_events(source, seen);
        }
    }
    EXPECT_EQ(seen.lost, kCycles);
    EXPECT_EQ(seen.back, kCycles);
    EXPECT_GT(frames, 0);
    opened->reset();
    EXPECT_EQ(fake->open_handles(), 0);
}

TEST(LiveCycles, StopsAndStartsWhileFramesAndControlsFly) {
    const auto fake = FakeKinect::make();
    auto opened = kinect1_driver(fake).open("");
    ASSERT_TRUE(opened);
    LiveDevice& device = **opened;
    test::Collected collected;
    const Sender sender(fake);
    std::atomic<bool> stop = false;
    std::thread knobs([&] {
        while (!stop) {
            (void)device.controls()->set("tilt", 3);
            (void)device.controls()->get("white_balance_auto");
        }
    });
    for (int i = 0; i < 30; ++i) {
        ASSERT_TRUE(device.start(kDepthStream, collected));
        ASSERT_TRUE(device.start(kColorStream, collected));
        if (i % 10 == 0) {
            ASSERT_TRUE(device.start(kMotionStream, collected));
        }
        device.stop(kDepthStream);
        const std::size_t depths = collected.of<DepthFrame>(StreamKind::depth).size();
        device.stop(kColorStream);
        device.stop(kMotionStream);
        EXPECT_EQ(collected.of<DepthFrame>(StreamKind::depth).size(), depths);
    }
    stop = true;
    knobs.join();
    EXPECT_TRUE(collected.losses().empty());
}

TEST(LiveCycles, MotionComesAndRises) {
    const auto fake = FakeKinect::make();
    auto opened = kinect1_driver(fake).open("");
    ASSERT_TRUE(opened);
    test::Collected collected;
    fake->motor_angle_halves = 14;
    ASSERT_TRUE((*opened)->start(kMotionStream, collected));
    while (collected.count() < 3) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    (*opened)->stop(kMotionStream);
    const auto frames = collected.of<MotionFrame>(StreamKind::motion);
    TimeNs last = -1;
    for (const auto& frame : frames) {
        EXPECT_GT(frame->header.host_time, last);
        last = frame->header.host_time;
        EXPECT_EQ(frame->tilt_deg, 7.0);
        EXPECT_NEAR(frame->acceleration_m_s2[1], -9.80665, 1e-9);
    }
}

TEST(LiveCycles, AnsweringBadlyIsLostFramesAndGoneIsALoss) {
    const auto fake = FakeKinect::make();
    auto opened = kinect1_driver(fake).open("");
    ASSERT_TRUE(opened);
    test::Collected collected;
    fake->set_failures({.motor = usb::Failure::timeout});
    ASSERT_TRUE((*opened)->start(kMotionStream, collected));
    std::this_thread::sleep_for(std::chrono::milliseconds(150));
    fake->set_failures({});
    while (collected.count() < 1) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    EXPECT_GE(collected.of<MotionFrame>(StreamKind::motion)[0]->header.lost_before, 1);
    fake->unplug();
    while (collected.losses().empty()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    opened->reset();
    EXPECT_EQ(collected.losses().size(), 1u);
    EXPECT_EQ(collected.after_loss(), 0);
}

}  // namespace
}  // namespace kino::kinect1
