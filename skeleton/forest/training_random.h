#pragma once

#include <cstdint>
#include <initializer_list>

namespace kino {

/// SplitMix64 (Steele, Lea & Flood 2014), started from a tuple of numbers: what is drawn for one
/// node or picture depends on nothing else, whoever draws it and when.
class TrainingRandom {
  public:
    TrainingRandom(std::initializer_list<std::uint64_t> key) {
        for (const std::uint64_t part : key) {
            state_ ^= part;
            state_ = bits();
        }
    }

    std::uint64_t bits() {
        state_ += 0x9E3779B97F4A7C15u;
        std::uint64_t z = state_;
        z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
        z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
        return z ^ (z >> 31);
    }
    /// In [0, 1).
    double unit() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
    /// In [0, count), count > 0; the bias of at most count / 2^64 does not matter here.
    std::uint64_t below(std::uint64_t count) { return bits() % count; }

  private:
    std::uint64_t state_ = 0;
};

}  // namespace kino
