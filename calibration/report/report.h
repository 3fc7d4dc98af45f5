#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/error.h"
#include "calibration/solve/calibrate.h"
#include "calibration/solve/plane_check.h"

namespace kino {

/// A calibration and what was told on the way to it.
struct Report {
    std::string title;               ///< what was calibrated, for a person
    std::string board;               ///< board_text()
    std::vector<std::string> notes;  ///< of the pictures: no board seen, blurred
    Calibration calibration;
    std::vector<PlaneBand> planes;  ///< depth error by distance; empty: no depth was looked at
};

/// Everything as one JSON object, "kinoscope_calibration_report": 1. Lengths of poses in metres,
/// rotations as quaternions w, x, y, z; numbers carry value, sigma, unit and held.
[[nodiscard]] std::string report_json(const Report& report);

/// One HTML page that asks for nothing else: styles and SVG pictures are in it, scripts are none.
/// RMS by view and camera, residual vectors, coverage, every number with its deviation, the
/// held-out error of the lens models, depth error by distance, notes.
[[nodiscard]] std::string report_html(const Report& report);

/// report.html and report.json in `folder`, which is made if it is not there.
[[nodiscard]] Result<void> write_report(const std::filesystem::path& folder, const Report& report);

}  // namespace kino
