#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/camera_model.h"
#include "base/error.h"

namespace kino {

/// A camera as other programs' files hold it.
struct NamedCamera {
    std::string name;
    CameraModel camera;
    friend bool operator==(const NamedCamera&, const NamedCamera&) = default;
};

/// ROS sensor_msgs/CameraInfo as camera_calibration_parsers writes it: image size, camera_matrix,
/// distortion_model plumb_bob (k1 k2 p1 p2 k3) or rational_polynomial (and k4 k5 k6), identity
/// rectification, projection_matrix. Numbers are written with as many digits as give the same
/// number back. The reader takes what this writes and what ROS writes; rectification and projection
/// are not read. Fails where a key is missing, a size is wrong, or the camera is not valid.
[[nodiscard]] std::string ros_camera_info(const NamedCamera& camera);
[[nodiscard]] Result<NamedCamera> read_ros_camera_info(std::string_view text,
                                                       const std::string& where);

/// What an OpenCV FileStorage YAML may hold of a calibration.
struct OpenCvCalibration {
    std::vector<NamedCamera> cameras;  ///< 1 or 2
    std::optional<Pose> second_from_first;
};

/// One camera: image_width, image_height, camera_matrix, distortion_coefficients, as OpenCV's
/// sample `calibration` writes. Two: size1, M1, D1, size2, M2, D2, R, T (metres), as
/// `stereo_calib`.
[[nodiscard]] std::string opencv_yaml(const OpenCvCalibration& calibration);
/// Reads these and the names that Kinect tools use (K, dist, img_size; cameraMatrix,
/// distortionCoefficients; depth_intrinsics, depth_distortion, depth_size, rgb_..., R, T).
/// Distortion with 4, 5, 8 numbers, or more whose rest is 0. Files without a picture size need
/// `size_if_missing` (width, height). A T of unit vector size or in millimetres is not noticed.
[[nodiscard]] Result<OpenCvCalibration> read_opencv_yaml(
    std::string_view text, const std::string& where,
    std::optional<std::pair<int, int>> size_if_missing = std::nullopt);

/// One line of the TUM RGB-D tools: fx fy cx cy k1 k2 p1 p2 k3, after a comment that names them
/// and states the size. Fails for a rational model, which the format cannot hold.
[[nodiscard]] Result<std::string> tum_intrinsics(const NamedCamera& camera);
/// Takes four numbers (no distortion) to nine; the size from the comment or `size_if_missing`.
[[nodiscard]] Result<NamedCamera> read_tum_intrinsics(
    std::string_view text, const std::string& where,
    std::optional<std::pair<int, int>> size_if_missing = std::nullopt);

}  // namespace kino
