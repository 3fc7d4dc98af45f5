// The kernel's virtual video device: formats, and errors at will.

#include <fmt/format.h>
#include <linux/videodev2.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "tests/sensor/device/scenarios/capture.h"
#include "tests/sensor/device/scenarios/modules.h"
#include "tests/sensor/device/scenarios/report.h"

namespace kino::guest {
namespace {

/// A node whose pictures stand still, without the running text. Empty on failure.
std::string still_node(const Report& report) {
    const auto in = insert_module("vivid", "n_devs=1 node_types=0x1 num_inputs=1 input_types=0");
    if (!in) {
        report.failure(in.error().to_string());
        return {};
    }
    const std::string node = wait_for_video_node("vivid");
    if (node.empty()) report.failure("vivid made no node");
    const auto text = set_control(node, "OSD Text Mode", 2);
    if (!text) report.failure(text.error().to_string());
    return node;
}

std::string name_of(std::uint32_t fourcc) {
    std::string name;
    for (int shift = 0; shift < 32; shift += 8) {
        const char c = static_cast<char>((fourcc >> shift) & 0x7f);
        if (c != ' ') name += c;
    }
    return name;
}

void formats(const Report& report) {
    const std::string node = still_node(report);
    if (node.empty()) return;
    const auto listed = formats_of(node);
    for (const std::uint32_t fourcc :
         {V4L2_PIX_FMT_Y16, V4L2_PIX_FMT_Y10, V4L2_PIX_FMT_Y12, V4L2_PIX_FMT_GREY,
          V4L2_PIX_FMT_SGRBG8, V4L2_PIX_FMT_UYVY, V4L2_PIX_FMT_YUYV}) {
        if (std::ranges::find(listed, fourcc) == listed.end()) {
            report.failure(name_of(fourcc) + " is not listed");
            continue;
        }
        auto capture = Capture::start(node, fourcc, 640, 360);
        if (!capture) {
            report.failure(name_of(fourcc) + ": " + capture.error().to_string());
            continue;
        }
        int full_size = 0;
        for (int i = 0; i < 3; ++i) {
            const auto frame = (*capture)->next();
            if (frame && frame->full_size && !frame->marked_bad) ++full_size;
        }
        report.value(name_of(fourcc) + "_frames", full_size);
    }
}

void flagged_buffers(const Report& report) {
    const std::string node = still_node(report);
    if (node.empty()) return;
    auto capture = Capture::start(node, V4L2_PIX_FMT_GREY, 640, 360);
    if (!capture) return report.failure(capture.error().to_string());
    int marked_bad = 0;
    for (int i = 0; i < 12; ++i) {
        if (i == 3) (void)set_control(node, "Inject V4L2_BUF_FLAG_ERROR", 1);
        const auto frame = (*capture)->next();
        if (!frame) return report.failure(frame.error().to_string());
        marked_bad += frame->marked_bad ? 1 : 0;
    }
    report.value("marked_bad", marked_bad);
}

}  // namespace

std::vector<Scenario> vivid_scenarios() {
    return {{"vivid_formats", formats}, {"vivid_flagged_buffers", flagged_buffers}};
}

}  // namespace kino::guest
