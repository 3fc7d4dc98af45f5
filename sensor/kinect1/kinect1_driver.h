#pragma once

#include <memory>

#include "sensor/kinect1/usb.h"
#include "sensor/live/device.h"
#include "sensor/source.h"

namespace kino {

/// Kinect v1 (Xbox 360 models 1414 and 1473, Kinect for Windows) over USB, without any of the
/// vendor's software: `kinect1:[serial][?color=bayer|bayer-high|yuv&depth=11|10]`. Streams: depth
/// in raw disparity (11 bits unless depth=10 asks for the ten-bit mode), colour (Bayer 640x480 at
/// 30 Hz, 1280x1024 at 10 Hz, or UYVY 640x480 at 15 Hz), infrared 640x488 in ten bits, not
/// together with colour, and motion at 10 Hz where the model lets us.
///
/// Tilt, light and accelerometer are those of model 1414. The later ones drive them by their audio
/// part, which works only with a firmware that must not be passed on: everything else works there,
/// and info().note and the controls say why these do not.
///
/// `bus`: where to look for devices; null for usb::libusb_bus().
[[nodiscard]] DeviceDriver kinect1_driver(std::shared_ptr<usb::Bus> bus = nullptr);

/// The same as a source that survives unplugging (sensor/live/live_source.h).
[[nodiscard]] SourceOpener kinect1_opener();

}  // namespace kino
