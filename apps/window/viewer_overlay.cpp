#include <fmt/format.h>

#include "apps/window/viewer.h"

namespace kino {
namespace {

std::string stream_text(const StreamInfo& stream) {
    std::string text = stream_name(stream.id.kind);
    if (stream.width > 0) text += fmt::format(" {}x{}", stream.width, stream.height);
    if (stream.nominal_hz > 0) text += fmt::format(" at {:.0f} Hz", stream.nominal_hz);
    return text;
}

/// "2 people, 7 in control"
std::string people_text(const ProcessedFrame& frame, bool tracked) {
    if (!frame.set.bodies) return {};
    const std::size_t count = frame.set.bodies->bodies.size();
    std::string text = count == 0   ? "nobody"
                       : count == 1 ? "1 person"
                                    : fmt::format("{} people", count);
    if (frame.primary_id != 0) text += fmt::format(", {} in control", frame.primary_id);
    return tracked ? text : text + " (recorded)";
}

}  // namespace

OverlayText Viewer::overlay_text() {
    const LiveStatus status = playing_->runner().status();
    OverlayText text;
    text.name = playing_->info().name;
    text.note = playing_->info().note;
    for (const StreamInfo& stream : playing_->info().streams) {
        text.streams.push_back(stream_text(stream));
    }
    text.pictures_per_s = pictures_per_s_;
    text.frames_per_s = frames_per_s_;
    text.frame_ms = last_.ms;
    text.groups = renderer_.group_times();
    if (frame_) {
        text.stages = frame_->times;
        text.points = frame_->valid_points;
        text.tracking = frame_->tracking;
        text.people = people_text(*frame_, status.bodies);
    }
    text.alignment = alignment_.words();
    text.latency = latency_;
    if (status.recording) {
        text.recording = fmt::format(
            "{}{} frames, {:.1f} MB, {} lost{}",
            status.is_recording ? "" : "ended: ", status.recording->frames,
            static_cast<double>(status.recording->bytes) / 1e6, status.recording->dropped,
            status.recording->queue_fill > 0.5 ? ", the disk is slow" : "");
    }
    text.passes = last_.report.passes;
    text.device_bytes = renderer_.device().memory().current;
    text.dropped = status.dropped;
    text.errors = status.errors;
    text.last_error = status.last_error;
    text.mode =
        fmt::format("{}, {} view, {} colour", style_name(draw_options_.style),
                    view_name(camera_.kind), color_name(builder_.color_mode(draw_options_)));
    for (const std::string& level : budget_.choice().levels) text.mode += ", " + level;
    if (chooser_.on()) {
        text.mode += fmt::format(", zoom {}", zoom_by_name(chooser_.options().by));
    }
    return text;
}

}  // namespace kino
