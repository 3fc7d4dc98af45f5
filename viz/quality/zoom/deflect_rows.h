#pragma once

#include <cstddef>
#include <cstdint>

/// Rows of a deflecting copy, in two sets that agree to the bit.
namespace kino::deflect_rows {

/// Where rays of a row of pixels meet the drawn picture: for 1/z they do at
/// (u, v) = at + inverse_z * along, both linear in the ray's slopes.
struct Row {
    float ray[3];   ///< direction of the first pixel's, in the space of the drawn view
    float step[3];  ///< from one pixel to the next
    float eye[3];   ///< in the space of the drawn view
    float fx, fy, cx, cy;
    int width, height;  ///< of the drawn picture
    const float* inverse_z;
    std::ptrdiff_t depth_pitch;
    float plane;  ///< 1/z to start from, or of everything
};

struct Source {
    const std::uint32_t* pixels;
    std::ptrdiff_t pitch;
    int width, height;
};

struct Kernels {
    /// Places of `count` pixels through their depths or, without any, the plane. Returns how many
    /// are outside.
    int (*places)(const Row& row, int count, float* u, float* v);
    void (*nearest)(const Source& from, const float* u, const float* v, int count,
                    std::uint32_t* out);
    void (*bilinear)(const Source& from, const float* u, const float* v, int count,
                     std::uint32_t* out);
};

const Kernels& portable();
const Kernels& avx2();  ///< call only where the processor has AVX2

}  // namespace kino::deflect_rows
