// Our V4L2 source: the kernel's driver for the Kinect, and vivid with its errors.

#include <linux/videodev2.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "sensor/v4l2/v4l2_driver.h"
#include "tests/sensor/device/scenarios/bound_kinect.h"
#include "tests/sensor/device/scenarios/capture.h"
#include "tests/sensor/device/scenarios/gathered.h"
#include "tests/sensor/device/scenarios/modules.h"
#include "tests/sensor/device/scenarios/report.h"

namespace kino::guest {
namespace {

std::unique_ptr<Source> open_source_at(const Report& report, const std::string& address) {
    auto source = v4l2_opener().open("v4l2:" + address);
    if (source) return std::move(*source);
    report.failure(source.error().to_string());
    return nullptr;
}

void kinect_depth(const Report& report, double lost, std::size_t frames) {
    fake::KinectOptions options;
    options.camera.faults = {.seed = 5, .lost = lost};
    const auto bound = bind_to_kernel(report, true, options);
    if (!bound) return;
    const auto source = open_source_at(report, bound->node + "?as=depth");
    if (!source) return;
    Gathered gathered(*source);
    if (!subscribe(report, *source, StreamKind::depth)) return;
    gathered.wait_for(StreamKind::depth, frames);
    gathered.stop();
    compare(report, "depth", gathered.depth(),
            depth_stream(*bound->feed, bound->kinect->camera().sent(0x82), 10));
}

void kinect_color(const Report& report) {
    const auto bound = bind_to_kernel(report, false, {});
    if (!bound) return;
    const auto source = open_source_at(report, bound->node + "?format=GRBG&size=640x480");
    if (!source) return;
    Gathered gathered(*source);
    if (!subscribe(report, *source, StreamKind::color)) return;
    gathered.wait_for(StreamKind::color, 5);
    gathered.stop();
    compare(report, "color", gathered.color(),
            byte_stream(bound->kinect->camera().sent(0x81), 640,
                        [&](int n) { return bound->feed->bayer(n, 640, 480); }));
}

void kinect_infrared(const Report& report) {
    const auto bound = bind_to_kernel(report, false, {});
    if (!bound) return;
    const auto source =
        open_source_at(report, bound->node + "?as=infrared&format=Y10B&size=640x488");
    if (!source) return;
    Gathered gathered(*source);
    if (!subscribe(report, *source, StreamKind::infrared)) return;
    gathered.wait_for(StreamKind::infrared, 4);
    gathered.stop();
    compare(report, "infrared", gathered.infrared(),
            infrared_stream(*bound->feed, bound->kinect->camera().sent(0x81)));
}

void kinect_unplug_resume(const Report& report) {
    fake::KinectOptions options;
    options.cut_after = 2'000'003;
    auto bound = bind_to_kernel(report, true, options);
    if (!bound) return;
    const auto source = open_source_at(report, bound->node + "?as=depth");
    if (!source) return;
    Gathered gathered(*source);
    if (!subscribe(report, *source, StreamKind::depth)) return;
    report.value("lost", gathered.wait_for(EventKind::lost) ? 1 : 0);
    const std::size_t before = gathered.count(StreamKind::depth);
    report.value("frames_before", static_cast<double>(before));
    bound->kinect.reset();
    const std::shared_ptr<const fake::Feed> feed = fake::noise_feed(99);
    const auto again = fake::Kinect::plug(feed);
    if (!again) return report.failure(again.error().to_string());
    report.value("back", gathered.wait_for(EventKind::back) ? 1 : 0);
    gathered.wait_for(StreamKind::depth, before + 4);
    gathered.stop();
    auto frames = gathered.depth();
    frames.erase(frames.begin(), frames.begin() + static_cast<std::ptrdiff_t>(before));
    compare(report, "resumed", frames, depth_stream(*feed, (*again)->camera().sent(0x82), 10));
}

/// vivid with pictures that stand still, without the running text. Empty, and reported, on failure.
std::string still_node(const Report& report) {
    const auto in = insert_module("vivid", "n_devs=1 node_types=0x1 num_inputs=1 input_types=0");
    if (!in) {
        report.failure(in.error().to_string());
        return {};
    }
    std::string node = wait_for_video_node("vivid");
    if (node.empty()) report.failure("vivid made no node");
    const auto text = set_control(node, "OSD Text Mode", 2);
    if (!text) report.failure(text.error().to_string());
    return node;
}

/// What a format's bytes stand for, the plain way.
std::vector<std::uint16_t> values_of(const std::vector<std::uint8_t>& bytes, int bytes_each,
                                     std::uint16_t mask) {
    if (bytes_each == 1) return {bytes.begin(), bytes.end()};
    std::vector<std::uint16_t> values(bytes.size() / 2);
    for (std::size_t i = 0; i < values.size(); ++i) {
        values[i] = static_cast<std::uint16_t>((bytes[2 * i] | bytes[2 * i + 1] << 8) & mask);
    }
    return values;
}

/// The values of our source's frame of that kind, if it is of that kind.
std::vector<std::uint16_t> values_of(const Gathered& gathered, StreamKind kind) {
    if (kind == StreamKind::color && !gathered.color().empty()) {
        const auto& bytes = gathered.color().back()->bytes;
        return {bytes.begin(), bytes.end()};
    }
    if (kind == StreamKind::infrared && !gathered.infrared().empty()) {
        const auto pixels = gathered.infrared().back()->raw.pixels();
        return {pixels.begin(), pixels.end()};
    }
    if (kind == StreamKind::depth && !gathered.depth().empty()) {
        const auto pixels = gathered.depth().back()->raw.pixels();
        return {pixels.begin(), pixels.end()};
    }
    return {};
}

void vivid_formats(const Report& report) {
    struct Case {
        const char* name;
        std::uint32_t fourcc;
        StreamKind kind;
        int bytes_each;
        std::uint16_t mask;
    };
    const std::string node = still_node(report);
    if (node.empty()) return;
    for (const Case& c : {Case{"Y16", V4L2_PIX_FMT_Y16, StreamKind::depth, 2, 0xffff},
                          Case{"Y16", V4L2_PIX_FMT_Y16, StreamKind::infrared, 2, 0xffff},
                          Case{"Y12", V4L2_PIX_FMT_Y12, StreamKind::infrared, 2, 0x0fff},
                          Case{"Y10", V4L2_PIX_FMT_Y10, StreamKind::infrared, 2, 0x03ff},
                          Case{"GREY", V4L2_PIX_FMT_GREY, StreamKind::infrared, 1, 0xff},
                          Case{"GRBG", V4L2_PIX_FMT_SGRBG8, StreamKind::color, 1, 0xff},
                          Case{"UYVY", V4L2_PIX_FMT_UYVY, StreamKind::color, 1, 0xff},
                          Case{"YUYV", V4L2_PIX_FMT_YUYV, StreamKind::color, 1, 0xff}}) {
        const std::string key = std::string(c.name) + (c.kind == StreamKind::depth   ? "_depth"
                                                       : c.kind == StreamKind::color ? "_color"
                                                                                     : "_infrared");
        CapturedFrame plain;
        {
            auto capture = Capture::start(node, c.fourcc, 640, 360);
            if (!capture) return report.failure(key + ": " + capture.error().to_string());
            auto frame = (*capture)->next();
            if (!frame) return report.failure(key + ": " + frame.error().to_string());
            plain = std::move(*frame);
        }
        const auto source = open_source_at(
            report, node + (c.kind == StreamKind::depth ? "?as=depth&format=" : "?format=") +
                        c.name + "&size=640x360");
        if (!source) continue;
        Gathered gathered(*source);
        if (!subscribe(report, *source, c.kind)) continue;
        gathered.wait_for(c.kind, 2);
        gathered.stop();
        const auto got = values_of(gathered, c.kind);
        report.value(key, !got.empty() && got == values_of(plain.bytes, c.bytes_each, c.mask));
    }
}

/// Runs our source on vivid, does `disturb`, and says how the stream goes on.
void vivid_trouble(const Report& report, const std::string& control, int value, int back_to) {
    const std::string node = still_node(report);
    if (node.empty()) return;
    const auto source = open_source_at(report, node + "?as=infrared&format=GREY&size=640x360");
    if (!source) return;
    Gathered gathered(*source);
    if (!subscribe(report, *source, StreamKind::infrared)) return;
    gathered.wait_for(StreamKind::infrared, 3);
    const auto done = set_control(node, control, value);
    if (!done) report.failure(done.error().to_string());
    const std::size_t before = gathered.count(StreamKind::infrared);
    gathered.wait_for(StreamKind::infrared, before + 12);
    if (back_to >= 0) (void)set_control(node, control, back_to);
    gathered.stop();
    const auto frames = gathered.infrared();
    double lost = 0;
    for (const auto& frame : frames) lost += static_cast<double>(frame->header.lost_before);
    report.value("frames_after", static_cast<double>(frames.size() - before));
    report.value("lost_frames", lost);
    double damaged = 0;
    for (const auto& frame : frames) damaged += frame->damaged_rows.empty() ? 0 : 1;
    report.value("damaged", damaged);
    (void)gathered.wait_for(EventKind::started);
    report.value("lost_events", static_cast<double>(std::ranges::count(
                                    gathered.events(), EventKind::lost, &Event::kind)));
    report.value("back_events", static_cast<double>(std::ranges::count(
                                    gathered.events(), EventKind::back, &Event::kind)));
}

}  // namespace

std::vector<Scenario> v4l2_scenarios() {
    const auto trouble = [](const char* control, int value, int back_to) {
        return [=](const Report& r) { vivid_trouble(r, control, value, back_to); };
    };
    return {{"v4l2_kinect_depth", [](const Report& r) { kinect_depth(r, 0, 6); }},
            {"v4l2_kinect_loss_0.2", [](const Report& r) { kinect_depth(r, 0.002, 6); }},
            {"v4l2_kinect_color", kinect_color},
            {"v4l2_kinect_infrared", kinect_infrared},
            {"v4l2_kinect_unplug", kinect_unplug_resume},
            {"v4l2_vivid_formats", vivid_formats},
            {"v4l2_vivid_flagged", trouble("Inject V4L2_BUF_FLAG_ERROR", 1, -1)},
            {"v4l2_vivid_dropped", trouble("Percentage of Dropped Buffers", 40, 0)},
            {"v4l2_vivid_fatal", trouble("Inject Fatal Streaming Error", 1, -1)},
            {"v4l2_vivid_disconnect", trouble("Disconnect", 1, -1)}};
}

}  // namespace kino::guest
