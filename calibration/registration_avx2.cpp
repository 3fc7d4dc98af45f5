#include "calibration/registration_kernel.h"

#if defined(__x86_64__)
#include <immintrin.h>

namespace kino::registration {
namespace {

// The portable twin finishes what is left of a multiple of eight.
std::size_t whole_eights(std::size_t n) {
    return n & ~std::size_t{7};
}

__m256i load(const void* p) {
    return _mm256_loadu_si256(static_cast<const __m256i*>(p));
}
void store(void* p, __m256i v) {
    _mm256_storeu_si256(static_cast<__m256i*>(p), v);
}
__m256i load_u16(const std::uint16_t* p) {
    return _mm256_cvtepu16_epi32(_mm_loadu_si128(reinterpret_cast<const __m128i*>(p)));
}

void decode_linear(const std::uint16_t* raw, std::size_t n, std::uint16_t first, std::uint16_t last,
                   float scale, float* z) {
    const __m256i below = _mm256_set1_epi32(first - 1);
    const __m256i above = _mm256_set1_epi32(last + 1);
    const __m256 factor = _mm256_set1_ps(scale);
    const std::size_t end = whole_eights(n);
    for (std::size_t i = 0; i < end; i += 8) {
        const __m256i value = load_u16(raw + i);
        const __m256i valid =
            _mm256_and_si256(_mm256_cmpgt_epi32(value, below), _mm256_cmpgt_epi32(above, value));
        const __m256 metres = _mm256_mul_ps(_mm256_cvtepi32_ps(value), factor);
        _mm256_storeu_ps(z + i, _mm256_and_ps(metres, _mm256_castsi256_ps(valid)));
    }
    kPortable.decode_linear(raw + end, n - end, first, last, scale, z + end);
}

void decode_table(const std::uint16_t* raw, std::size_t n, const float* table, float* z) {
    const __m256i levels = _mm256_set1_epi32(2048);
    const std::size_t end = whole_eights(n);
    for (std::size_t i = 0; i < end; i += 8) {
        const __m256i value = load_u16(raw + i);
        const __m256 valid = _mm256_castsi256_ps(_mm256_cmpgt_epi32(levels, value));
        _mm256_storeu_ps(z + i,
                         _mm256_mask_i32gather_ps(_mm256_setzero_ps(), table, value, valid, 4));
    }
    kPortable.decode_table(raw + end, n - end, table, z + end);
}

__m256i to_fixed(__m256 pixels, __m256i last) {
    const __m256i fixed = _mm256_cvtps_epi32(_mm256_mul_ps(pixels, _mm256_set1_ps(16.0f)));
    return _mm256_min_epi32(_mm256_max_epi32(fixed, _mm256_setzero_si256()), last);
}

__m256 mul(__m256 a, __m256 b) {
    return _mm256_mul_ps(a, b);
}
__m256 add(__m256 a, __m256 b) {
    return _mm256_add_ps(a, b);
}

template <Distortion kDistortion>
void project_pixels(const Geometry& g, const float* z, std::size_t first, std::size_t end,
                    const Projected& out) {
    const auto all = [](float value) { return _mm256_set1_ps(value); };
    const __m256 one = all(1.0f);
    const __m256 zero = _mm256_setzero_ps();
    const __m256 before = all(-0.5f);
    const __m256 right = all(static_cast<float>(g.width) - 0.5f);
    const __m256 bottom = all(static_cast<float>(g.height) - 0.5f);
    const __m256i last_u = _mm256_set1_epi32((g.width - 1) * 16);
    const __m256i last_v = _mm256_set1_epi32((g.height - 1) * 16);
    const __m256i width = _mm256_set1_epi32(g.width);
    const __m256i ones = _mm256_set1_epi32(-1);
    for (std::size_t i = 0; i < end; i += 8) {
        const __m256 depth = _mm256_loadu_ps(z + i);
        const __m256 pz = add(mul(depth, _mm256_loadu_ps(g.ray_z + first + i)), all(g.tz));
        const __m256 px = add(mul(depth, _mm256_loadu_ps(g.ray_x + first + i)), all(g.tx));
        const __m256 py = add(mul(depth, _mm256_loadu_ps(g.ray_y + first + i)), all(g.ty));
        const __m256 inverse = _mm256_div_ps(one, pz);
        __m256 x = mul(px, inverse);
        __m256 y = mul(py, inverse);
        __m256 valid = _mm256_and_ps(_mm256_cmp_ps(depth, zero, _CMP_GT_OQ),
                                     _mm256_cmp_ps(pz, zero, _CMP_GT_OQ));
        if constexpr (kDistortion != Distortion::none) {
            const __m256 xx = mul(x, x);
            const __m256 yy = mul(y, y);
            const __m256 s = add(xx, yy);
            valid = _mm256_and_ps(valid, _mm256_cmp_ps(s, all(g.max_radius_squared), _CMP_LE_OQ));
            __m256 factor = add(mul(all(g.k3), s), all(g.k2));
            factor = add(mul(factor, s), all(g.k1));
            factor = add(mul(factor, s), one);
            if constexpr (kDistortion == Distortion::rational) {
                __m256 below = add(mul(all(g.k6), s), all(g.k5));
                below = add(mul(below, s), all(g.k4));
                below = add(mul(below, s), one);
                factor = _mm256_div_ps(factor, below);
            }
            const __m256 p1 = all(g.p1);
            const __m256 p2 = all(g.p2);
            const __m256 xy2 = mul(add(x, x), y);
            x = add(add(mul(x, factor), mul(xy2, p1)), mul(add(s, add(xx, xx)), p2));
            y = add(add(mul(y, factor), mul(xy2, p2)), mul(add(s, add(yy, yy)), p1));
        }
        const __m256 u = add(mul(x, all(g.fx)), all(g.cx));
        const __m256 v = add(mul(y, all(g.fy)), all(g.cy));
        if (out.z) {
            const __m256 placed = _mm256_and_ps(valid, _mm256_cmp_ps(u, v, _CMP_ORD_Q));
            _mm256_storeu_ps(out.u + i, u);
            _mm256_storeu_ps(out.v + i, v);
            _mm256_storeu_ps(out.z + i, _mm256_and_ps(pz, placed));
        }
        valid = _mm256_and_ps(valid, _mm256_and_ps(_mm256_cmp_ps(u, before, _CMP_GE_OQ),
                                                   _mm256_cmp_ps(u, right, _CMP_LT_OQ)));
        valid = _mm256_and_ps(valid, _mm256_and_ps(_mm256_cmp_ps(v, before, _CMP_GE_OQ),
                                                   _mm256_cmp_ps(v, bottom, _CMP_LT_OQ)));
        const __m256i mask = _mm256_castps_si256(valid);
        const __m256i uv =
            _mm256_or_si256(to_fixed(u, last_u), _mm256_slli_epi32(to_fixed(v, last_v), 16));
        const __m256i cell = _mm256_add_epi32(_mm256_mullo_epi32(_mm256_cvtps_epi32(v), width),
                                              _mm256_cvtps_epi32(u));
        const __m256i invalid = _mm256_xor_si256(mask, ones);
        store(out.uv + i, _mm256_or_si256(uv, invalid));
        store(out.cell + i, _mm256_and_si256(cell, mask));
        store(out.key + i, _mm256_and_si256(_mm256_castps_si256(pz), mask));
    }
}

void project(const Geometry& g, const float* z, std::size_t first, std::size_t n,
             const Projected& out) {
    const std::size_t end = whole_eights(n);
    switch (g.distortion) {
        case Distortion::none:
            project_pixels<Distortion::none>(g, z, first, end, out);
            break;
        case Distortion::polynomial:
            project_pixels<Distortion::polynomial>(g, z, first, end, out);
            break;
        case Distortion::rational:
            project_pixels<Distortion::rational>(g, z, first, end, out);
            break;
    }
    Projected rest = {out.uv + end, out.cell + end, out.key + end};
    if (out.z) {
        rest.u = out.u + end;
        rest.v = out.v + end;
        rest.z = out.z + end;
    }
    kPortable.project(g, z + end, first + end, n - end, rest);
}

void occlude(const Occlusion& o, const std::int32_t* cell, const std::uint32_t* key, std::size_t n,
             const float* z_buffer, std::uint32_t* uv) {
    const __m256 margin = _mm256_set1_ps(o.margin);
    const __m256 step = _mm256_set1_ps(o.step);
    const std::size_t end = whole_eights(n);
    for (std::size_t i = 0; i < end; i += 8) {
        const __m256 z = _mm256_castsi256_ps(load(key + i));
        const __m256 limit = _mm256_sub_ps(_mm256_sub_ps(z, margin), mul(mul(z, z), step));
        const __m256 nearest = _mm256_i32gather_ps(z_buffer, load(cell + i), 4);
        const __m256i hidden = _mm256_castps_si256(_mm256_cmp_ps(limit, nearest, _CMP_GT_OQ));
        store(uv + i, _mm256_or_si256(load(uv + i), hidden));
    }
    kPortable.occlude(o, cell + end, key + end, n - end, z_buffer, uv + end);
}

void unproject(const float* z, const float* ray_xy, std::size_t n, float* xyz) {
    const __m256i twice_low = _mm256_setr_epi32(0, 0, 1, 1, 2, 2, 3, 3);
    const __m256i twice_high = _mm256_setr_epi32(4, 4, 5, 5, 6, 6, 7, 7);
    // Output order x0 y0 z0 x1 y1 z1 ...: where each lane finds its x or y, and its z.
    const __m256i xy0 = _mm256_setr_epi32(0, 1, 0, 2, 3, 0, 4, 5);
    const __m256i z0 = _mm256_setr_epi32(0, 0, 0, 0, 0, 1, 0, 0);
    const __m256i xy1_low = _mm256_setr_epi32(0, 6, 7, 0, 0, 0, 0, 0);
    const __m256i xy1_high = _mm256_setr_epi32(0, 0, 0, 0, 0, 1, 0, 2);
    const __m256i z1 = _mm256_setr_epi32(2, 0, 0, 3, 0, 0, 4, 0);
    const __m256i xy2 = _mm256_setr_epi32(3, 0, 4, 5, 0, 6, 7, 0);
    const __m256i z2 = _mm256_setr_epi32(0, 5, 0, 0, 6, 0, 0, 7);
    const std::size_t end = whole_eights(n);
    for (std::size_t i = 0; i < end; i += 8) {
        const __m256 depth = _mm256_loadu_ps(z + i);
        __m256 low =
            mul(_mm256_permutevar8x32_ps(depth, twice_low), _mm256_loadu_ps(ray_xy + 2 * i));
        __m256 high =
            mul(_mm256_permutevar8x32_ps(depth, twice_high), _mm256_loadu_ps(ray_xy + 2 * i + 8));
        __m256 kept = depth;
        const __m256 ordered = _mm256_cmp_ps(low, high, _CMP_ORD_Q);
        if (_mm256_movemask_ps(ordered) != 0xFF) [[unlikely]] {
            kPortable.unproject(z + i, ray_xy + 2 * i, 8, xyz + 3 * i);
            continue;
        }
        const auto pick = [](__m256 from, __m256i lanes) {
            return _mm256_permutevar8x32_ps(from, lanes);
        };
        const __m256 out0 = _mm256_blend_ps(pick(low, xy0), pick(kept, z0), 0b00100100);
        const __m256 out1 =
            _mm256_blend_ps(_mm256_blend_ps(pick(low, xy1_low), pick(high, xy1_high), 0b10110000),
                            pick(kept, z1), 0b01001001);
        const __m256 out2 = _mm256_blend_ps(pick(high, xy2), pick(kept, z2), 0b10010010);
        _mm256_storeu_ps(xyz + 3 * i, out0);
        _mm256_storeu_ps(xyz + 3 * i + 8, out1);
        _mm256_storeu_ps(xyz + 3 * i + 16, out2);
    }
    kPortable.unproject(z + end, ray_xy + 2 * end, n - end, xyz + 3 * end);
}

}  // namespace

const Functions kAvx2 = {decode_linear, decode_table, project, occlude, unproject, "avx2"};

}  // namespace kino::registration
#endif
