// The kernel's own driver for the Kinect against the fake.

#include <linux/videodev2.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "tests/sensor/device/fake_kinect/bits.h"
#include "tests/sensor/device/fake_kinect/fake_kinect.h"
#include "tests/sensor/device/scenarios/bound_kinect.h"
#include "tests/sensor/device/scenarios/capture.h"
#include "tests/sensor/device/scenarios/report.h"
#include "tests/sensor/device/scenarios/truth.h"

namespace kino::guest {
namespace {

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
    const auto bound = bind_to_kernel(report, depth_mode, options);
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

}  // namespace

std::vector<Scenario> gspca_scenarios() {
    return {{"gspca_depth",
             [](const Report& r) { capture(r, true, V4L2_PIX_FMT_Y10BPACK, 480, 6, 0, depth10); }},
            {"gspca_loss_1", [](const Report& r) {
                 capture(r, true, V4L2_PIX_FMT_Y10BPACK, 480, 8, 0.01, depth10);
             }}};
}

}  // namespace kino::guest
