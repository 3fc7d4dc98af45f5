#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "viz/quality/zoom/zoom_choice.h"

namespace kino {

struct WorkCostOptions {
    double forgetting = 0.98;  ///< of what a frame taught, from one frame to the next
    double ridge = 1e-6;       ///< of the covariance's trace, added to its diagonal
    /// The covariance is held below its start times this: without anything new to learn it grows.
    double most_growth = 10;
};

/// Predicts a frame's time from counted work, t = sum of a_i x_i, and learns the a_i by recursive
/// least squares with forgetting (Ljung, "System Identification", 11.2). Costs are not negative.
class WorkCostModel {
  public:
    /// Costs per unit of each feature, from a calibration run: where learning starts, and the scale
    /// of each, so none may be 0.
    explicit WorkCostModel(std::vector<double> start_ms, const WorkCostOptions& options = {});

    [[nodiscard]] double predict_ms(std::span<const double> work) const;
    /// A frame did `work` in `ms`. What is no number teaches nothing.
    void learn(std::span<const double> work, double ms);
    [[nodiscard]] std::vector<double> costs_ms() const;  ///< per unit

  private:
    void bound();

    WorkCostOptions options_;
    std::size_t n_;
    std::vector<double> scale_;       ///< a feature times its scale is of the order of 1 ms
    std::vector<double> cost_;        ///< in units of the scale
    std::vector<double> covariance_;  ///< n x n
};

/// What a frame will do, counted before it is drawn.
struct ZoomWork {
    double vertices = 0, triangles = 0, draws = 0;
    std::vector<double> pixels;  ///< of each material or kind, at z = 1
};

/// Start costs, ms a unit.
struct ZoomWorkCosts {
    double frame = 1, vertex = 1e-4, triangle = 2e-4, draw = 5e-3, copy = 1;
    std::vector<double> pixel{1e-4};  ///< of each material
};

/// Chooses before a frame is drawn: the smallest z whose predicted time is within the target, of
/// those that pay (ZoomRules).
class PredictiveZoom {
  public:
    PredictiveZoom(const ZoomRules& rules, const ZoomWorkCosts& start,
                   const WorkCostOptions& options = {});
    ZoomChoice choose(const ZoomWork& work);
    /// What the frame that was chosen for took.
    void frame_took(double ms);
    /// As choose() and frame_took() at a given zoom: calibration runs.
    void learn(const ZoomWork& work, int z, double ms);
    /// Passes at `z` that were measured on their own did this part of a frame's work.
    void part_took(const ZoomWork& part, int z, double ms);
    /// Enlarging took this, measured on its own.
    void copy_took(double ms);
    [[nodiscard]] double predict_ms(const ZoomWork& work, int z) const;
    [[nodiscard]] const WorkCostModel& model() const { return model_; }

  private:
    [[nodiscard]] std::vector<double> features(const ZoomWork& work, int z) const;

    ZoomRules rules_;
    ZoomRelease release_;
    std::size_t materials_;
    WorkCostModel model_;
    ZoomWork work_;
    int z_ = 1;
};

}  // namespace kino
