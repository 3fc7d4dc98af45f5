#pragma once

#include "sensor/live/device.h"
#include "sensor/source.h"

namespace kino {

/// Devices by OpenNI2 (package libopenni2-0, loaded when first asked for; without it the list is
/// empty and opening says what to install). "openni2:[uri][?registration=on]": the uri is one of
/// the list's, or serial=number, or empty for the first; "sync=off" lets depth and colour run on
/// their own.
[[nodiscard]] DeviceDriver openni2_driver();
[[nodiscard]] SourceOpener openni2_opener();

/// ONI files (content "NI10", versions 1.0.0.5 to 1.0.1.0; depth and colour, not infrared). They
/// need no library: sensor/openni2/oni_frames.h says why they do not go through it.
[[nodiscard]] SourceOpener oni_opener();

}  // namespace kino
