#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "base/camera_model.h"
#include "base/error.h"
#include "base/frame.h"
#include "calibration/depth_bias.h"
#include "calibration/report/report.h"

namespace kino {

/// Where the result goes; empty paths are not written.
struct Outputs {
    std::filesystem::path rig;     ///< own JSON
    std::filesystem::path report;  ///< folder
    std::filesystem::path ros;     ///< folder: NAME.yaml for each camera
    std::filesystem::path opencv;  ///< YAML
    std::filesystem::path k4a;     ///< JSON
    std::filesystem::path tum;     ///< folder: NAME.txt for each camera
};

/// The first camera as the depth camera (its principal point moved by `depth_shift_px`, the place
/// of the depth image in the infrared one), the second as the colour camera. All else stays as in
/// `base`.
[[nodiscard]] RigParameters rig_of(const Calibration& calibration, RigParameters base,
                                   const glm::dvec2& depth_shift_px);

/// The bias, if there is one, goes beside the rig's file (bias_file_beside()); one of an earlier
/// calibration that lies there goes away with it.
[[nodiscard]] Result<void> write_outputs(const Outputs& outputs, const Report& report,
                                         const RigParameters& rig,
                                         const std::optional<DepthBias>& bias);

/// As above, for the bias alone.
[[nodiscard]] Result<void> write_bias_beside(const std::filesystem::path& rig_file,
                                             const std::optional<DepthBias>& bias,
                                             const std::string& serial);

/// Depth over colour as `before` and as `after` put it, into the report. Nothing where one of them
/// has no colour camera of the picture's size.
void add_overlays(const DepthFrame& depth, const ColorFrame& color, const RigParameters& before,
                  const RigParameters& after, Report& report);

}  // namespace kino
