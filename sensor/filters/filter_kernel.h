#pragma once

#include <cstddef>
#include <cstdint>

// Plain data and function pointers only: this header is also read by code compiled for AVX2, whose
// inline functions must not reach the rest of the program.

namespace kino::filters {

/// Stands for "no reading" among inverse depths: so far from every one of them that no window
/// accepts it, and its square overflows harmlessly.
constexpr float kNone = -1e30f;

/// A window around a pixel of the padded inverse-depth picture, the centre left out.
struct Window {
    const float* weights;
    const std::ptrdiff_t* offsets;
    int taps;
    float inverse_threshold;  // m: one over the largest accepted difference
};

struct Support {
    std::ptrdiff_t pitch;  // of the padded inverse-depth picture
    float step;            // accepted difference = step + slope * inverse depth, 1/m
    float slope;
    std::int32_t minimum;  // neighbours of eight that must agree
};

struct Blend {
    float alpha;
    float inverse_threshold;  // m
    float most;               // frames that the running mean counts up to
    std::int32_t persistence;
    bool running;  // else the gain is alpha from the second frame on
    bool soft;     // else a difference counts fully up to the threshold
};

/// What temporal filtering remembers per pixel.
struct Memory {
    float* z;       // metres, 0 = nothing
    float* frames;  // that went into it, after forgetting
    std::int32_t* unseen;
};

struct Halve {
    float threshold;        // farthest from the block's lower median, 1/m
    std::int32_t readings;  // that a block must hold
};

/// Every function works on n consecutive pixels and gives the same bits in every implementation:
/// the same operations in the same order, no fused multiply-add.
struct Functions {
    /// 1/z, kNone where z is no reading.
    void (*invert)(const float* z, std::size_t n, float* inverse);
    /// `inverse` points into the padded picture, z and out are plain rows.
    void (*smooth)(const Window& window, const float* inverse, const float* z, std::size_t n,
                   float* out);
    void (*support)(const Support& support, const float* inverse, const float* z, std::size_t n,
                    float* out);
    void (*blend)(const Blend& blend, const float* z, std::size_t n, const Memory& memory,
                  float* out);
    /// Copies readings, 0 elsewhere; bit i of `bits` tells whether pixel i holds one.
    void (*classify)(const float* z, std::size_t n, float* out, std::uint64_t* bits);
    /// Pixel i from pixels 2i and 2i + 1 of two rows.
    void (*halve)(const Halve& halve, const float* upper, const float* lower, std::size_t n,
                  float* out);
    const char* name;
};

extern const Functions kPortable;
extern const Functions kAvx2;  // only after best() or an own check of the processor

/// The fastest this processor can run, or the portable ones.
[[nodiscard]] const Functions& choose(bool simd);

}  // namespace kino::filters
