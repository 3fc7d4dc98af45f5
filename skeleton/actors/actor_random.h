#pragma once

#include <cmath>
#include <numbers>

#include "skeleton/forest/training_random.h"

namespace kino {

/// Draws for actors: whatever is asked depends on the key and on what was asked before alone.
class ActorRandom : public TrainingRandom {
  public:
    using TrainingRandom::TrainingRandom;

    double in(double lo, double hi) { return lo + (hi - lo) * unit(); }
    bool chance(double p) { return unit() < p; }
    /// Normal, cut at three standard deviations (Box-Muller).
    double normal(double mean, double sigma) {
        const double r = std::sqrt(-2 * std::log(1 - unit()));
        const double x = r * std::cos(2 * std::numbers::pi * unit());
        return mean + sigma * std::fmin(std::fmax(x, -3.0), 3.0);
    }
};

}  // namespace kino
