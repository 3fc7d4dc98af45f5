#pragma once

#include <cstddef>
#include <cstdint>

// Plain data and function pointers only: this header is also read by code compiled for AVX2, whose
// inline functions must not reach the rest of the program.

namespace kino::forest {

/// A node ready to run. A leaf has itself as its left child and a threshold that nothing exceeds,
/// so walking on from it stays there; its distribution's index lies in u (low half) and v.
struct alignas(16) WalkNode {
    std::int16_t ux, uy, vx, vy;  ///< quarters of a millimetre
    std::int32_t threshold;       ///< mm
    std::int32_t child;           ///< left; the right one follows
};

/// A body's depth, padded by a pixel of background on all sides, so that coordinates clamped into
/// it give background outside.
struct WalkImage {
    const std::uint16_t* depth;  ///< mm, first pixel of the padded picture; 2 readable beyond it
    std::int32_t pitch;          ///< elements, < 32768
    std::int16_t max_x, max_y;   ///< last pixel of the padded picture
};

/// Pixels to label: x and y (low and high half) in the padded picture; scale = focal / depth in
/// 2^-15 px per quarter of a millimetre.
struct WalkPixels {
    const std::uint32_t* xy;
    const std::int16_t* scale;
    std::size_t count;
};

struct VoteInput {
    const std::int32_t* const* leaf;  ///< per tree, distribution per pixel
    int tree_count;
    const std::uint8_t* distributions;  ///< rows of `stride`
    int stride;                         ///< 16 or 32
};

/// The pixel whose features a trainer asks for, and what it wants to know.
struct ProbePixel {
    std::uint32_t xy;
    std::int16_t scale;
    std::int32_t low, high;  ///< differences are clamped to these
};

/// Every implementation gives the same bits: all arithmetic is on integers.
struct Functions {
    /// Distribution index of each pixel. An offset o becomes (o * scale + 2^14) >> 15 pixels.
    void (*walk)(const WalkNode* nodes, const WalkImage&, const WalkPixels&, std::int32_t* leaf);
    /// The label with the largest sum over the trees (the lowest of equals) and that sum.
    void (*vote)(const VoteInput&, std::size_t count, std::uint8_t* label, std::uint16_t* votes);
    /// out[i] = depth at offset u[i] minus depth at v[i] (x low, y high half; v null: at the pixel
    /// itself), clamped, minus low. `count` is a multiple of 8.
    void (*probe)(const WalkImage&, const ProbePixel&, const std::uint32_t* u,
                  const std::uint32_t* v, std::size_t count, std::int32_t* out);
    const char* name;
};

[[nodiscard]] const Functions& portable_functions();
/// Null where this build has no AVX2 twin; call only if the processor has AVX2 and FMA.
[[nodiscard]] const Functions* avx2_functions();
/// The best that this processor runs.
[[nodiscard]] const Functions& functions();

}  // namespace kino::forest
