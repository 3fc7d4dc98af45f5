#pragma once

#include <cstdint>

namespace kino {

/// SplitMix64 (Steele, Lea & Flood 2014): the same numbers from the same seed everywhere.
class Chance {
  public:
    explicit Chance(std::uint64_t seed) : state_(seed) {}

    /// In [0, 1).
    [[nodiscard]] double part() {
        std::uint64_t z = state_ += 0x9e3779b97f4a7c15ull;
        z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9ull;
        z = (z ^ z >> 27) * 0x94d049bb133111ebull;
        return static_cast<double>((z ^ z >> 31) >> 11) * 0x1p-53;
    }
    [[nodiscard]] double between(double from, double to) { return from + (to - from) * part(); }

  private:
    std::uint64_t state_;
};

}  // namespace kino
