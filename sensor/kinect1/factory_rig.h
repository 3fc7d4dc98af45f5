#pragma once

#include <string>

#include "base/camera_model.h"
#include "sensor/kinect1/camera_mode.h"
#include "sensor/kinect1/factory_data.h"

namespace kino::kinect1 {

/// The rig by the device's own calibration: depth is a pinhole camera of focal length R/(2p) with
/// its principal point in the middle, as the factory's tables take it to be; the colour camera and
/// the pose are fitted to the registration tables. `rig.note` states the residual. Where the
/// tables are missing or no camera comes near them (worse than 1 px rms, 4 px at worst),
/// default_kinect1_rig() with the device's disparity parameters, and the note says so.
///
/// `color`: the mode of the colour stream. 1280x1024 is taken to show 32 more lines above and
/// below what 640x480 shows at half the size.
[[nodiscard]] RigParameters factory_rig(const FactoryData& data, CameraMode color,
                                        const std::string& serial);

}  // namespace kino::kinect1
