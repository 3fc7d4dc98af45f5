#pragma once

#include <memory>

#include "sensor/live/device.h"
#include "sensor/source.h"
#include "sensor/v4l2/video_system.h"

namespace kino {

/// Cameras of the kernel's video4linux: Kinects by gspca_kinect, depth cameras and webcams by
/// uvcvideo, and any other that gives a format of sensor/v4l2/video_format.h. Addresses are those
/// of sensor/v4l2/v4l2_address.h. Nodes that are no cameras are not listed.
[[nodiscard]] DeviceDriver v4l2_driver(std::shared_ptr<VideoSystem> system = real_video_system());

/// "v4l2:..." as a source that outlives unplugging. "v4l2:a+v4l2:b" is not this opener's.
[[nodiscard]] SourceOpener v4l2_opener(std::shared_ptr<VideoSystem> system = real_video_system());

}  // namespace kino
