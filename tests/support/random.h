#pragma once

#include <cstdint>

#include "base/image.h"

namespace kino::test {

/// SplitMix64 (Steele, Lea & Flood 2014): the same numbers from the same seed on every standard
/// library, which std::uniform_*_distribution does not promise.
class Random {
  public:
    explicit Random(std::uint64_t seed) : state_(seed) {}

    [[nodiscard]] std::uint64_t bits();
    /// In [from, to).
    [[nodiscard]] double real(double from, double to);
    /// In [from, to], both included; KINO_CHECKs from <= to.
    [[nodiscard]] int integer(int from, int to);
    [[nodiscard]] bool chance(double probability);

  private:
    std::uint64_t state_;
};

/// Every channel of every pixel on its own; alpha as well.
[[nodiscard]] Image<Rgba8> random_rgba8(int width, int height, std::uint64_t seed);

/// Smooth colours with edges in them: what a photograph is to a codec. Alpha 255.
[[nodiscard]] Image<Rgba8> random_picture(int width, int height, std::uint64_t seed);

/// Values in [from, to], a share of them 0 (no reading).
[[nodiscard]] Image<std::uint16_t> random_raw_depth(int width, int height, std::uint64_t seed,
                                                    int from, int to, double holes = 0.1);

}  // namespace kino::test
