#include "sensor/pairing.h"

#include <algorithm>
#include <cstdlib>
#include <vector>

namespace kino {

TimeNs median_distance(std::span<const TimeNs> times) {
    if (times.size() < 2) return kNsPerSecond / 30;
    std::vector<TimeNs> distances(times.size() - 1);
    for (std::size_t i = 0; i + 1 < times.size(); ++i) distances[i] = times[i + 1] - times[i];
    const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
    std::nth_element(distances.begin(), middle, distances.end());
    return *middle;
}

TimeNs pairing_limit(std::span<const TimeNs> times) {
    return std::max(median_distance(times) / 2, kMinPairingLimit);
}

std::optional<std::size_t> nearest_in_time(std::span<const TimeNs> times, TimeNs time) {
    if (times.empty()) return std::nullopt;
    const auto after = std::lower_bound(times.begin(), times.end(), time);
    if (after == times.begin()) return 0;
    const auto index = static_cast<std::size_t>(after - times.begin());
    if (after == times.end()) return index - 1;
    return time - times[index - 1] <= times[index] - time ? index - 1 : index;
}

std::optional<Pairing> pair_in_time(std::span<const TimeNs> times, TimeNs time, TimeNs limit) {
    const std::optional<std::size_t> nearest = nearest_in_time(times, time);
    if (!nearest) return std::nullopt;
    if (std::abs(times[*nearest] - time) <= limit) return Pairing{*nearest, true};
    const auto after = std::upper_bound(times.begin(), times.end(), time);
    if (after == times.begin()) return std::nullopt;
    return Pairing{static_cast<std::size_t>(after - times.begin()) - 1, false};
}

}  // namespace kino
