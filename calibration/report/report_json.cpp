#include <nlohmann/json.hpp>
#include <utility>

#include "calibration/report/report.h"
#include "calibration/report/report_pictures.h"
#include "sensor/file_bytes.h"

namespace kino {
namespace {

using nlohmann::ordered_json;

ordered_json numbers_json(const std::vector<SolvedNumber>& numbers) {
    ordered_json out = ordered_json::object();
    for (const SolvedNumber& number : numbers) {
        out[number.name] = {{"value", number.value},
                            {"sigma", number.sigma},
                            {"unit", number.unit},
                            {"held", number.held}};
    }
    return out;
}

ordered_json pose_json(const Pose& pose) {
    const auto& r = pose.rotation;
    const auto& t = pose.translation;
    return {{"rotation_wxyz", {r.w, r.x, r.y, r.z}}, {"translation_m", {t.x, t.y, t.z}}};
}

ordered_json camera_json(const CameraResult& camera) {
    ordered_json out = {{"name", camera.name},
                        {"width", camera.camera.width},
                        {"height", camera.camera.height},
                        {"lens_model", name(camera.model)},
                        {"rms_px", camera.rms_px},
                        {"coverage", camera.coverage},
                        {"numbers", numbers_json(camera.numbers)}};
    ordered_json scores = ordered_json::array();
    for (const LensScore& score : camera.scores) {
        scores.push_back({{"lens_model", name(score.model)},
                          {"fit_px", score.fit_px},
                          {"held_out_px", score.held_out_px}});
    }
    out["lens_models"] = scores;
    ordered_json views = ordered_json::array();
    for (const auto& rms : camera.view_rms_px) {
        views.push_back(rms ? ordered_json(*rms) : ordered_json());
    }
    out["view_rms_px"] = views;
    return out;
}

ordered_json drift_json(const DriftSeries& drift) {
    ordered_json out = {{"points", ordered_json::array()}};
    for (const DriftPoint& p : drift.points) {
        ordered_json point = {{"time_s", p.time_s},
                              {"distance_m", p.distance_m},
                              {"scale", p.scale},
                              {"sigma", p.sigma}};
        if (p.temperature_c) point["temperature_c"] = *p.temperature_c;
        out["points"].push_back(point);
    }
    if (drift.warm_up) {
        out["warm_up"] = {{"final_scale", drift.warm_up->final_scale},
                          {"change", drift.warm_up->change},
                          {"tau_s", drift.warm_up->tau_s}};
    }
    if (drift.per_kelvin) out["per_kelvin"] = *drift.per_kelvin;
    return out;
}

}  // namespace

std::string report_json(const Report& report) {
    const Calibration& c = report.calibration;
    ordered_json out = {{"kinoscope_calibration_report", 1},
                        {"title", report.title},
                        {"board", report.board},
                        {"rms_px", c.rms_px},
                        {"sigma_px", c.sigma_px},
                        {"iterations", c.iterations},
                        {"views", c.views}};
    out["cameras"] = ordered_json::array();
    for (const CameraResult& camera : c.cameras) out["cameras"].push_back(camera_json(camera));
    if (c.cameras.size() == 2) {
        out["second_from_first"] = pose_json(c.second_from_first);
        out["second_from_first"]["numbers"] = numbers_json(c.rig);
    }
    out["first_from_board"] = ordered_json::array();
    for (const Pose& pose : c.first_from_board) out["first_from_board"].push_back(pose_json(pose));
    out["depth_planes"] = ordered_json::array();
    for (const PlaneBand& band : report.planes) {
        out["depth_planes"].push_back(
            {{"distance_m", band.distance_m}, {"planes", band.planes}, {"rms_mm", band.rms_mm}});
    }
    out["depth_over_color"] = ordered_json::array();
    for (const ReportPicture& picture : report.overlays) {
        out["depth_over_color"].push_back({{"caption", picture.caption},
                                           {"width", picture.width},
                                           {"height", picture.height},
                                           {"picture", data_uri(picture.png)}});
    }
    if (report.drift) out["drift"] = drift_json(*report.drift);
    out["notes"] = report.notes;
    for (const std::string& note : c.notes) out["notes"].push_back(note);
    // Names of files may hold bytes that are not UTF-8.
    return out.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

Result<void> write_report(const std::filesystem::path& folder, const Report& report) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error) return fail(error.message(), folder.string());
    const std::string json = report_json(report);
    KINO_TRY(write_file_bytes(folder / "report.json", json.data(), json.size()));
    const std::string html = report_html(report);
    return write_file_bytes(folder / "report.html", html.data(), html.size());
}

}  // namespace kino
