#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sensor/kinect1/usb.h"

namespace kino::kinect1 {

/// One Kinect v1: the USB devices behind its built-in hub that belong together.
struct Unit {
    std::optional<usb::DeviceId> camera;  ///< none: it runs without its power supply
    std::optional<usb::DeviceId> motor;
    std::optional<usb::DeviceId> audio;
    std::string serial;  ///< the camera's; the audio part's where the camera says only zeros

    [[nodiscard]] bool is_1414() const;
    [[nodiscard]] std::string model() const;  ///< "1414", "1473", "for Windows"
};

/// Every camera makes a unit, and so does a motor whose hub has no camera.
[[nodiscard]] std::vector<Unit> group_units(const std::vector<usb::DeviceId>& devices);

}  // namespace kino::kinect1
