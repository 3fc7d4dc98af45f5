#include <fmt/format.h>

#include <algorithm>
#include <glm/geometric.hpp>
#include <utility>

#include "calibration/report/report.h"
#include "calibration/report/report_pictures.h"
#include "sensor/png_io.h"

namespace kino {
namespace {

// Nothing may be fetched, whatever the page says.
constexpr std::string_view kHead = R"(<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; style-src 'unsafe-inline'; img-src data:">
<meta name="viewport" content="width=device-width">
<style>
body { font: 15px/1.45 sans-serif; max-width: 70em; margin: 2em auto; padding: 0 1em; color: #222; background: #fff; }
h1, h2 { font-weight: 600; }
table { border-collapse: collapse; margin: 1em 0; }
td, th { padding: .2em .9em; border-bottom: 1px solid #ddd; text-align: right; }
td:first-child, th:first-child { text-align: left; }
.side { display: grid; grid-template-columns: repeat(auto-fit, minmax(20em, 1fr)); gap: 1em; }
.picture { width: 100%; border: 1px solid #ccc; }
.paper { fill: #fafafa; }
.chart { width: 100%; max-height: 22em; font-size: 12px; }
.small { font-size: 9px; }
.camera0 { fill: #2a6fb0; } .camera1 { fill: #c2622b; }
.chosen { font-weight: 600; } .held { color: #888; }
</style>
)";

std::string deviation(const SolvedNumber& number) {
    return number.held ? std::string("held") : fmt::format("{:.3g}", number.sigma);
}

std::string number_table(const std::vector<SolvedNumber>& numbers) {
    std::string out =
        "<table><tr><th>number</th><th>value</th><th>standard deviation</th><th>unit</th></tr>";
    for (const SolvedNumber& n : numbers) {
        out += fmt::format("<tr{}><td>{}</td><td>{:.6g}</td><td>{}</td><td>{}</td></tr>",
                           n.held ? " class=\"held\"" : "", html_text(n.name), n.value,
                           deviation(n), html_text(n.unit));
    }
    return out + "</table>\n";
}

std::string score_table(const CameraResult& camera) {
    if (camera.scores.empty()) return {};
    std::string out =
        "<p>Lens models on views that they were not fitted to; the simplest one that is as good "
        "as the best within its standard error is taken.</p><table><tr><th>model</th><th>RMS of "
        "the fit, px</th><th>RMS held out, px</th></tr>";
    for (const LensScore& score : camera.scores) {
        out += fmt::format("<tr{}><td>{}</td><td>{:.4f}</td><td>{:.4f}</td></tr>",
                           score.model == camera.model ? " class=\"chosen\"" : "",
                           name(score.model), score.fit_px, score.held_out_px);
    }
    return out + "</table>\n";
}

std::string camera_part(const CameraResult& camera) {
    return fmt::format(
               "<h2>{}</h2>\n<p>{} x {} px, lens model {}, RMS {:.3f} px over {} corners; they lie "
               "in {:.0f} % of the picture's fields.</p>\n",
               html_text(camera.name), camera.camera.width, camera.camera.height,
               name(camera.model), camera.rms_px, camera.errors.size(), 100 * camera.coverage) +
           number_table(camera.numbers) + score_table(camera) + "<div class=\"side\"><figure>" +
           coverage_svg(camera) +
           "<figcaption>Where corners were seen; one colour a view.</figcaption></figure><figure>" +
           residual_svg(camera) +
           fmt::format("<figcaption>Errors, {:.0f} times enlarged.</figcaption></figure></div>\n",
                       camera.camera.width / 40.0 / std::max(1e-9, camera.rms_px));
}

std::string rig_part(const Calibration& c) {
    if (c.cameras.size() != 2) return {};
    return fmt::format(
               "<h2>From {} to {}</h2>\n<p>{:.1f} mm apart. A turn about an axis of the camera, "
               "then a shift.</p>\n",
               html_text(c.cameras[0].name), html_text(c.cameras[1].name),
               1000 * glm::length(c.second_from_first.translation)) +
           number_table(c.rig);
}

std::string planes_part(const std::vector<PlaneBand>& planes) {
    if (planes.empty()) return {};
    std::string out =
        "<h2>Depth by distance</h2>\n<p>Distance of the depth points from planes fitted to flat "
        "parts of the scene, RMS.</p>\n" +
        planes_svg(planes) + "<table><tr><th>distance, m</th><th>planes</th><th>RMS, mm</th></tr>";
    for (const PlaneBand& band : planes) {
        out += fmt::format("<tr><td>{:.2f}</td><td>{}</td><td>{:.2f}</td></tr>", band.distance_m,
                           band.planes, band.rms_mm);
    }
    return out + "</table>\n";
}

std::string drift_part(const std::optional<DriftSeries>& drift) {
    if (!drift || drift->points.empty()) return {};
    std::string out =
        "<h2>Drift</h2>\n<p>Scale of the depth of a still scene against its beginning. " +
        drift_text(*drift) + "</p>\n";
    return out + drift_svg(*drift) + "\n";
}

std::string overlays_part(const std::vector<ReportPicture>& pictures) {
    if (pictures.empty()) return {};
    std::string out =
        "<h2>Depth over colour</h2>\n<p>Red is near, blue far, contours of the depth are white: "
        "they should lie on the contours of the things.</p>\n<div class=\"side\">";
    for (const ReportPicture& picture : pictures) {
        out += fmt::format(
            "<figure><img class=\"picture\" width=\"{}\" height=\"{}\" alt=\"{}\" src=\"{}\">"
            "<figcaption>{}</figcaption></figure>",
            picture.width, picture.height, html_text(picture.caption), data_uri(picture.png),
            html_text(picture.caption));
    }
    return out + "</div>\n";
}

std::string list(const std::vector<std::string>& notes) {
    std::string out;
    for (const std::string& note : notes) out += "<li>" + html_text(note) + "</li>\n";
    return out;
}

}  // namespace

Result<ReportPicture> report_picture(std::string caption, const Image<Rgba8>& image) {
    KINO_ASSIGN(auto png, encode_png_rgba8(image.view(), {.compression = 9}));
    return ReportPicture{std::move(caption), image.width(), image.height(), std::move(png)};
}

std::string drift_text(const DriftSeries& drift) {
    if (drift.points.empty()) return "nothing still and flat was seen";
    double lowest = 1;
    double highest = 1;
    for (const DriftPoint& p : drift.points) {
        lowest = std::min(lowest, p.scale);
        highest = std::max(highest, p.scale);
    }
    std::string out =
        fmt::format("over {:.0f} s between {:+.3f} % and {:+.3f} %", drift.points.back().time_s,
                    100 * (lowest - 1), 100 * (highest - 1));
    if (drift.warm_up) {
        out += fmt::format("; warming up: {:+.3f} % with a time of {:.0f} s",
                           100 * drift.warm_up->change, drift.warm_up->tau_s);
    }
    if (drift.per_kelvin) out += fmt::format("; {:+.4f} % a kelvin", 100 * *drift.per_kelvin);
    return out;
}

std::string report_html(const Report& report) {
    const Calibration& c = report.calibration;
    std::string out(kHead);
    out += "<title>" + html_text(report.title) + "</title>\n</head>\n<body>\n<h1>" +
           html_text(report.title) + "</h1>\n";
    const std::string notes = list(report.notes) + list(c.notes);
    const std::string said = notes.empty() ? "" : "<ul>\n" + notes + "</ul>\n";
    if (c.cameras.empty()) {
        return out + said + planes_part(report.planes) + drift_part(report.drift) +
               overlays_part(report.overlays) + "</body>\n</html>\n";
    }
    out += fmt::format(
        "<p>Board {}; {} views. RMS {:.3f} px; noise of a corner {:.3f} px an axis.</p>\n",
        html_text(report.board), c.views.size(), c.rms_px, c.sigma_px);
    out += said;
    out += "<h2>RMS by view</h2>\n" + view_rms_svg(c) + "\n";
    for (const CameraResult& camera : c.cameras) out += camera_part(camera);
    out += rig_part(c) + overlays_part(report.overlays) + planes_part(report.planes) +
           drift_part(report.drift);
    return out + "</body>\n</html>\n";
}

}  // namespace kino
