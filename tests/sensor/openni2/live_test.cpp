#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <condition_variable>
#include <mutex>

#include "driver/test_frames.h"
#include "openni_runtime.h"
#include "sensor/live/live_source.h"
#include "sensor/openni2/openni2.h"
#include "sensor/openni2/openni_c.h"
#include "sensor/openni2/openni_device.h"

namespace kino {
namespace {

namespace camera = test::camera;
using testing::HasSubstr;

class Intake final : public FrameIntake {
  public:
    void put(StreamId id, StreamFrame frame) override {
        const std::lock_guard lock(mutex_);
        EXPECT_EQ(lost_, 0) << "nothing comes after the loss";
        frames_.emplace_back(id.kind, std::move(frame));
        changed_.notify_all();
    }
    void lost(std::string) override {
        const std::lock_guard lock(mutex_);
        ++lost_;
        changed_.notify_all();
    }

    /// Waits until `count` frames of the stream are there; generous, for loaded machines.
    template <class Frame>
    std::vector<std::shared_ptr<const Frame>> wait_for(StreamKind kind, std::size_t count) {
        std::unique_lock lock(mutex_);
        const auto of_kind = [&] {
            std::vector<std::shared_ptr<const Frame>> frames;
            for (const auto& [k, frame] : frames_) {
                if (k == kind) frames.push_back(std::get<std::shared_ptr<const Frame>>(frame));
            }
            return frames;
        };
        EXPECT_TRUE(changed_.wait_for(lock, std::chrono::seconds(20),
                                      [&] { return of_kind().size() >= count; }))
            << "of " << stream_name(kind);
        return of_kind();
    }
    bool wait_for_loss() {
        std::unique_lock lock(mutex_);
        return changed_.wait_for(lock, std::chrono::seconds(20), [&] { return lost_ > 0; });
    }
    std::size_t size() {
        const std::lock_guard lock(mutex_);
        return frames_.size();
    }
    int losses() {
        const std::lock_guard lock(mutex_);
        return lost_;
    }

  private:
    std::mutex mutex_;
    std::condition_variable changed_;
    std::vector<std::pair<StreamKind, StreamFrame>> frames_;
    int lost_ = 0;
};

/// A device that is plugged in for one test.
class Plugged {
  public:
    explicit Plugged(const std::string& kind, const std::string& port = "1")
        : uri_("kino/" + kind + "/SN" + kind + "/" + port) {
        test::OpenniRuntime::get().driver.plug(uri_.c_str());
    }
    ~Plugged() { pull(); }
    void pull() { test::OpenniRuntime::get().driver.unplug(uri_.c_str()); }
    [[nodiscard]] const std::string& uri() const { return uri_; }
    [[nodiscard]] int value(int sensor, int property) const {
        return test::OpenniRuntime::get().driver.value(uri_.c_str(), sensor, property);
    }

