#pragma once

#include <array>
#include <functional>
#include <vector>

#include "base/error.h"
#include "calibration/solve/lens_model.h"
#include "calibration/solve/shots.h"
#include "calibration/solve/turned_pose.h"

namespace kino {

/// Everything the joint problem turns: what is known before, and better afterwards.
struct BundleState {
    std::vector<Lens> lenses;        ///< one a camera
    TurnedPose second_from_first{};  ///< only with two cameras
    std::vector<TurnedPose> boards;  ///< first_from_board, one a view
};

/// Which numbers the problem may turn.
struct BundleFreedom {
    std::vector<std::array<bool, 12>> lenses;  ///< by camera
    bool rig = true;
};
[[nodiscard]] BundleFreedom freedom_of(const std::vector<LensModel>& models);

struct BundleOptions {
    /// Corners farther off than this many sigma count linearly (Huber); 0: squared loss throughout.
    double huber_sigmas = 3;
    int max_iterations = 200;
    /// Called after every step with the RMS so far, px.
    std::function<void(int iteration, double rms_px)> progress;
};

struct BundleResult {
    BundleState state;
    double sigma_px = 0;  ///< noise of one coordinate, from the residuals
    int iterations = 0;
};

/// All cameras' lenses, the pose between the two cameras and the boards' poses in one problem
/// (Ceres; analytic derivatives). Fails where the start does not project or the solver finds no
/// minimum.
[[nodiscard]] Result<BundleResult> solve_bundle(const Shots& shots, BundleState start,
                                                const BundleFreedom& freedom,
                                                const BundleOptions& options = {});

/// One corner after the solve.
struct CornerError {
    int view = 0;
    glm::dvec2 px{};     ///< where it was seen
    glm::dvec2 error{};  ///< reprojected minus seen, px
};
/// By camera, in the order of the shots. Corners that do not project are left out.
[[nodiscard]] std::vector<std::vector<CornerError>> corner_errors(const Shots& shots,
                                                                  const BundleState& state);
/// Root of the mean squared length, as OpenCV states it; 0 for none.
[[nodiscard]] double rms_px(const std::vector<CornerError>& errors);

/// Standard deviations of what was free, for corners whose noise is sigma_px an axis and
/// independent; 0 for what was held.
struct BundleDeviations {
    std::vector<std::array<double, 12>> lenses;
    std::array<double, 6> rig{};  ///< rotation vector, rad; translation, m
    /// Free numbers that the views do not determine at all: the normal equations have no inverse
    /// there. "camera.parameter" for messages is up to the caller.
    struct Place {
        std::size_t camera = 0;  ///< the number of cameras: the rig
        std::size_t number = 0;
    };
    std::vector<Place> undetermined;
};
/// From the normal equations at the solution, the boards' poses eliminated; corners weighted as
/// the robust loss weighted them.
[[nodiscard]] BundleDeviations bundle_deviations(const Shots& shots, const BundleResult& result,
                                                 const BundleFreedom& freedom,
                                                 const BundleOptions& options = {});

}  // namespace kino
