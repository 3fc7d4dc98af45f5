#pragma once

#include <vector>

#include "base/time.h"

namespace kino {

/// Measured times of one stage, for a summary.
class TimeSeries {
  public:
    void add(TimeNs time) { times_.push_back(time); }
    [[nodiscard]] std::size_t count() const { return times_.size(); }
    /// Nearest rank, in ms; 0 where nothing was measured. `q` in [0, 1].
    [[nodiscard]] double quantile_ms(double q) const;
    [[nodiscard]] double median_ms() const { return quantile_ms(0.5); }
    [[nodiscard]] double p95_ms() const { return quantile_ms(0.95); }

    /// Share of the measured times of at most `limit`; 1 where nothing was measured.
    [[nodiscard]] double share_within(TimeNs limit) const;

  private:
    std::vector<TimeNs> times_;
};

}  // namespace kino
