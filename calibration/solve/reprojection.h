#pragma once

#include <glm/vec2.hpp>

#include "calibration/solve/lens_model.h"
#include "calibration/solve/turned_pose.h"

namespace kino {

/// Derivatives of a pixel, rows u and v, in row-major order.
struct ReprojectionJacobian {
    std::array<double, 24> lens;    ///< 2 x 12
    std::array<double, 12> camera;  ///< 2 x 6, by camera_from_first
    std::array<double, 12> board;   ///< 2 x 6, by first_from_board
};

/// A pose made ready for many points.
struct PreparedPose {
    glm::dmat3 rotation;
    glm::dmat3 jacobian;  ///< right_jacobian() of the rotation vector
    glm::dvec3 translation;
};
[[nodiscard]] PreparedPose prepare(const TurnedPose& pose);

/// Where a camera sees a corner of the board: px = lens(camera_from_first * first_from_board *
/// (corner, 0)), with Projection's formula for the lens but without its limits. `camera_from_first`
/// null: this is the first camera. False behind the camera and where the denominator of the
/// rational model is not positive. `jacobian` may be null.
[[nodiscard]] bool reproject(const double* lens, const PreparedPose* camera_from_first,
                             const PreparedPose& first_from_board, const glm::dvec2& corner_m,
                             glm::dvec2& px, ReprojectionJacobian* jacobian);

}  // namespace kino
