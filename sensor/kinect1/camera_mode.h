#pragma once

#include <cstdint>
#include <string>

#include "sensor/kinect1/camera_commands.h"
#include "sensor/kinect1/packet_assembler.h"
#include "sensor/source.h"

namespace kino::kinect1 {

/// What the camera can be told to send. Depth has an endpoint of its own; all others share one.
enum class CameraMode : std::uint8_t {
    depth_11bit,       ///< 640x480, 30 Hz
    depth_10bit,       ///< 640x480, 30 Hz
    color_bayer,       ///< 640x480, 30 Hz, GRBG
    color_bayer_high,  ///< 1280x1024, about 10 Hz, GRBG
    color_yuv,         ///< 640x480, 15 Hz, UYVY
    infrared           ///< 640x488, 30 Hz, ten bits packed
};

struct ModeTraits {
    StreamKind kind = StreamKind::depth;
    int width = 0;
    int height = 0;
    double nominal_hz = 0;
    int bits_per_pixel = 0;    ///< on the wire, without padding
    int pixels_per_group = 1;  ///< that share bytes beyond their own: UYVY pairs
    std::uint8_t endpoint = 0;
    int packet_bytes = 0;     ///< largest, with its header
    const char* format = "";  ///< for a person
};
[[nodiscard]] const ModeTraits& traits(CameraMode mode);
[[nodiscard]] PacketLayout packet_layout(CameraMode mode);

/// Rate of the device time in the packets. Stated nowhere officially; 60 MHz in OpenNI's driver.
constexpr double kTicksPerSecond = 60e6;

/// Registers in the order in which all known drivers write them. The transfers must be waiting
/// before: the camera sends from the first register on.
[[nodiscard]] usb::Outcome<void> switch_on(CameraCommands& commands, CameraMode mode);
/// As much of it as works, in at most a quarter of a second.
void switch_off(CameraCommands& commands, CameraMode mode);

}  // namespace kino::kinect1
