#pragma once

#include <array>
#include <glm/vec2.hpp>
#include <optional>
#include <vector>

#include "calibration/solve/lens_model.h"
#include "calibration/solve/shots.h"
#include "calibration/solve/turned_pose.h"

namespace kino {

/// What views tell of fx, fy, cx, cy, k1, k2, p1, p2: their normal equations for corners with a
/// noise of one pixel an axis, the board's pose eliminated. Informations of several views add up.
struct LensInformation {
    static constexpr std::size_t kNumbers = 8;
    std::array<double, kNumbers * kNumbers> normal{};  ///< symmetric, row by row

    LensInformation& operator+=(const LensInformation& other);
};

/// Of one view, where a camera with about this lens sees the board at `camera_from_board`.
[[nodiscard]] LensInformation view_information(const std::vector<glm::dvec2>& corners_m,
                                               const std::vector<ShotCorner>& seen,
                                               const Lens& lens, const Pose& camera_from_board);

/// Standard deviations of the eight numbers for corners good to `noise_px` an axis. What any
/// camera's lens obeys is known beforehand (focal length to a third, centre to a tenth of the
/// focal length, |k1| under 0.5, |k2| under 1, |p| under 0.02 or so), so they exist for no view.
[[nodiscard]] std::array<double, LensInformation::kNumbers> expected_deviations(
    const LensInformation& information, const Lens& lens, double noise_px);

/// By which share the deviations fall, on average over the eight, when `view` is added: 0 for a
/// view that says nothing, 0.29 for one that says as much as all before it.
[[nodiscard]] double expected_fall(const LensInformation& before, const LensInformation& view,
                                   const Lens& lens, double noise_px);

}  // namespace kino
