#pragma once

#include <array>
#include <cstddef>

namespace kino {

/// How far recent frames were off what was predicted: how much of a target may be planned for.
class Surprises {
  public:
    /// Predictions of 0 and times that are none are ignored.
    void add(double predicted_ms, double measured_ms);
    /// Measured over predicted: `share` of the recent frames were below. 1.1 while hardly anything
    /// is known.
    [[nodiscard]] double quantile(double share) const;
    void forget() { count_ = 0; }

  private:
    static constexpr std::size_t kRecent = 64;
    std::array<double, kRecent> ratios_{};
    std::size_t count_ = 0;  ///< of all that were added
};

}  // namespace kino
