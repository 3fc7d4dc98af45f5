#pragma once

#include <chrono>
#include <cstdint>

namespace kino {

/// Nanoseconds. Device clocks are unwrapped and mapped to host time before they get this type.
using TimeNs = std::int64_t;

constexpr TimeNs kNsPerMs = 1'000'000;
constexpr TimeNs kNsPerSecond = 1'000'000'000;

constexpr double to_seconds(TimeNs t) {
    return static_cast<double>(t) * 1e-9;
}
constexpr double to_ms(TimeNs t) {
    return static_cast<double>(t) * 1e-6;
}
constexpr TimeNs from_seconds(double s) {
    return static_cast<TimeNs>(s * 1e9 + (s < 0 ? -0.5 : 0.5));
}

/// The host's monotonic clock; the only clock that frames of different devices are compared on.
inline TimeNs now_ns() {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(
               std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

}  // namespace kino
