#pragma once

#include <span>
#include <string>
#include <vector>

#include "base/camera_model.h"
#include "base/error.h"
#include "calibration/files/plain_yaml.h"

namespace kino {

/// The numbers of a matrix node {rows, cols, data}: all of `data`, whose count must be rows x cols.
[[nodiscard]] Result<std::vector<double>> matrix_numbers(const YamlNode& node,
                                                         const std::string& where);
/// A whole number from `least` to `most`.
[[nodiscard]] Result<int> whole_number(const YamlNode& node, int least, int most,
                                       const std::string& where);

/// fx, fy, cx, cy of a 3 x 3 camera matrix (row-major); fails where it is not one.
[[nodiscard]] Result<void> set_matrix(CameraModel& camera, const std::vector<double>& matrix,
                                      const std::string& where);
/// Distortion in OpenCV's order, 4, 5 or 8 numbers; more (thin prism, tilt) only if they are 0.
[[nodiscard]] Result<void> set_distortion(CameraModel& camera, const std::vector<double>& numbers,
                                          const std::string& where);
/// The shortest of these lengths that holds the camera's distortion: 5 or 8 numbers.
[[nodiscard]] std::vector<double> distortion_numbers(const CameraModel& camera);

/// "1, 0.5, -3e-05": digits that give the same doubles back.
[[nodiscard]] std::string joined_numbers(std::span<const double> numbers);

}  // namespace kino