  private:
    std::string uri_;
};

std::unique_ptr<LiveDevice> open(const std::string& address) {
    auto device = openni2_driver().open(address);
    if (!device) {
        ADD_FAILURE() << device.error().to_string();
        return nullptr;
    }
    return std::move(*device);
}

template <class Frame>
void expect_in_order(const std::vector<std::shared_ptr<const Frame>>& frames) {
    for (std::size_t i = 1; i < frames.size(); ++i) {
        const FrameHeader& last = frames[i - 1]->header;
        const FrameHeader& now = frames[i]->header;
        EXPECT_EQ(now.sequence - last.sequence, now.lost_before + 1);
        EXPECT_EQ(now.device_time - last.device_time,
                  (now.sequence - last.sequence) * camera::kPeriodUs * 1000);
        EXPECT_GT(now.host_time, last.host_time);
    }
}

TEST(Openni2Live, WithoutTheLibraryTheListIsEmptyAndOpeningNamesThePackage) {
    const test::OpenniRuntime& runtime = test::OpenniRuntime::get();
    EXPECT_TRUE(runtime.list_without_library.empty());
    EXPECT_THAT(runtime.error_without_library, HasSubstr("libopenni2-0"));
}

TEST(Openni2Live, FramesAreTheCamerasBitByBit) {
    for (const char* kind : {"mm", "um", "shift2", "shift3", "mirror", "plain"}) {
        const Plugged plugged(kind);
        Intake intake;
        const auto device = open(plugged.uri());
        ASSERT_TRUE(device);
        ASSERT_TRUE(device->start({0, StreamKind::depth}, intake));
        const auto frames = intake.wait_for<DepthFrame>(StreamKind::depth, 8);
        device->stop({0, StreamKind::depth});
        expect_in_order(frames);
        for (const auto& frame : frames) {
            const int index = static_cast<int>(frame->header.sequence);
            const bool shift = std::string(kind).starts_with("shift");
            EXPECT_EQ(frame->unit, shift ? DepthUnit::kinect_disparity11 : DepthUnit::linear);
            EXPECT_EQ(frame->metres_per_unit, std::string(kind) == "um" ? 0.0001 : 0.001);
            for (int y = 0; y < camera::kHeight; ++y) {
                for (int x = 0; x < camera::kWidth; ++x) {
                    int expected = camera::depth_at(x, y, index);
                    if (std::string(kind) == "shift3") expected /= 2;
                    if (shift && (expected == 0 || expected > 2047)) expected = 2047;
                    ASSERT_EQ(frame->raw.at(x, y), expected) << kind << " " << index;
                }
            }
        }
    }
}

TEST(Openni2Live, ColourOfEveryFormat) {
    const std::pair<const char*, PixelFormat> kinds[] = {
        {"mm", PixelFormat::rgb8},    {"yuv", PixelFormat::uyvy},   {"yuyv", PixelFormat::yuyv},
        {"gray", PixelFormat::gray8}, {"jpeg", PixelFormat::mjpeg}, {"mirror", PixelFormat::rgb8}};
    for (const auto& [kind, format] : kinds) {
        const Plugged plugged(kind);
        Intake intake;
        const auto device = open(plugged.uri());
        ASSERT_TRUE(device);
        ASSERT_TRUE(device->start({0, StreamKind::color}, intake));
        const auto frames = intake.wait_for<ColorFrame>(StreamKind::color, 4);
        device->stop({0, StreamKind::color});
        expect_in_order(frames);
        for (const auto& frame : frames) {
            ASSERT_EQ(frame->format, format);
            const int pitch = format == PixelFormat::mjpeg ? camera::kWidth : frame->pitch;
            ASSERT_EQ(frame->bytes.size(), static_cast<std::size_t>(pitch * camera::kHeight));
            for (int y = 0; y < camera::kHeight; ++y) {
                for (int b = 0; b < pitch; ++b) {
                    ASSERT_EQ(frame->bytes[static_cast<std::size_t>(y * pitch + b)],
                              camera::color_at(b, y, static_cast<int>(frame->header.sequence)))
                        << kind;
                }
            }
        }
    }
}

TEST(Openni2Live, InfraredOf16And8Bits) {
    for (const char* kind : {"mm", "yuv"}) {
        const Plugged plugged(kind);
        Intake intake;
        const auto device = open(plugged.uri());
        ASSERT_TRUE(device);
        ASSERT_TRUE(device->start({0, StreamKind::infrared}, intake));
        const auto frames = intake.wait_for<InfraredFrame>(StreamKind::infrared, 4);
        const int dropped = std::string(kind) == "mm" ? 0 : 2;
        for (const auto& frame : frames) {
            EXPECT_EQ(frame->significant_bits, 10 - dropped);
            for (int x = 0; x < camera::kWidth; ++x) {
                ASSERT_EQ(
                    frame->raw.at(x, 7),
                    camera::infrared_at(x, 7, static_cast<int>(frame->header.sequence)) >> dropped);
            }
        }
    }
}

TEST(Openni2Live, GapsInTheNumbersAreLostFrames) {
    const Plugged plugged("gaps");
    Intake intake;
    const auto device = open(plugged.uri());
    ASSERT_TRUE(device);
    ASSERT_TRUE(device->start({0, StreamKind::depth}, intake));
    const auto frames = intake.wait_for<DepthFrame>(StreamKind::depth, 20);
    expect_in_order(frames);
    std::int64_t lost = 0;
    for (const auto& frame : frames) {
        EXPECT_NE(frame->header.sequence % 7, 3);
        lost += frame->header.lost_before;
    }
    const std::int64_t span = frames.back()->header.sequence - frames.front()->header.sequence;
    EXPECT_EQ(span, static_cast<std::int64_t>(frames.size()) - 1 + lost);
    EXPECT_GE(lost, span / 7 - 1);
}

TEST(Openni2Live, DepthAndColourRunSynchronised) {
    const test::OpenniRuntime& runtime = test::OpenniRuntime::get();
    const Plugged plugged("mm");
    const int before = runtime.driver.syncs();
    Intake intake;
    const auto device = open(plugged.uri());
    ASSERT_TRUE(device);
    ASSERT_TRUE(device->start({0, StreamKind::depth}, intake));
    (void)intake.wait_for<DepthFrame>(StreamKind::depth, 2);
    EXPECT_EQ(runtime.driver.syncs(), before);
    ASSERT_TRUE(device->start({0, StreamKind::color}, intake));
    const auto color = intake.wait_for<ColorFrame>(StreamKind::color, 6);
    EXPECT_GT(runtime.driver.syncs(), before);
    expect_in_order(color);
    const auto depth = intake.wait_for<DepthFrame>(StreamKind::depth, 8);
    // One clock: the same number has the same time in both streams.
    for (const auto& c : color) {
        for (const auto& d : depth) {
            if (d->header.sequence == c->header.sequence) {
                EXPECT_EQ(d->header.device_time, c->header.device_time);
            }
        }
    }
    device->stop({0, StreamKind::color});
    const std::size_t colors = intake.wait_for<ColorFrame>(StreamKind::color, 0).size();
    const std::size_t depths = intake.wait_for<DepthFrame>(StreamKind::depth, 0).size();
    (void)intake.wait_for<DepthFrame>(StreamKind::depth, depths + 5);
    EXPECT_EQ(intake.wait_for<ColorFrame>(StreamKind::color, 0).size(), colors)
        << "nothing comes of a stopped stream";

    const auto free = open(plugged.uri() + "?sync=off");
    ASSERT_TRUE(free);
    EXPECT_EQ(free->address(), "serial=SNmm?sync=off");
}

TEST(Openni2Live, MirroringIsSwitchedOffAndRegistrationSetAsAsked) {
    const Plugged plugged("mm");
    {
        const auto device = open(plugged.uri());
        ASSERT_TRUE(device);
        EXPECT_EQ(plugged.value(openni::kSensorDepth, openni::kStreamMirroring), 0);
        EXPECT_EQ(plugged.value(openni::kSensorColor, openni::kStreamMirroring), 0);
        EXPECT_EQ(plugged.value(0, openni::kDeviceImageRegistration), 0);
        const RigParameters rig = *device->calibration();
        EXPECT_NE(rig.color_from_depth.translation.x, 0);
        EXPECT_NEAR(2 * std::atan(camera::kWidth / (2 * rig.depth.fx)), 1.02, 1e-6);
        EXPECT_NEAR(2 * std::atan(camera::kHeight / (2 * rig.depth.fy)), 0.73, 1e-6);
        EXPECT_TRUE(validate(rig));
    }
    const auto device = open(plugged.uri() + "?registration=on");
    ASSERT_TRUE(device);
    EXPECT_EQ(plugged.value(0, openni::kDeviceImageRegistration), 1);
    EXPECT_EQ(device->calibration()->color_from_depth.translation.x, 0);
    EXPECT_THAT(device->info().note, HasSubstr("registered"));
    EXPECT_EQ(device->address(), "serial=SNmm?registration=on");

    const Plugged plain("plain");
    const auto refused = openni2_driver().open(plain.uri() + "?registration=on");
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().to_string(), HasSubstr("does not register"));
}

TEST(Openni2Live, ControlsReachTheCamera) {
    const Plugged plugged("mm");
    const auto device = open(plugged.uri());
    ASSERT_TRUE(device);
    Controls* controls = device->controls();
    ASSERT_TRUE(controls);
    std::vector<std::string> ids;
    for (const Control& control : controls->list()) ids.push_back(control.id);
    EXPECT_THAT(ids,
                testing::ElementsAre("exposure_auto", "white_balance_auto", "exposure", "gain"));
    ASSERT_TRUE(controls->set("white_balance_auto", 0));
    EXPECT_EQ(plugged.value(openni::kSensorColor, openni::kStreamAutoWhiteBalance), 0);
    EXPECT_EQ(*controls->get("white_balance_auto"), 0);
    ASSERT_TRUE(controls->set("exposure", 321));
    EXPECT_EQ(plugged.value(openni::kSensorColor, openni::kStreamExposure), 321);
    EXPECT_FALSE(controls->set("exposure", 5000)) << "the driver's own limit";
    EXPECT_FALSE(controls->set("gain", -1));
    EXPECT_FALSE(controls->set("gain", std::nan("")));
    EXPECT_FALSE(controls->set("tilt", 0));
    EXPECT_EQ(*controls->get("exposure"), 321);

    const Plugged plain("plain");
    const auto without = open(plain.uri());
    ASSERT_TRUE(without);
    EXPECT_EQ(without->controls(), nullptr);
}

TEST(Openni2Live, UnpluggedIsSaidOnceAndTheUnitIsFoundElsewhere) {
    const test::OpenniRuntime& runtime = test::OpenniRuntime::get();
    const int open_before = runtime.driver.open_devices();
    Plugged first("mm", "1");
    Intake intake;
    auto device = open(first.uri());
    ASSERT_TRUE(device);
    const std::string address = device->address();
    ASSERT_TRUE(device->start({0, StreamKind::depth}, intake));
    ASSERT_TRUE(device->start({0, StreamKind::infrared}, intake));
    (void)intake.wait_for<DepthFrame>(StreamKind::depth, 3);
    first.pull();
    ASSERT_TRUE(intake.wait_for_loss());
    EXPECT_EQ(intake.losses(), 1);
    EXPECT_FALSE(device->start({0, StreamKind::color}, intake));
    EXPECT_FALSE(openni2_driver().open(address)) << "not there now";
    device.reset();
    EXPECT_EQ(runtime.driver.open_devices(), open_before);

    const Plugged second("mm", "2");
    device = open(address);
    ASSERT_TRUE(device);
    EXPECT_EQ(device->info().serial, "SNmm");
    Intake again;
    ASSERT_TRUE(device->start({0, StreamKind::depth}, again));
    EXPECT_FALSE(again.wait_for<DepthFrame>(StreamKind::depth, 3).empty());
    device.reset();
}

TEST(Openni2Live, ThroughTheLiveSourceLostAndBack) {
    auto first = std::make_unique<Plugged>("mm", "1");
    LiveOptions options;
    options.first_look = 20 * kNsPerMs;
    options.slowest_look = 50 * kNsPerMs;
    auto source = make_live_source(openni2_driver(), first->uri(), options);
    ASSERT_TRUE(source) << source.error().to_string();
    ASSERT_TRUE((*source)->subscribe({0, StreamKind::depth}));
    const auto next_set = [&] {
        for (int i = 0; i < 100; ++i) {
            auto set = (*source)->next(kNsPerSecond / 5);
            if (set && *set) return std::move(**set);
        }
        ADD_FAILURE() << "no frame";
        return FrameSet{};
    };
    const FrameSet before = next_set();
    first.reset();
    const Plugged second("mm", "2");
    std::vector<EventKind> kinds;
    for (int i = 0; i < 400 && std::count(kinds.begin(), kinds.end(), EventKind::back) == 0; ++i) {
        (void)(*source)->next(kNsPerSecond / 20);
        for (const Event& event : (*source)->take_events()) kinds.push_back(event.kind);
    }
    EXPECT_THAT(kinds, testing::IsSupersetOf({EventKind::lost, EventKind::back}));
    const FrameSet after = next_set();
    ASSERT_TRUE(before.depth && after.depth);
    EXPECT_GT(after.depth->header.sequence, before.depth->header.sequence);
    EXPECT_GT(after.depth->header.device_time, before.depth->header.device_time);
}

TEST(Openni2Live, DevicesAreListed) {
    const Plugged plugged("mm");
    const auto entries = openni2_driver().list();
    ASSERT_EQ(entries.size(), 1u);
    EXPECT_EQ(entries[0].uri, "openni2:" + plugged.uri());
    EXPECT_THAT(entries[0].name, HasSubstr("test camera"));
    const auto first = open("");
    ASSERT_TRUE(first);
    EXPECT_EQ(first->info().serial, "SNmm");
}

TEST(Openni2Live, StartedAndStoppedManyTimes) {
    const Plugged plugged("mm");
    for (int round = 0; round < 6; ++round) {
        Intake intake;
        const auto device = open(plugged.uri());
        ASSERT_TRUE(device);
        ASSERT_TRUE(device->start({0, StreamKind::color}, intake));
        if (round % 2 == 0) {
            ASSERT_TRUE(device->start({0, StreamKind::depth}, intake));
        }
        if (round % 3 == 0) (void)intake.wait_for<ColorFrame>(StreamKind::color, 1);
        if (round % 2 == 1) device->stop({0, StreamKind::color});
        device->stop({0, StreamKind::infrared});
    }
}

TEST(Openni2Address, OptionsAreTakenApartAndPutTogether) {
    for (const char* text : {"", "1d27/0601@1/4", "serial=7?registration=on", "?sync=off",
                             "a?registration=on&sync=off"}) {
        const auto address = parse_openni_address(text);
        ASSERT_TRUE(address) << text;
        EXPECT_EQ(to_string(*address), text);
    }
    EXPECT_FALSE(parse_openni_address("a?registration=maybe"));
    EXPECT_FALSE(parse_openni_address("a?tilt=3"));
}

}  // namespace
}  // namespace kino
