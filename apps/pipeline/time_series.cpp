#include "apps/pipeline/time_series.h"

#include <algorithm>
#include <cmath>

namespace kino {

double TimeSeries::quantile_ms(double q) const {
    if (times_.empty()) return 0;
    std::vector<TimeNs> sorted = times_;
    std::sort(sorted.begin(), sorted.end());
    const auto rank =
        static_cast<std::size_t>(std::max(1.0, std::ceil(q * static_cast<double>(sorted.size()))));
    return to_ms(sorted[std::min(rank, sorted.size()) - 1]);
}

double TimeSeries::share_within(TimeNs limit) const {
    if (times_.empty()) return 1;
    const auto within =
        std::count_if(times_.begin(), times_.end(), [limit](TimeNs time) { return time <= limit; });
    return static_cast<double>(within) / static_cast<double>(times_.size());
}

}  // namespace kino
