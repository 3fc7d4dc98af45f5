// A session that is being recorded while the device is pulled out and plugged in again.

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "sensor/kinect1/kinect1_driver.h"
#include "sensor/live/live_source.h"
#include "sensor/session/recorder.h"
#include "sensor/session/session_reader.h"
#include "tests/sensor/device/fake_kinect/fake_kinect.h"
#include "tests/sensor/device/scenarios/gathered.h"
#include "tests/sensor/device/scenarios/report.h"

namespace kino::guest {
namespace {

using DepthFrames = std::vector<std::shared_ptr<const DepthFrame>>;
using ColorFrames = std::vector<std::shared_ptr<const ColorFrame>>;

/// Reads the session and says whether it holds the frames that the tap saw, and what else.
void check_session(const Report& report, const std::filesystem::path& file,
                   const DepthFrames& depth, const ColorFrames& color) {
    auto reader = SessionReader::open(file);
    if (!reader) return report.failure(reader.error().to_string());
    DepthFrames read_depth;
    ColorFrames read_color;
    for (const SessionEntry& entry : (*reader)->frames()) {
        auto frame = (*reader)->read(entry);
        if (!frame) {
            report.failure(frame.error().to_string());
            continue;
        }
        if (auto* held = std::get_if<std::shared_ptr<const DepthFrame>>(&*frame)) {
            read_depth.push_back(*held);
        }
        if (auto* held = std::get_if<std::shared_ptr<const ColorFrame>>(&*frame)) {
            read_color.push_back(*held);
        }
    }
    bool depth_same = read_depth.size() == depth.size();
    for (std::size_t i = 0; depth_same && i < depth.size(); ++i) {
        depth_same = std::ranges::equal(read_depth[i]->raw.pixels(), depth[i]->raw.pixels()) &&
                     read_depth[i]->damaged_rows == depth[i]->damaged_rows &&
                     read_depth[i]->header.device_time == depth[i]->header.device_time;
    }
    bool color_same = read_color.size() == color.size();
    for (std::size_t i = 0; color_same && i < color.size(); ++i) {
        color_same = read_color[i]->bytes == color[i]->bytes;
    }
    report.value("depth_same", depth_same);
    report.value("color_same", color_same);
    double lost_events = 0;
    double back_events = 0;
    for (const SessionEvent& event : (*reader)->events()) {
        lost_events += event.kind == "lost" ? 1 : 0;
        back_events += event.kind == "back" ? 1 : 0;
    }
    report.value("lost_events", lost_events);
    report.value("back_events", back_events);
}

void unplug_while_recording(const Report& report, SessionCodec codec) {
    fake::KinectOptions options;
    options.camera.depth_hz = 10;
    options.camera.video_hz = 10;
    options.cut_after = 5'000'011;
    const std::shared_ptr<const fake::Feed> feed = fake::scene_feed();
    auto first = fake::Kinect::plug(feed, options);
    if (!first) return report.failure(first.error().to_string());
    auto source = make_live_source(kinect1_driver(), options.camera.serial);
    if (!source) return report.failure(source.error().to_string());
    auto rig = (*source)->calibration();
    if (!rig) return report.failure(rig.error().to_string());

    const auto file = std::filesystem::temp_directory_path() /
                      (codec == SessionCodec::ffv1 ? "ffv1.mkv" : "fast.mkv");
    auto recorder = Recorder::create(file, (*source)->info(), *rig, {.codec = codec});
    if (!recorder) return report.failure(recorder.error().to_string());
    DepthFrames depth;
    ColorFrames color;
    {
        Gathered gathered(
            **source, [&](StreamId id, const StreamFrame& frame) { (*recorder)->put(id, frame); });
        for (const StreamKind kind : {StreamKind::depth, StreamKind::color}) {
            if (!subscribe(report, **source, kind)) return;
        }
        report.value("lost", gathered.wait_for(EventKind::lost) ? 1 : 0);
        const std::size_t before = gathered.count(StreamKind::depth);
        report.value("frames_before", static_cast<double>(before));
        (*first).reset();
        options.cut_after = 0;
        auto second = fake::Kinect::plug(feed, options);
        if (!second) return report.failure(second.error().to_string());
        const bool back = gathered.wait_for(EventKind::back);
        report.value("back", back);
        if (!back) report.failure("not back: " + (*source)->stats().trouble);
        gathered.wait_for(StreamKind::depth, before + 5);
        gathered.stop();
        for (const Event& event : gathered.events()) (*recorder)->put_event(event);
        depth = gathered.depth();
        color = gathered.color();
        report.value("frames_after", static_cast<double>(depth.size() - before));

        DepthFrames resumed(depth.begin() + static_cast<std::ptrdiff_t>(before), depth.end());
        double as_sent = 0;
        for (const auto& frame : resumed) {
            const auto pixels = frame->raw.pixels();
            const std::vector<std::uint16_t> got(pixels.begin(), pixels.end());
            for (const auto& sent : (*second)->camera().sent(0x82)) {
                if (got == feed->depth(sent.number)) {
                    ++as_sent;
                    break;
                }
            }
        }
        report.value("resumed_as_sent", as_sent);
        bool rising = true;
        for (std::size_t i = 1; i < depth.size(); ++i) {
            rising = rising && depth[i]->header.device_time > depth[i - 1]->header.device_time &&
                     depth[i]->header.host_time > depth[i - 1]->header.host_time &&
                     depth[i]->header.sequence > depth[i - 1]->header.sequence;
        }
        report.value("rising", rising);
        source->reset();
    }
    const auto status = (*recorder)->close();
    if (!status) return report.failure(status.error().to_string());
    report.value("recorded", static_cast<double>(status->frames));
    report.value("dropped", static_cast<double>(status->dropped));
    check_session(report, file, depth, color);
}

}  // namespace

std::vector<Scenario> recording_scenarios() {
    return {
        {"recording_ffv1", [](const Report& r) { unplug_while_recording(r, SessionCodec::ffv1); }},
        {"recording_fast", [](const Report& r) { unplug_while_recording(r, SessionCodec::fast); }}};
}

}  // namespace kino::guest
