#include "calibration/report/report_pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>

namespace kino {
namespace {

// Length of the UTF-8 sequence that starts here, 0 if there is none (RFC 3629).
std::size_t sequence_length(std::string_view text) {
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
    const unsigned first = byte(0);
    const std::size_t length = first < 0x80                    ? 1
                               : first >= 0xC2 && first < 0xE0 ? 2
                               : first >= 0xE0 && first < 0xF0 ? 3
                               : first >= 0xF0 && first < 0xF5 ? 4
                                                               : 0;
    if (length == 0 || length > text.size()) return 0;
    for (std::size_t i = 1; i < length; ++i) {
        if ((byte(i) & 0xC0) != 0x80) return 0;
    }
    return length;
}

std::string open_svg(const CameraResult& camera, std::string_view what) {
    return fmt::format(
        "<svg role=\"img\" aria-label=\"{} of {}\" viewBox=\"0 0 {} {}\" class=\"picture\">"
        "<rect width=\"100%\" height=\"100%\" class=\"paper\"/>",
        what, html_text(camera.name), camera.camera.width, camera.camera.height);
}

std::string view_color(int view) {
    // Golden angle: neighbours differ.
    return fmt::format("hsl({:.0f},70%,45%)", std::fmod(view * 137.508, 360.0));
}

}  // namespace

std::string html_text(std::string_view text) {
    std::string out;
    while (!text.empty()) {
        const std::size_t length = sequence_length(text);
        const char c = text.front();
        if (length == 0) {
            out += "\xEF\xBF\xBD";
        } else if (c == '&') {
            out += "&amp;";
        } else if (c == '<') {
            out += "&lt;";
        } else if (c == '>') {
            out += "&gt;";
        } else if (c == '"') {
            out += "&quot;";
        } else if (c == '\'') {
            out += "&#39;";
        } else {
            out += text.substr(0, length);
        }
        text.remove_prefix(std::max<std::size_t>(1, length));
    }
    return out;
}

std::string coverage_svg(const CameraResult& camera) {
    std::string out = open_svg(camera, "Coverage");
    const double radius = camera.camera.width / 200.0;
    for (const CornerError& e : camera.errors) {
        out += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:.1f}\" fill=\"{}\"/>",
                           e.px.x + 0.5, e.px.y + 0.5, radius, view_color(e.view));
    }
    return out + "</svg>";
}

std::string residual_svg(const CameraResult& camera) {
    std::string out = open_svg(camera, "Residuals");
    const double enlarge = camera.camera.width / 40.0 / std::max(1e-9, camera.rms_px);
    // A single wrong corner must not cross the whole picture.
    const double longest = camera.camera.width / 8.0;
    for (const CornerError& e : camera.errors) {
        glm::dvec2 line = e.error * enlarge;
        const double length = glm::length(line);
        if (length > longest) line *= longest / length;
        out += fmt::format(
            "<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"{}\" "
            "stroke-width=\"{:.1f}\"/>",
            e.px.x + 0.5, e.px.y + 0.5, e.px.x + 0.5 + line.x, e.px.y + 0.5 + line.y,
            view_color(e.view), camera.camera.width / 500.0);
    }
    return out + "</svg>";
}

std::string view_rms_svg(const Calibration& calibration) {
    const std::size_t cameras = calibration.cameras.size();
    double highest = 1e-9;
    for (const CameraResult& camera : calibration.cameras) {
        for (const auto& rms : camera.view_rms_px) highest = std::max(highest, rms.value_or(0));
    }
    const double step = 14.0 * static_cast<double>(cameras) + 8;
    const double width = 60 + step * static_cast<double>(calibration.views.size());
    std::string out = fmt::format(
        "<svg role=\"img\" aria-label=\"RMS by view\" viewBox=\"0 0 {:.0f} 190\" class=\"chart\">"
        "<text x=\"0\" y=\"18\">{:.2f} px</text><text x=\"0\" y=\"150\">0</text>"
        "<line x1=\"50\" y1=\"150\" x2=\"{:.0f}\" y2=\"150\" stroke=\"#888\"/>",
        width, highest, width);
    for (std::size_t view = 0; view < calibration.views.size(); ++view) {
        const double left = 55 + step * static_cast<double>(view);
        for (std::size_t c = 0; c < cameras; ++c) {
            const auto& rms = calibration.cameras[c].view_rms_px[view];
            if (!rms) continue;
            const double height = 135 * *rms / highest;
            out += fmt::format(
                "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"12\" height=\"{:.1f}\" "
                "class=\"camera{}\"><title>{}, {}: {:.3f} px</title></rect>",
                left + 14 * static_cast<double>(c), 150 - height, height, c,
                html_text(calibration.views[view]), html_text(calibration.cameras[c].name), *rms);
        }
        out += fmt::format(
            "<text transform=\"translate({:.1f},160) rotate(40)\" class=\"small\">{}</text>", left,
            html_text(calibration.views[view]));
    }
    return out + "</svg>";
}

