#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "base/time.h"

namespace kino {

/// Smallest pairing limit: half a period of 30 Hz, rounded up.
constexpr TimeNs kMinPairingLimit = 17 * kNsPerMs;

/// The median distance of neighbours in a rising list; 1/30 s where there are none.
[[nodiscard]] TimeNs median_distance(std::span<const TimeNs> times);

/// Half the median distance of the following stream's frames, at least kMinPairingLimit: a frame
/// of an evenly running stream is then always in reach and never two periods away. Times rise.
[[nodiscard]] TimeNs pairing_limit(std::span<const TimeNs> times);

/// Index of the time nearest to `time` in a rising list; the earlier of two equally near. None in
/// an empty list.
[[nodiscard]] std::optional<std::size_t> nearest_in_time(std::span<const TimeNs> times,
                                                         TimeNs time);

struct Pairing {
    std::size_t index = 0;
    bool paired = false;  ///< within the limit
};

/// What to show beside a leading frame at `time`: the nearest following frame if it lies within
/// `limit` (inclusive), else the last one before, unpaired; none where nothing came before. One
/// frame may serve several leading ones. Live sources call it over the frames they still hold.
[[nodiscard]] std::optional<Pairing> pair_in_time(std::span<const TimeNs> times, TimeNs time,
                                                  TimeNs limit);

}  // namespace kino
