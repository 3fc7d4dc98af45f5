#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/body.h"
#include "base/image.h"
#include "base/pose.h"
#include "base/time.h"

namespace kino {

/// What every frame carries, whoever made it.
struct FrameHeader {
    TimeNs device_time = 0;  ///< unwrapped device clock
    TimeNs host_time = 0;    ///< the same moment on the host clock
    std::int64_t sequence = 0;
    std::int64_t lost_before = 0;  ///< frames that never arrived between this and the last one
};

/// Rows [first, first + count) of a frame.
struct RowRange {
    int first = 0;
    int count = 0;
    friend bool operator==(const RowRange&, const RowRange&) = default;
};

enum class DepthUnit : std::uint8_t {
    linear,  ///< raw * metres_per_unit, 0 = no reading
    /// Kinect v1 shift in 11 bits, larger is farther, 2047 = no reading. A device in 10-bit mode
    /// gives twice its count, and 2047 for 1023.
    kinect_disparity11
};

/// Depth as the device or file gave it: raw units, row 0 on top, unmirrored.
struct DepthFrame {
    FrameHeader header;
    Image<std::uint16_t> raw;
    DepthUnit unit = DepthUnit::linear;
    double metres_per_unit = 0.001;  ///< for DepthUnit::linear
    /// Rows with pixels that never arrived; those pixels hold "no reading". Rising, apart.
    std::vector<RowRange> damaged_rows;
};

enum class PixelFormat : std::uint8_t { rgba8, rgb8, gray8, bayer_grbg8, uyvy, yuyv, mjpeg };

enum class YuvMatrix : std::uint8_t { bt601, bt709 };
enum class YuvRange : std::uint8_t { full, limited };

/// Colour as delivered; sensor/color_conversion.h turns it into Rgba8. sRGB-encoded throughout.
struct ColorFrame {
    FrameHeader header;
    PixelFormat format = PixelFormat::rgba8;
    int width = 0;   ///< px
    int height = 0;  ///< px
    int pitch = 0;   ///< bytes from row to row; 0 for mjpeg
    YuvMatrix matrix = YuvMatrix::bt601;
    YuvRange range = YuvRange::full;
    std::vector<std::uint8_t> bytes;
    std::vector<RowRange> damaged_rows;  ///< rows with bytes that never arrived, which are 0
};

struct InfraredFrame {
    FrameHeader header;
    Image<std::uint16_t> raw;  ///< brightness, device units
    int significant_bits = 10;
    std::vector<RowRange> damaged_rows;  ///< rows with pixels that never arrived, which are 0
};

/// What the device feels and how it holds itself.
struct MotionFrame {
    FrameHeader header;
    /// Specific force in depth camera axes, m/s^2: a device at rest reads 9.8 against gravity.
    std::array<double, 3> acceleration_m_s2{};
    std::optional<double> tilt_deg;  ///< of the motor, upwards; none while it moves
};

enum class PoseOrigin : std::uint8_t {
    none,           ///< not known: world_from_camera_axes()
    trajectory,     ///< given with the recording
    floor,          ///< fitted to the floor
    accelerometer,  ///< gravity from the device
};

/// What belongs to one moment. Frames are immutable once published and shared by count. A stream
/// that is not subscribed, or has nothing near in time, is null.
struct FrameSet {
    std::int64_t index = 0;  ///< position on the timeline, or a running count for live devices
    TimeNs time = 0;         ///< host time of the leading (depth) frame
    std::shared_ptr<const DepthFrame> depth;
    std::shared_ptr<const ColorFrame> color;
    std::shared_ptr<const InfraredFrame> infrared;
    std::shared_ptr<const BodyFrame> bodies;
    std::shared_ptr<const MotionFrame> motion;
    bool color_paired = false;  ///< colour lies within the pairing limit of the depth frame
    Pose world_from_depth = world_from_camera_axes();
    PoseOrigin pose_origin = PoseOrigin::none;
};

}  // namespace kino
