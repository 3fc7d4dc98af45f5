#pragma once

#include <filesystem>
#include <string>

#include "base/camera_model.h"
#include "base/error.h"
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

[[nodiscard]] Result<void> write_outputs(const Outputs& outputs, const Report& report,
                                         const RigParameters& rig);

}  // namespace kino
