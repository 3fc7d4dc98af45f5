#pragma once

#include <memory>

#include "sensor/session/byte_source.h"
#include "sensor/source.h"

namespace kino {

/// Plays a bag of librealsense: depth (Z16), colour (RGB8, BGR8, RGBA8, BGRA8, YUYV, UYVY) and the
/// first infrared (Y8, Y16) of the first device with depth. The times of the timeline are those of
/// the recorder; a frame's device_time is the camera's stamp.
[[nodiscard]] Result<std::unique_ptr<Source>> make_bag_source(std::unique_ptr<ByteSource> bytes,
                                                              const std::string& uri);

/// ROS bags of version 2.0.
[[nodiscard]] SourceOpener bag_opener();

}  // namespace kino
