#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/image.h"
#include "calibration/solve/calibrate.h"
#include "calibration/solve/drift.h"
#include "calibration/solve/plane_check.h"

namespace kino {

/// A picture in the report, kept as the bytes of a PNG.
struct ReportPicture {
    std::string caption;
    int width = 0;  ///< px
    int height = 0;
    std::vector<std::uint8_t> png;
};
[[nodiscard]] Result<ReportPicture> report_picture(std::string caption, const Image<Rgba8>& image);

/// A calibration and what was told on the way to it.
struct Report {
    std::string title;               ///< what was calibrated, for a person
    std::string board;               ///< board_text()
    std::vector<std::string> notes;  ///< of the pictures: no board seen, blurred
    Calibration calibration;
    std::vector<PlaneBand> planes;  ///< depth error by distance; empty: no depth was looked at
    std::vector<ReportPicture> overlays{};  ///< depth over colour: before, after
    std::optional<DriftSeries> drift{};     ///< of a long recording
};

/// Everything as one JSON object, "kinoscope_calibration_report": 1. Lengths of poses in metres,
/// rotations as quaternions w, x, y, z; numbers carry value, sigma, unit and held.
[[nodiscard]] std::string report_json(const Report& report);

/// One HTML page that asks for nothing else: styles and SVG pictures are in it, scripts are none.
/// RMS by view and camera, residual vectors, coverage, every number with its deviation, the
/// held-out error of the lens models, depth error by distance, drift, depth over colour, notes.
/// Pictures are data URIs. A report without cameras holds what there is.
[[nodiscard]] std::string report_html(const Report& report);

/// For a person: how far the depth drifted.
[[nodiscard]] std::string drift_text(const DriftSeries& drift);

/// report.html and report.json in `folder`, which is made if it is not there.
[[nodiscard]] Result<void> write_report(const std::filesystem::path& folder, const Report& report);

}  // namespace kino
