// The kernel's own driver for the Kinect against the fake.

#include <fmt/format.h>
#include <linux/videodev2.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "tests/sensor/device/fake_kinect/bits.h"
#include "tests/sensor/device/fake_kinect/fake_kinect.h"
#include "tests/sensor/device/scenarios/capture.h"
#include "tests/sensor/device/scenarios/modules.h"
#include "tests/sensor/device/scenarios/report.h"
#include "tests/sensor/device/scenarios/truth.h"

namespace kino::guest {
namespace {

constexpr const char* kModule = "gspca_kinect";
constexpr std::uint64_t kSeed = 23;

/// The fake with the kernel's driver bound to it.
struct Bound {
    std::unique_ptr<fake::Kinect> kinect;
    std::string node;
};

std::unique_ptr<Bound> bind(const Report& report, bool depth_mode, fake::KinectOptions options) {
    auto bound = std::make_unique<Bound>();
    if (const auto in = insert_module(kModule, depth_mode ? "depth_mode=1" : ""); !in) {
        report.failure(in.error().to_string());
        return nullptr;
    }
    auto kinect = fake::Kinect::plug(fake::noise_feed(kSeed), std::move(options));
    if (!kinect) {
        report.failure(kinect.error().to_string());
        return nullptr;
    }
    bound->kinect = std::move(*kinect);
    bound->node = wait_for_video_node("gspca");
    if (bound->node.empty()) {
        report.failure("the kernel's driver made no node");
        return nullptr;
    }
    return bound;
}

/// Which of the first frames of the feed these bytes are, or -1.
int number_of(const std::vector<std::uint8_t>& bytes,
              const std::vector<std::vector<std::uint8_t>>& truth) {
    for (std::size_t n = 0; n < truth.size(); ++n) {
        if (bytes == truth[n]) return static_cast<int>(n);
    }
    return -1;
}

void capture(const Report& report, bool depth_mode, std::uint32_t fourcc, int height, int wanted,
             double lost,
             const std::function<std::vector<std::uint8_t>(const fake::Feed&, int)>& truth) {
    fake::KinectOptions options;
    options.camera.faults = {.seed = 5, .lost = lost};
    const auto bound = bind(report, depth_mode, options);
    if (!bound) return;
    std::vector<CapturedFrame> frames;
    {
        auto capture = Capture::start(bound->node, fourcc, 640, height);
        if (!capture) return report.failure(capture.error().to_string());
        report.value("frame_bytes", (*capture)->frame_bytes());
        while (static_cast<int>(frames.size()) < wanted) {
            auto frame = (*capture)->next();
            if (!frame) {
                report.failure(frame.error().to_string());
                break;
            }
            frames.push_back(std::move(*frame));
        }
    }
    const int sent =
        static_cast<int>(bound->kinect->camera().sent(depth_mode ? 0x82 : 0x81).size());
    std::vector<std::vector<std::uint8_t>> expected;
    for (int n = 0; n < sent; ++n) expected.push_back(truth(bound->kinect->feed(), n));
    int equal = 0;
    int full_size = 0;
    int marked_bad = 0;
    int rising = 0;
    int last = -1;
    for (const CapturedFrame& frame : frames) {
        const int number = number_of(frame.bytes, expected);
        equal += number >= 0 ? 1 : 0;
        rising += number > last ? 1 : 0;
        if (number >= 0) last = number;
        full_size += frame.full_size ? 1 : 0;
        marked_bad += frame.marked_bad ? 1 : 0;
    }
    report.value("frames", static_cast<double>(frames.size()));
    report.value("equal", equal);
    report.value("in_order", rising);
    report.value("full_size", full_size);
    report.value("marked_bad", marked_bad);
    report.value("bad_commands", bound->kinect->camera().bad_commands());
}

std::vector<std::uint8_t> depth10(const fake::Feed& feed, int n) {
    auto depth = feed.depth(n);
    for (auto& value : depth) value = static_cast<std::uint16_t>(value >> 1);
    return fake::pack_bits(depth, 10);
}

void unplug(const Report& report) {
    fake::KinectOptions options;
    options.cut_after = 1'500'001;
    const auto bound = bind(report, true, options);
    if (!bound) return;
    auto capture = Capture::start(bound->node, V4L2_PIX_FMT_Y10BPACK, 640, 480);
    if (!capture) return report.failure(capture.error().to_string());
    int frames = 0;
    for (; frames < 100; ++frames) {
        const auto frame = (*capture)->next();
        if (frame) continue;
        report.value("no_such_device", frame.error().what == "No such device" ? 1 : 0);
        break;
    }
    report.value("frames", frames);
}

}  // namespace

std::vector<Scenario> gspca_scenarios() {
    return {
        {"gspca_depth",
         [](const Report& r) { capture(r, true, V4L2_PIX_FMT_Y10BPACK, 480, 6, 0, depth10); }},
        {"gspca_color",
         [](const Report& r) {
             capture(r, false, V4L2_PIX_FMT_SGRBG8, 480, 6, 0,
                     [](const fake::Feed& feed, int n) { return feed.bayer(n, 640, 480); });
         }},
        {"gspca_infrared",
         [](const Report& r) {
             capture(r, false, V4L2_PIX_FMT_Y10BPACK, 488, 4, 0, [](const fake::Feed& feed, int n) {
                 return fake::pack_bits(feed.infrared(n, 640, 488), 10);
             });
         }},
        {"gspca_loss_1",
         [](const Report& r) { capture(r, true, V4L2_PIX_FMT_Y10BPACK, 480, 8, 0.01, depth10); }},
        {"gspca_unplug", unplug}};
}

}  // namespace kino::guest
