#pragma once

// Plain data for the inner loops, which exist twice (portable and AVX2): no function bodies here.
// All rays start at the view's eye and have the direction (x, y, 1) in the view's axes, so the ray
// parameter is the depth z, metres.

#include <cstdint>

namespace kino::raycast {

/// Pixels [x0, x1) x [y0, y1).
struct Rect {
    int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

/// A solid made ready for one eye. Local space as in primitive.h.
struct Solid {
    enum Kind : std::int32_t { ball, cone, box };
    Kind kind = ball;
    std::int32_t id = 0;
    /// The ray is walked from depth t0, near the solid: local(t0 + t) =
    /// m (wx + t0 x, wy + t0 y, wz) + t m (x, y, 1). Starting at the eye instead would lose the
    /// digits that decide a silhouette.
    float t0 = 0, wx = 0, wy = 0, wz = 0;
    float m[9] = {};  ///< local_from_view, by rows
    float radius_a = 0, radius_b = 0, height = 0;
    float slope = 0, cos2 = 0;       ///< sine of the cone's half angle; 1 - slope^2
    float side_lo = 0, side_hi = 0;  ///< local y between the circles where cone and balls touch
    float half[3] = {};
};

/// The pictures that solids are drawn into; all have rows of `pitch` elements, a multiple of 8.
struct Target {
    const float* ray_x = nullptr;
    const float* ray_y = nullptr;
    float* z = nullptr;           ///< nearest surface, m
    std::int32_t* id = nullptr;   ///< of that surface
    std::int32_t* lit = nullptr;  ///< -1 where the emitter sees the surface, else 0; may be null
    int pitch = 0;
};

struct Paint {
    float albedo[3] = {};          ///< linear
    float fold = 0;                ///< how far cloth bends the normal
    float fold_x = 0, fold_y = 0;  ///< folds per local unit
    float wrap = 0.25f;            ///< how far light reaches round the terminator
};

/// Directions in the view's axes, towards the light; colours linear.
struct Lights {
    float key[3] = {}, fill[3] = {}, up[3] = {};
    float key_color[3] = {}, fill_color[3] = {}, sky_color[3] = {}, ground_color[3] = {};
};

/// Dark spots on the floor, world x and z.
struct FloorSpots {
    static constexpr int kMax = 8;
    int count = 0;
    float x[kMax] = {}, z[kMax] = {}, inverse_radius2[kMax] = {}, strength[kMax] = {};
};

struct Quantiser {
    float offset = 0, factor = 0;             ///< raw = offset - factor / z
    int raw_min = 0, raw_max = 0;             ///< readings outside become 2047
    float sigma = 0;                          ///< raw steps; 0 switches noise and dropout off
    const float* normal_quantiles = nullptr;  ///< 4096 equally likely values of N(0, 1)
    float jump = 0;                           ///< raw steps between neighbours that make an edge
    std::uint32_t drop_next = 0, drop_second = 0;  ///< chance of loss, out of 2^20
    std::uint32_t seed = 0;
};

struct Kernels {
    /// Nearest surface: z, id, and lit = -1 where this solid wins.
    void (*nearest)(const Solid&, const Rect&, const Target&);
    /// Clears lit where the solid (made ready for the emitter) stands between the emitter at
    /// (emitter_x, 0, 0) and a surface with id >= first_id, nearer to it by more than margin.
    void (*block)(const Solid&, const Rect&, const Target&, float emitter_x, float margin,
                  std::int32_t first_id);
    /// Colours the pixels that show this ball or cone.
    void (*shade)(const Solid&, const Paint&, const Lights&, const Rect&, const Target&,
                  std::uint32_t* rgba);
    /// Darkens floor pixels with id < first_id; floor_x/z hold world places, huge off the floor.
    void (*darken)(const FloorSpots&, const Rect&, const Target&, const float* floor_x,
                   const float* floor_z, std::int32_t first_id, std::uint32_t* rgba);
    /// Unrounded raw values of one row. `count` is a multiple of 8.
    void (*disparity)(const Quantiser&, const float* z, int count, float* raw);
    /// One row of readings. rows[0..4] are the unrounded rows y-2..y+2, readable 8 elements beyond
    /// both ends; `first_pixel` numbers the row's first pixel for the noise.
    void (*measure)(const Quantiser&, const float* const* rows, const std::int32_t* lit,
                    std::uint32_t first_pixel, int count, std::uint16_t* out);
};

[[nodiscard]] const Kernels& portable_kernels();
/// Null where this build has no AVX2 twin; call only if the processor has AVX2 and FMA.
[[nodiscard]] const Kernels* avx2_kernels();
/// The best that this processor runs. Both twins give bit-identical results.
[[nodiscard]] const Kernels& kernels();

}  // namespace kino::raycast
