#pragma once

#include <string>

#include "base/error.h"
#include "sensor/kinect1/camera_mode.h"

namespace kino::kinect1 {

/// What follows "kinect1:" in a URI: `[serial][?color=bayer|bayer-high|yuv][&depth=11|10]`.
struct Address {
    std::string serial;  ///< empty: the first sensor there is
    CameraMode depth = CameraMode::depth_11bit;
    CameraMode color = CameraMode::color_bayer;
};
[[nodiscard]] Result<Address> parse_address(const std::string& text);
/// Defaults are left out; parse_address() of it gives the same again.
[[nodiscard]] std::string to_text(const Address& address);

}  // namespace kino::kinect1
