#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/camera_model.h"
#include "base/error.h"
#include "calibration/solve/bundle.h"
#include "calibration/solve/lens_choice.h"
#include "calibration/solve/shots.h"

namespace kino {

struct CalibrateOptions {
    /// To choose from by held-out error; a single one is taken as it is.
    std::vector<LensModel> models = {kLensModels.begin(), kLensModels.end()};
    int folds = 5;
    BundleOptions bundle;
    /// One line about what is being done.
    std::function<void(std::string_view)> progress;
};

/// One number of the result. Held ones were not determined by the views and kept their plain value.
struct SolvedNumber {
    std::string name;
    double value = 0;
    double sigma = 0;  ///< standard deviation, 0 if held
    std::string unit;
    bool held = false;
};

struct CameraResult {
    std::string name;
    CameraModel camera;
    LensModel model = LensModel::pinhole;
    std::vector<SolvedNumber> numbers;
    std::vector<LensScore> scores;  ///< of every model tried; empty where one was given
    double rms_px = 0;
    std::vector<std::optional<double>> view_rms_px;  ///< none where this camera did not see it
    std::vector<CornerError> errors;
    double coverage = 0;  ///< share of the picture's fields with a corner
};

struct Calibration {
    std::vector<CameraResult> cameras;
    Pose second_from_first;          ///< with two cameras
    std::vector<SolvedNumber> rig;   ///< its six numbers, degrees and mm; empty with one camera
    std::vector<std::string> views;  ///< those that were used
    std::vector<Pose> first_from_board;
    std::vector<std::string> notes;  ///< views left out, numbers held, and why
    double rms_px = 0;
    double sigma_px = 0;  ///< noise of a corner's coordinate
    int iterations = 0;
};

/// The whole way: checks (view_checks.h, pair_checks.h), lens models by held-out error, the joint
/// solve, what the views do not determine held, standard deviations. A number is held where its
/// deviation is above kHeldAbove (with the focal length and principal point: an error instead, for
/// nothing is left without them).
[[nodiscard]] Result<Calibration> calibrate(const Shots& shots,
                                            const CalibrateOptions& options = {});

/// Largest deviation with which a distortion number still says something, in Lens' order; focal
/// length and principal point as a share of the focal length.
constexpr std::array<double, 12> kHeldAbove = {0.05, 0.05, 0.1, 0.1, 1,  5,
                                               0.05, 0.05, 10,  5,   10, 10};

}  // namespace kino
