#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "base/camera_model.h"
#include "base/time.h"

namespace kino {

/// sensor_msgs/Image; the pixels are the message's own bytes.
struct RosImage {
    std::uint32_t sequence = 0;
    TimeNs stamp = 0;
    int width = 0;
    int height = 0;
    std::string encoding;
    bool big_endian = false;
    std::size_t step = 0;  ///< bytes from row to row
    std::span<const std::uint8_t> data;
};
/// None where the bytes are no such message, a side is 0 or beyond 16384, or the rows do not fit.
[[nodiscard]] std::optional<RosImage> read_ros_image(std::span<const std::uint8_t> bytes);

/// sensor_msgs/CameraInfo as librealsense writes it: a model by name, coefficients k1 k2 p1 p2 k3.
struct RosCamera {
    CameraModel camera;
    std::string model;
};
[[nodiscard]] std::optional<RosCamera> read_ros_camera(std::span<const std::uint8_t> bytes);

/// geometry_msgs/Transform: librealsense's stream_from_reference.
[[nodiscard]] std::optional<Pose> read_ros_transform(std::span<const std::uint8_t> bytes);

/// diagnostic_msgs/KeyValue.
[[nodiscard]] std::optional<std::pair<std::string, std::string>> read_ros_key_value(
    std::span<const std::uint8_t> bytes);

/// std_msgs/Float32 as the shortest decimal number of those bits: 0.001, not 0.0010000000475.
[[nodiscard]] std::optional<double> read_ros_float(std::span<const std::uint8_t> bytes);

}  // namespace kino
