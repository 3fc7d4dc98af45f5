#pragma once

#include <string>
#include <string_view>

#include "calibration/solve/calibrate.h"
#include "calibration/solve/drift.h"
#include "calibration/solve/plane_check.h"

namespace kino {

/// Text for HTML: markup characters escaped, bytes that are not UTF-8 replaced.
[[nodiscard]] std::string html_text(std::string_view text);

/// SVG elements for the page. Every corner where it was seen, the colour of its view.
[[nodiscard]] std::string coverage_svg(const CameraResult& camera);
/// Every corner's error as a line from where it was seen, enlarged so that the RMS is a
/// fortieth of the picture's width.
[[nodiscard]] std::string residual_svg(const CameraResult& camera);
/// A bar for every view and camera.
[[nodiscard]] std::string view_rms_svg(const Calibration& calibration);
/// Scale of the depth over time, with the warm-up curve and, where known, the temperature.
[[nodiscard]] std::string drift_svg(const DriftSeries& drift);
/// "data:image/png;base64,..".
[[nodiscard]] std::string data_uri(const std::vector<std::uint8_t>& png);
/// Plane error over distance.
[[nodiscard]] std::string planes_svg(const std::vector<PlaneBand>& planes);

}  // namespace kino
