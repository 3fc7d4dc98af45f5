#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>

#include "base/camera_model.h"

namespace kino::reference {

/// Pinhole with Brown-Conrady distortion, straight from the formulas in OpenCV's documentation of
/// its camera model, in double, sharing nothing with calibration/. Slow: every call searches anew.

/// Distorted position of the ray (x, y, 1), wherever it points.
[[nodiscard]] glm::dvec2 distort(const CameraModel& camera, const glm::dvec2& ray);

/// Radius at z = 1 up to which the distortion is one-to-one by a scan of its numerical derivative
/// over a circle of directions; infinity without distortion, 20 if it never folds.
[[nodiscard]] double fold_radius(const CameraModel& camera);

/// Camera space to pixels; none behind the camera or beyond `max_radius`.
[[nodiscard]] std::optional<glm::dvec2> project(const CameraModel& camera, double max_radius,
                                                const glm::dvec3& point);

/// Pixel to ray at z = 1 by damped descent on the distance to the wanted position; none where no
/// ray within `max_radius` gets within 1e-9.
[[nodiscard]] std::optional<glm::dvec2> unproject(const CameraModel& camera, double max_radius,
                                                  const glm::dvec2& pixel);

}  // namespace kino::reference
