#pragma once

#include <string>
#include <vector>

#include "sensor/v4l2/buffer_decoder.h"
#include "sensor/v4l2/v4l2_address.h"
#include "sensor/v4l2/video_device.h"

namespace kino {

/// What QUERYCAP says of the node itself (device_caps).
struct VideoCapabilities {
    std::string driver;
    std::string card;
    std::string bus;
    bool captures = false;  ///< video, by streaming: what this room needs
    bool multi_planar = false;

    [[nodiscard]] bool is_kinect() const { return driver == "kinect"; }
    [[nodiscard]] bool on_usb() const { return bus.starts_with("usb-"); }
};

/// What was agreed with the driver.
struct VideoMode {
    BufferLayout layout;
    std::size_t buffer_bytes = 0;  ///< sizeimage: what a buffer must hold
    double hz = 0;                 ///< 0: not known
    std::string text;              ///< "Y10B 640x480", for a person
};

[[nodiscard]] Result<VideoCapabilities> query_capabilities(const VideoDevice& device);

/// The pixel formats on offer, in the driver's order, known to this room or not.
[[nodiscard]] Result<std::vector<std::uint32_t>> list_pixel_formats(const VideoDevice& device,
                                                                    bool multi_planar);

/// Chooses format and size by the address (see V4l2Address; best format first), sets them and takes
/// what came back. Fails where the node has no such format, gives another meaning, or is busy.
[[nodiscard]] Result<VideoMode> negotiate(const VideoDevice& device,
                                          const VideoCapabilities& capabilities,
                                          const V4l2Address& wanted);

/// Sets `mode` again, before another start. Fails where something else comes back now.
[[nodiscard]] Result<void> negotiate_again(const VideoDevice& device,
                                           const VideoCapabilities& capabilities,
                                           const V4l2Address& wanted, const VideoMode& mode);

/// 10-bit values of a Kinect's 640x480 picture are disparities; its infrared has other sizes.
[[nodiscard]] StreamKind natural_kind(const VideoFormat& format, bool kinect, int width,
                                      int height);

}  // namespace kino
