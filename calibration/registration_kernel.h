#pragma once

#include <cstddef>
#include <cstdint>

// Plain data and function pointers only: this header is also read by code compiled for AVX2, whose
// inline functions must not reach the rest of the program.

namespace kino::registration {

enum class Distortion : std::uint8_t { none, polynomial, rational };

/// The colour camera and its place, in float, and the depth camera's rays already turned into its
/// axes: a depth pixel i at z metres lies at z * (ray_x[i], ray_y[i], ray_z[i]) + t.
struct Geometry {
    const float* ray_x;
    const float* ray_y;
    const float* ray_z;
    float tx, ty, tz;      // metres
    float fx, fy, cx, cy;  // px
    float k1, k2, k3, k4, k5, k6, p1, p2;
    float max_radius_squared;    // of the one-to-one disc at z = 1
    std::int32_t width, height;  // colour image, px
    Distortion distortion;
};

/// What project() leaves per depth pixel. Invalid pixels: uv all ones, cell and key 0.
struct Projected {
    std::uint32_t* uv;   // ColorUv, u in the low half
    std::int32_t* cell;  // colour pixel y * width + x it falls into
    std::uint32_t* key;  // bits of its depth from the colour camera, positive float
    // The exact place, also outside the picture; or all three null. No place: z is 0.
    float* u = nullptr;
    float* v = nullptr;
    float* z = nullptr;  // metres from the colour camera
};

/// A pixel is hidden if z - margin - step * z^2 > what the z-buffer holds there.
struct Occlusion {
    float margin;  // metres
    float step;    // two quantisation steps: metres at 1 m
};

constexpr std::uint32_t kInvalid = 0xFFFFFFFFu;

/// Every function works on n consecutive pixels and gives the same bits in every implementation:
/// the same operations in the same order, no fused multiply-add.
struct Functions {
    /// raw * scale where first <= raw <= last, else 0.
    void (*decode_linear)(const std::uint16_t* raw, std::size_t n, std::uint16_t first,
                          std::uint16_t last, float scale, float* z);
    /// table[raw], 0 from raw 2048 on.
    void (*decode_table)(const std::uint16_t* raw, std::size_t n, const float* table, float* z);
    /// Pixels [first, first + n) of the depth image.
    void (*project)(const Geometry& geometry, const float* z, std::size_t first, std::size_t n,
                    const Projected& out);
    /// Sets uv to kInvalid where the pixel is hidden.
    void (*occlude)(const Occlusion& occlusion, const std::int32_t* cell, const std::uint32_t* key,
                    std::size_t n, const float* z_buffer, std::uint32_t* uv);
    /// z * (x, y, 1), three floats a pixel; zeros where there is no reading or no ray.
    void (*unproject)(const float* z, const float* ray_xy, std::size_t n, float* xyz);
    const char* name;
};

extern const Functions kPortable;
extern const Functions kAvx2;  // only after best() or an own check of the processor

/// The fastest this processor can run.
[[nodiscard]] const Functions& best();

}  // namespace kino::registration
