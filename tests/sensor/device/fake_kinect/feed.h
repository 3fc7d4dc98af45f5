#pragma once

#include <cstdint>
#include <memory>
#include <vector>

namespace kino::fake {

/// What the fake camera films: the frame of number `n` >= 0 of each stream, always the same one.
class Feed {
  public:
    virtual ~Feed() = default;
    [[nodiscard]] virtual std::vector<std::uint16_t> depth(int n) const = 0;  ///< 640x480, 11 bits
    /// 640x480 or 1280x1024, GRBG.
    [[nodiscard]] virtual std::vector<std::uint8_t> bayer(int n, int width, int height) const = 0;
    /// 640x488 or 1280x1024, 10 bits.
    [[nodiscard]] virtual std::vector<std::uint16_t> infrared(int n, int width,
                                                              int height) const = 0;
    [[nodiscard]] virtual std::vector<std::uint8_t> uyvy(int n) const = 0;  ///< 640x480
};

/// Noise in which no pixel repeats its value in any of the 200 frames before it, so that every
/// pixel left over from an earlier frame shows; depth never says 2047, "no reading".
[[nodiscard]] std::unique_ptr<Feed> noise_feed(std::uint64_t seed);

/// A smooth scene that moves, for recorders: ramps with a block of no reading. Successive frames
/// differ in every pixel with a reading.
[[nodiscard]] std::unique_ptr<Feed> scene_feed();

}  // namespace kino::fake
