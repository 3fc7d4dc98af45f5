#pragma once

#include <glm/vec3.hpp>
#include <span>

namespace kino {

struct LagAndResidual {
    double lag_s = 0;           ///< positive: `filtered` is late
    double residual_rms_m = 0;  ///< |filtered(t) - truth(t - lag)|, RMS over time
    double correlation = 0;     ///< at that lag, -1..1; 0 where one of the two never moves
};

/// How late a filtered track is: the lag with the highest normalised cross-correlation of the two
/// (their means removed, the three axes summed), between samples by a parabola through the three
/// highest; and what is left over once that lag is taken out. Both are sampled every dt_s > 0 and
/// equally long; lags of at most max_lag_s in both directions are tried, and as much is left out at
/// both ends. Where the truth stands still there is no lag: 0, and the residual is the jitter.
[[nodiscard]] LagAndResidual measure_lag(std::span<const glm::dvec3> truth,
                                         std::span<const glm::dvec3> filtered, double dt_s,
                                         double max_lag_s = 0.5);

/// RMS distance from the mean, m: the jitter of a joint that stands still. 0 without samples.
[[nodiscard]] double rms_about_mean_m(std::span<const glm::dvec3> track);

}  // namespace kino
