#include "apps/demo_show/show_summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "apps/headless/run_report.h"
#include "skeleton/gestures/gesture_json.h"

namespace kino {
namespace {

using Json = nlohmann::ordered_json;

Json gestures_json(const ShowSummary& summary) {
    Json out = Json::array();
    for (const SeenGesture& seen : summary.gestures) {
        const GestureEvent& event = seen.event;
        out.push_back({{"frame", seen.frame},
                       {"picture", seen.picture},
                       {"delay_ms", to_ms(seen.delay)},
                       {"time_s", to_seconds(event.time)},
                       {"kind", gesture_name(event.kind)},
                       {"phase", phase_name(event.phase)},
                       {"hand", hand_name(event.hand)},
                       {"body", event.body_id},
                       {"primary", event.primary},
                       {"value", event.value}});
    }
    return out;
}

Json events_json(const ShowSummary& summary) {
    Json out = Json::array();
    for (const SeenEvent& seen : summary.events) {
        out.push_back({{"picture", seen.picture},
                       {"time_s", to_seconds(seen.event.time)},
                       {"what", seen.event.what},
                       {"detail", seen.event.detail},
                       {"body", seen.event.body_id}});
    }
    return out;
}

TimeNs longest_delay(const ShowSummary& summary) {
    TimeNs most = 0;
    for (const SeenGesture& seen : summary.gestures) most = std::max(most, seen.delay);
    return most;
}

}  // namespace

Json to_json(const ShowSummary& s) {
    return {{"format", "kinoscope demo 1"},
            {"deterministic",
             {{"width", s.options.width},
              {"height", s.options.height},
              {"uri", s.source.uri},
              {"name", s.source.name},
              {"licence", s.source.licence},
              {"scenes", s.options.scenes},
              {"avatar", s.options.avatar},
              {"body", s.options.shows_body()},
              {"mirror", s.options.mirror},
              {"lod", s.options.lod.value_or(1)},
              {"frames", s.frames},
              {"dropped", 0},
              {"errors", s.errors},
              {"first_error", s.first_error},
              {"interrupted", s.interrupted},
              {"pictures_fnv1a", fmt::format("{:016x}", s.pictures_hash)},
              {"events", events_json(s)},
              {"gestures", gestures_json(s)},
              {"longest_delay_ms", to_ms(longest_delay(s))},
              {"most_lights", s.most_lights},
              {"most_meshes", s.most_meshes},
              {"passes", s.passes},
              {"device_bytes", s.device_bytes}}},
            {"timing",
             {{"wall_s", s.wall_s},
              {"first_picture_ms", to_ms(s.first_picture)},
              {"read", times_json(s.read)},
              {"bodies", times_json(s.track)},
              {"play", times_json(s.play)},
              {"render", times_json(s.render)}}},
            {"machine", machine_json(s.device, s.video_codec)}};
}

std::string to_text(const ShowSummary& s) {
    std::string text = fmt::format(
        "{}: {} frames; median ms: read {:.1f}, bodies {:.1f}, play {:.1f}, draw {:.1f}\n",
        s.source.name.empty() ? s.source.uri : s.source.name, s.frames, s.read.median_ms(),
        s.track.median_ms(), s.play.median_ms(), s.render.median_ms());
    if (s.errors > 0) text += fmt::format("{} unreadable ({})\n", s.errors, s.first_error);
    for (const SeenEvent& seen : s.events) {
        text += fmt::format("  {:6.2f} s: {}{}{}\n", to_seconds(seen.event.time), seen.event.what,
                            seen.event.detail.empty() ? "" : ": ", seen.event.detail);
    }
    text += fmt::format(
        "{} gestures, each in the picture after at most {:.0f} ms of the recording\n",
        std::count_if(s.gestures.begin(), s.gestures.end(),
                      [](const SeenGesture& g) { return g.event.phase != GesturePhase::change; }),
        to_ms(longest_delay(s)));
    text += fmt::format("first picture after {:.0f} ms; drawn by {} at {}x{} in {:.1f} s{}\n",
                        to_ms(s.first_picture), s.device.name, s.options.width, s.options.height,
                        s.wall_s, s.interrupted ? " (ended early by the user)" : "");
    return text;
}

}  // namespace kino
