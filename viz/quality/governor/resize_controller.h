#pragma once

#include <array>
#include <cstddef>
#include <deque>

#include "viz/quality/governor/cost_model.h"

namespace kino {

struct ResizeOptions {
    double target_ms = 1000.0 / 30;
    double r_min = 1;
    double r_max = 8;
    double r_start = 1;
    /// Frames between drawing and knowing how long it took; 0 where the frame waits for its fence.
    int delay = 0;
    /// Time at r = 1 beyond what r does not change, ms: where the estimate starts.
    double initial_cost_ms = 100;
    bool learn = true;  ///< false: initial_cost_ms is taken as K' itself
    double dead_band = 0.03;
    /// r moves by at most this, or by this share of itself, whichever is more; `emergency_step`
    /// where a frame took more than twice the target.
    double max_step = 0.2;
    double max_relative_step = 0.15;
    double emergency_step = 1;
    /// r() is a multiple of it; 0: not quantised. At r = 1 a sixteenth would be 11 % of the time.
    double quantum = 1.0 / 32;
    bool reject_outliers = true;
};

/// Holds a frame time by the resizing factor r: shaded pixels fall as u = 1 / r^2 and the time is
/// t = K u + C, so u += (target - t) / K' is an integral controller (Yang, Sander, Lawrence 2008
/// and the talk's slides). With the time known d frames late it is stable for
/// K / K' < 2 sin(pi / (2 (2 d + 1))) and does not overshoot up to K / K' = d^d / (d + 1)^(d + 1).
class ResizeController {
  public:
    explicit ResizeController(const ResizeOptions& options);

    [[nodiscard]] double r() const;
    /// Starts a frame; returns r().
    double begin_frame();
    /// Tells how long the oldest frame took whose time was not told yet. `says_nothing`: pipelines
    /// were made, the picture cut or was resized.
    void frame_took(double ms, bool says_nothing = false);
    void set_target(double ms) { options_.target_ms = ms; }

    /// The plant as estimated: ms for all pixels, ms for the rest.
    [[nodiscard]] double cost_ms() const { return model_.slope(); }
    [[nodiscard]] double rest_ms() const { return model_.offset(); }

  private:
    [[nodiscard]] bool is_outlier(double ms) const;
    void move_to(double u, double step_limit);

    ResizeOptions options_;
    CostModel model_;
    double r_;
    std::deque<double> drawn_u_;  ///< of frames whose times are not known yet, oldest first
    std::deque<double> recent_ms_;
};

/// Largest K / K' at which times known `delay` frames late still settle.
[[nodiscard]] double stability_bound(int delay);
/// Largest K / K' without overshoot.
[[nodiscard]] double no_overshoot_bound(int delay);

}  // namespace kino
