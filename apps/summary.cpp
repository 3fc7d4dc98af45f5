#include "apps/summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "apps/headless/run_report.h"
#include "apps/viewer/budget_log.h"
#include "skeleton/gestures/gesture_json.h"

namespace kino {
namespace {

using Json = nlohmann::ordered_json;

Json bodies_json(const BodySummary& bodies) {
    Json frames = Json::object();
    for (const auto& [people, count] : bodies.frames_with) frames[std::to_string(people)] = count;
    Json gestures = Json::array();
    for (const BodySummary::Seen& seen : bodies.gestures) {
        const GestureEvent& event = seen.event;
        gestures.push_back({{"frame", seen.frame},
                            {"kind", gesture_name(event.kind)},
                            {"phase", phase_name(event.phase)},
                            {"hand", hand_name(event.hand)},
                            {"body", event.body_id},
                            {"primary", event.primary},
                            {"confidence", event.confidence},
                            {"value", event.value},
                            {"name", event.name},
                            {"seconds", to_seconds(event.time - event.start_time)}});
    }
    return {{"frames_with_people", frames}, {"ids", bodies.ids}, {"gestures", gestures}};
}

Json true_error_json(const TrueErrorSummary& error) {
    return {{"pictures", error.pictures},
            {"mean_flip", error.mean_flip},
            {"worst_flip", error.worst_flip},
            {"worst_psnr_db", error.worst_psnr_db},
            {"worst_failed_pixels", error.worst_failed_pixels}};
}

Json deterministic_json(const SourceSummary& s) {
    Json streams = Json::array();
    for (const StreamInfo& stream : s.info.streams) {
        streams.push_back({{"kind", stream_name(stream.id.kind)},
                           {"width", stream.width},
                           {"height", stream.height},
                           {"nominal_hz", stream.nominal_hz},
                           {"format", stream.format}});
    }
    return {{"uri", s.info.uri},
            {"name", s.info.name},
            {"note", s.info.note},
            {"licence", s.info.licence},
            {"streams", streams},
            {"loop", loop_name(s.loop)},
            {"color", color_name(s.color)},
            {"frames", s.frames},
            {"dropped", 0},
            {"errors", s.errors},
            {"first_error", s.first_error},
            {"points", s.points},
            {"bodies", bodies_json(s.bodies)},
            {"pictures_fnv1a", fmt::format("{:016x}", s.pictures_hash)},
            {"stage",
             s.stage ? Json{{"lights", s.stage->lights}, {"meshes", s.stage->meshes}} : Json()},
            {"zoom_by", zoom_by_name(s.zoom_by)},
            {"levels", budget_log_json(s.levels)},
            {"true_error", s.true_error ? true_error_json(*s.true_error) : Json()},
            {"passes", s.passes},
            {"device_bytes", s.device_bytes}};
}

Json timing_json(const SourceSummary& s) {
    Json bodies = {{"all", times_json(s.bodies.total)}};
    if (s.bodies.people.count() > 0) {
        bodies["people"] = times_json(s.bodies.people);
        bodies["parts"] = times_json(s.bodies.parts);
        bodies["proposals"] = times_json(s.bodies.proposals);
        bodies["fit"] = times_json(s.bodies.fit);
        bodies["filter"] = times_json(s.bodies.filter);
    }
    return {{"uri", s.info.uri},
            {"bodies", bodies},
            {"read", times_json(s.read)},
            {"color", times_json(s.color_conversion)},
            {"arrive", times_json(s.arrive)},
            {"filter", times_json(s.filter)},
            {"register", times_json(s.registration)},
            {"render", times_json(s.render)},
            {"render_device", times_json(s.render_device)},
            {"write", times_json(s.write)}};
}

}  // namespace

void TrueErrorSummary::add(const TrueError& error) {
    ++pictures;
    mean_flip += (error.flip - mean_flip) / static_cast<double>(pictures);
    worst_flip = std::max(worst_flip, error.flip);
    if (std::isfinite(error.psnr_db)) {
        worst_psnr_db = worst_psnr_db > 0 ? std::min(worst_psnr_db, error.psnr_db) : error.psnr_db;
    }
    worst_failed_pixels = std::max(worst_failed_pixels, error.failed_pixels);
}

void BodySummary::add(const ProcessedFrame& frame) {
    for (const GestureEvent& event : frame.gestures) gestures.push_back({frame.set.index, event});
    if (!frame.set.bodies) return;
    ++frames_with[frame.set.bodies->bodies.size()];
    for (const Body& body : frame.set.bodies->bodies) ids.insert(body.id);
    if (!frame.bodies_are_new) return;
    total.add(frame.times.bodies);
    if (!frame.tracking) return;
    people.add(frame.tracking->people);
    parts.add(frame.tracking->parts);
    proposals.add(frame.tracking->proposals);
    fit.add(frame.tracking->fit);
    filter.add(frame.tracking->filter);
}

Json to_json(const Summary& summary) {
    Json sources = Json::array();
    Json timing = Json::array();
    for (const SourceSummary& source : summary.sources) {
        sources.push_back(deterministic_json(source));
        timing.push_back(timing_json(source));
    }
    const ReplayOptions& options = summary.options;
    return {{"format", "kinoscope summary 1"},
            {"deterministic",
             {{"width", summary.width},
              {"height", summary.height},
              {"raster", raster_name(options.raster)},
              {"style", style_name(options.style.value_or(DepthStyle::mesh))},
              {"filters", options.filters},
              {"bodies", body_mode_name(options.bodies.mode)},
              {"scene", options.scene},
              {"splat_px", options.splat_px.value_or(1)},
              {"view", view_name(options.view.value_or(ViewKind::orbit))},
              {"seeds", Json::object()},
              {"interrupted", summary.interrupted},
              {"sources", sources}}},
            {"timing", {{"wall_s", summary.wall_s}, {"sources", timing}}},
            {"machine", machine_json(summary.device, summary.video_codec)}};
}

std::string to_text(const Summary& summary) {
    std::string text;
    for (const SourceSummary& s : summary.sources) {
        text +=
            fmt::format("{}: {} frames", s.info.name.empty() ? s.info.uri : s.info.name, s.frames);
        if (s.errors > 0) text += fmt::format(", {} unreadable ({})", s.errors, s.first_error);
        text += fmt::format(
            "; median ms: read {:.1f}, colour {:.1f}, register {:.1f}, draw {:.1f}, write {:.1f}\n",
            s.read.median_ms(), s.color_conversion.median_ms(), s.registration.median_ms(),
            s.render.median_ms(), s.write.median_ms());
        if (!s.info.note.empty()) text += fmt::format("  note: {}\n", s.info.note);
        if (!s.bodies.frames_with.empty()) {
            std::string people;
            for (const auto& [count, frames] : s.bodies.frames_with) {
                people +=
                    fmt::format("{}{} in {} frames", people.empty() ? "" : ", ", count, frames);
            }
            text +=
                fmt::format("  people: {}; median ms {:.1f}\n", people, s.bodies.total.median_ms());
        }
        if (s.stage) {
            text += fmt::format("  scene {}: {} lights, {} meshes at the end\n",
                                summary.options.scene, s.stage->lights, s.stage->meshes);
        }
        if (s.true_error && s.true_error->pictures > 0) {
            text += fmt::format(
                "  against full shading, {} pictures: mean FLIP {:.4f}, worst {:.4f}, worst PSNR "
                "{:.1f} dB\n",
                s.true_error->pictures, s.true_error->mean_flip, s.true_error->worst_flip,
                s.true_error->worst_psnr_db);
        }
        for (const BodySummary::Seen& seen : s.bodies.gestures) {
            if (seen.event.phase == GesturePhase::change) continue;
            text += fmt::format("  frame {}: {}, confidence {:.2f}\n", seen.frame,
                                gesture_text(seen.event), seen.event.confidence);
        }
    }
    text += fmt::format("drawn by {} at {}x{} in {:.1f} s{}\n", summary.device.name, summary.width,
                        summary.height, summary.wall_s,
                        summary.interrupted ? " (ended early by the user)" : "");
    return text;
}

}  // namespace kino
