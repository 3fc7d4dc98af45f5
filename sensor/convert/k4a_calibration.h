#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "base/camera_model.h"
#include "base/error.h"

namespace kino {

/// How a mode of an Azure Kinect cuts its picture out of the calibrated one: scaled to `binned`,
/// then `output` from (crop_x, crop_y) on.
struct K4aMode {
    const char* name;  ///< as in K4A_DEPTH_MODE, or the end of K4A_COLOR_MODE
    int binned_width, binned_height;
    int crop_x, crop_y;
    int width, height;
};

/// Null for sizes that no mode has.
[[nodiscard]] const K4aMode* k4a_depth_mode(int width, int height);
[[nodiscard]] const K4aMode* k4a_color_mode(int width, int height);

struct PixelSize {
    int width = 0;
    int height = 0;
};

/// The rig of the calibration.json that an Azure Kinect carries, for pictures of these sizes.
/// Cameras there are in units of the picture with (0, 0) at its corner, 14 parameters in the order
/// cx cy fx fy k1..k6 codx cody p2 p1; Rt of the colour camera is color_from_depth, metres. Fails
/// for sizes of no mode, for other models than Brown-Conrady in its two spellings, and for what
/// validate() refuses.
[[nodiscard]] Result<RigParameters> rig_from_k4a(std::string_view json, PixelSize depth,
                                                 std::optional<PixelSize> color,
                                                 const std::string& where);

/// The inverse, for pictures that a mode exists for; no k4a calibration holds others. Exact to the
/// digits written: reading it and writing it again gives the same text. Against `rig` itself the
/// last digit of a focal length, centre or the rotation may differ, where no number of the file
/// gives it; for the numbers of a factory's file, which are floats, none does but the rotation's.
[[nodiscard]] Result<std::string> rig_to_k4a(const RigParameters& rig);

/// accelerometer_from_depth of a calibration.json; none where it is not stated.
[[nodiscard]] std::optional<Pose> k4a_accelerometer(std::string_view json);

/// What an Azure Kinect is like, where a file brings no calibration of its own.
[[nodiscard]] RigParameters typical_k4a_rig(PixelSize depth, std::optional<PixelSize> color);

}  // namespace kino
