#include <cstring>

#include "calibration/registration_kernel.h"

namespace kino::registration {
namespace {

void decode_linear(const std::uint16_t* raw, std::size_t n, std::uint16_t first, std::uint16_t last,
                   float scale, float* z) {
    for (std::size_t i = 0; i < n; ++i) {
        const bool valid = raw[i] >= first && raw[i] <= last;
        z[i] = valid ? static_cast<float>(raw[i]) * scale : 0.0f;
    }
}

void decode_table(const std::uint16_t* raw, std::size_t n, const float* table, float* z) {
    for (std::size_t i = 0; i < n; ++i) z[i] = raw[i] < 2048 ? table[raw[i]] : 0.0f;
}

// Nearest whole number, ties to even, for |x| < 2^22: the processor's own rounding instruction
// without the library call that std::nearbyint is on baseline x86.
std::int32_t round_to_int(float x) {
    constexpr float kMagic = 12582912.0f;
    return static_cast<std::int32_t>((x + kMagic) - kMagic);
}

std::uint32_t to_fixed(float pixels, std::int32_t size) {
    const std::int32_t fixed = round_to_int(pixels * 16.0f);
    const std::int32_t last = (size - 1) * 16;
    return static_cast<std::uint32_t>(fixed < 0 ? 0 : fixed > last ? last : fixed);
}

template <Distortion kDistortion>
void project_pixels(const Geometry& g, const float* z, std::size_t first, std::size_t n,
                    const Projected& out) {
    const float right = static_cast<float>(g.width) - 0.5f;
    const float bottom = static_cast<float>(g.height) - 0.5f;
    for (std::size_t i = 0; i < n; ++i) {
        const float pz = z[i] * g.ray_z[first + i] + g.tz;
        const float inverse = 1.0f / pz;
        float x = (z[i] * g.ray_x[first + i] + g.tx) * inverse;
        float y = (z[i] * g.ray_y[first + i] + g.ty) * inverse;
        bool valid = z[i] > 0.0f && pz > 0.0f;
        if constexpr (kDistortion != Distortion::none) {
            const float xx = x * x;
            const float yy = y * y;
            const float s = xx + yy;
            valid = valid && s <= g.max_radius_squared;
            float factor = ((g.k3 * s + g.k2) * s + g.k1) * s + 1.0f;
            if constexpr (kDistortion == Distortion::rational) {
                factor = factor / (((g.k6 * s + g.k5) * s + g.k4) * s + 1.0f);
            }
            const float xy2 = (x + x) * y;
            const float dx = (x * factor + xy2 * g.p1) + (s + (xx + xx)) * g.p2;
            const float dy = (y * factor + xy2 * g.p2) + (s + (yy + yy)) * g.p1;
            x = dx;
            y = dy;
        }
        const float u = x * g.fx + g.cx;
        const float v = y * g.fy + g.cy;
        if (out.z) {
            out.u[i] = u;
            out.v[i] = v;
            out.z[i] = valid && u == u && v == v ? pz : 0.0f;
        }
        // NaN fails here too, before any conversion to int.
        valid = valid && u >= -0.5f && u < right && v >= -0.5f && v < bottom;
        out.uv[i] = kInvalid;
        out.cell[i] = 0;
        out.key[i] = 0;
        if (valid) {
            out.uv[i] = to_fixed(u, g.width) | to_fixed(v, g.height) << 16;
            out.cell[i] = round_to_int(v) * g.width + round_to_int(u);
            std::memcpy(&out.key[i], &pz, sizeof(float));
        }
    }
}

void project(const Geometry& g, const float* z, std::size_t first, std::size_t n,
             const Projected& out) {
    switch (g.distortion) {
        case Distortion::none:
            return project_pixels<Distortion::none>(g, z, first, n, out);
        case Distortion::polynomial:
            return project_pixels<Distortion::polynomial>(g, z, first, n, out);
        case Distortion::rational:
            return project_pixels<Distortion::rational>(g, z, first, n, out);
    }
}

void occlude(const Occlusion& o, const std::int32_t* cell, const std::uint32_t* key, std::size_t n,
             const float* z_buffer, std::uint32_t* uv) {
    for (std::size_t i = 0; i < n; ++i) {
        float z;  // 0 where invalid: the limit is then never positive
        std::memcpy(&z, &key[i], sizeof(float));
        const float limit = (z - o.margin) - (z * z) * o.step;
        if (limit > z_buffer[cell[i]]) uv[i] = kInvalid;
    }
}

void unproject(const float* z, const float* ray_xy, std::size_t n, float* xyz) {
    for (std::size_t i = 0; i < n; ++i) {
        const float x = z[i] * ray_xy[2 * i];
        const float y = z[i] * ray_xy[2 * i + 1];
        const bool valid = x == x && y == y;
        xyz[3 * i] = valid ? x : 0.0f;
        xyz[3 * i + 1] = valid ? y : 0.0f;
        xyz[3 * i + 2] = valid ? z[i] : 0.0f;
    }
}

}  // namespace

const Functions kPortable = {decode_linear, decode_table, project, occlude, unproject, "portable"};

const Functions& best() {
#if defined(__x86_64__)
    static const bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
    if (avx2) return kAvx2;
#endif
    return kPortable;
}

}  // namespace kino::registration