std::string data_uri(const std::vector<std::uint8_t>& png) {
    constexpr std::string_view kLetters =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out = "data:image/png;base64,";
    for (std::size_t i = 0; i < png.size(); i += 3) {
        const std::size_t left = std::min<std::size_t>(3, png.size() - i);
        std::uint32_t bits = static_cast<std::uint32_t>(png[i]) << 16;
        if (left > 1) bits |= static_cast<std::uint32_t>(png[i + 1]) << 8;
        if (left > 2) bits |= png[i + 2];
        for (std::size_t c = 0; c < 4; ++c) {
            out += c <= left ? kLetters[bits >> (18 - 6 * c) & 63] : '=';
        }
    }
    return out;
}

std::string drift_svg(const DriftSeries& drift) {
    double longest = 1e-9;
    double lowest = 0;
    double highest = 0;
    for (const DriftPoint& p : drift.points) {
        longest = std::max(longest, p.time_s);
        lowest = std::min(lowest, 100 * (p.scale - 1));
        highest = std::max(highest, 100 * (p.scale - 1));
    }
    const double span = std::max(0.01, highest - lowest);
    const auto x = [&](double time_s) { return 60 + 390 * time_s / longest; };
    const auto y = [&](double scale) { return 15 + 135 * (highest - 100 * (scale - 1)) / span; };
    std::string out = fmt::format(
        "<svg role=\"img\" aria-label=\"Drift of the depth\" viewBox=\"0 0 460 190\" "
        "class=\"chart\"><text x=\"0\" y=\"18\">{:+.3f} %</text>"
        "<text x=\"0\" y=\"150\">{:+.3f} %</text><text x=\"390\" y=\"175\">{:.0f} s</text>"
        "<line x1=\"60\" y1=\"{:.1f}\" x2=\"450\" y2=\"{:.1f}\" stroke=\"#bbb\"/>",
        highest, highest - span, longest, y(1), y(1));
    for (const DriftPoint& p : drift.points) {
        const std::string temperature =
            p.temperature_c ? fmt::format(", {:.1f} degrees C", *p.temperature_c) : "";
        out += fmt::format(
            "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"2.5\" class=\"camera0\"><title>{:.0f} s: "
            "{:+.4f} % +- {:.4f}, {:.4f} m{}</title></circle>",
            x(p.time_s), y(p.scale), p.time_s, 100 * (p.scale - 1), 100 * p.sigma, p.distance_m,
            temperature);
    }
    if (drift.warm_up) {
        const WarmUp& w = *drift.warm_up;
        out += "<polyline fill=\"none\" stroke=\"#c2622b\" stroke-width=\"1.5\" points=\"";
        for (int i = 0; i <= 100; ++i) {
            const double t = longest * i / 100;
            out += fmt::format("{:.1f},{:.1f} ", x(t),
                               y(w.final_scale * (1 - w.change * std::exp(-t / w.tau_s))));
        }
        out += "\"/>";
    }
    return out + "</svg>";
}

std::string planes_svg(const std::vector<PlaneBand>& planes) {
    double farthest = 1;
    double highest = 1;
    for (const PlaneBand& band : planes) {
        farthest = std::max(farthest, band.distance_m);
        highest = std::max(highest, band.rms_mm);
    }
    std::string out = fmt::format(
        "<svg role=\"img\" aria-label=\"Depth error by distance\" viewBox=\"0 0 460 190\" "
        "class=\"chart\"><text x=\"0\" y=\"18\">{:.1f} mm</text><text x=\"0\" y=\"150\">0</text>"
        "<text x=\"400\" y=\"170\">{:.1f} m</text>"
        "<line x1=\"50\" y1=\"150\" x2=\"450\" y2=\"150\" stroke=\"#888\"/>",
        highest, farthest);
    for (const PlaneBand& band : planes) {
        out += fmt::format(
            "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4\" class=\"camera0\"><title>{:.2f} m: {:.1f} "
            "mm, {} planes</title></circle>",
            50 + 390 * band.distance_m / farthest, 150 - 135 * band.rms_mm / highest,
            band.distance_m, band.rms_mm, band.planes);
    }
    return out + "</svg>";
}

}  // namespace kino
