#pragma once

#include <vector>

#include "base/error.h"
#include "calibration/solve/bundle.h"

namespace kino {

/// How well a lens model does on views that it was not fitted to.
struct LensScore {
    LensModel model = LensModel::pinhole;
    double fit_px = 0;                 ///< RMS on the views it was fitted to (all of them)
    double held_out_px = 0;            ///< RMS on held-out corners of held-out views
    std::vector<double> view_squares;  ///< mean squared held-out error of each view, px^2
};

/// Cross-validation by views: the views are dealt into `folds`, each is left out once. In a view
/// left out the board's pose comes from every other corner and the error from the rest, then the
/// other way round, so that no corner judges a number it helped to find.
[[nodiscard]] Result<LensScore> held_out(const Shots& one_camera, LensModel model, int folds,
                                         const BundleOptions& options = {});

/// The same measure for any lens that `fit` makes of the views it is given: for rivals.
[[nodiscard]] Result<LensScore> held_out(
    const Shots& one_camera, int folds,
    const std::function<Result<Lens>(const Shots& training)>& fit);

/// The simplest model whose held-out squares are not above the best one's by more than one
/// standard error of their difference over the views. The scores must be of the same views.
[[nodiscard]] LensModel choose(const std::vector<LensScore>& scores);

}  // namespace kino
