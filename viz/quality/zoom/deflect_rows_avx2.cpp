#include <immintrin.h>

#include "viz/quality/zoom/deflect_loops.h"

namespace kino::deflect_rows {
namespace {

__m256 all(float x) {
    return _mm256_set1_ps(x);
}

__m256 bounded8(__m256 x, int size) {
    return _mm256_max_ps(_mm256_min_ps(x, all(static_cast<float>(size) + 4.0f)), all(-4.0f));
}

__m256i floor8(__m256 x) {
    return _mm256_cvttps_epi32(_mm256_floor_ps(x));
}

__m256i within8(__m256i i, int size) {
    return _mm256_max_epi32(_mm256_min_epi32(i, _mm256_set1_epi32(size - 1)),
                            _mm256_setzero_si256());
}

__m256i index8(__m256i i, __m256i j, std::ptrdiff_t pitch) {
    return _mm256_add_epi32(_mm256_mullo_epi32(j, _mm256_set1_epi32(static_cast<int>(pitch))), i);
}

__m256 along8(__m256 at, __m256 w, __m256 along) {
    return _mm256_add_ps(at, _mm256_mul_ps(w, along));
}

__m256 magnitude8(__m256 x) {
    return _mm256_andnot_ps(all(-0.0f), x);
}

__m256 depth8(const Row& row, __m256i i, __m256i j) {
    return _mm256_i32gather_ps(
        row.inverse_z, index8(within8(i, row.width), within8(j, row.height), row.depth_pitch), 4);
}

template <bool kDepths>
int places_avx2(const Row& row, int count, float* u, float* v) {
    const __m256 half = all(0.5f);
    int outside = 0;
    int x = 0;
    __m256i lanes = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
    for (; x + 8 <= count; x += 8, lanes = _mm256_add_epi32(lanes, _mm256_set1_epi32(8))) {
        const __m256 t = _mm256_cvtepi32_ps(lanes);
        const __m256 z = along8(all(row.ray[2]), t, all(row.step[2]));
        const __m256 r = _mm256_div_ps(all(1.0f), _mm256_max_ps(z, all(1e-4f)));
        const __m256 a = _mm256_mul_ps(along8(all(row.ray[0]), t, all(row.step[0])), r);
        const __m256 b = _mm256_mul_ps(along8(all(row.ray[1]), t, all(row.step[1])), r);
        const __m256 at_u = _mm256_add_ps(_mm256_mul_ps(all(row.fx), a), all(row.cx));
        const __m256 at_v = _mm256_add_ps(_mm256_mul_ps(all(row.fy), b), all(row.cy));
        const __m256 along_u = _mm256_mul_ps(
            all(row.fx), _mm256_sub_ps(all(row.eye[0]), _mm256_mul_ps(a, all(row.eye[2]))));
        const __m256 along_v = _mm256_mul_ps(
            all(row.fy), _mm256_sub_ps(all(row.eye[1]), _mm256_mul_ps(b, all(row.eye[2]))));
        __m256 w = all(row.plane);
        if (kDepths) {
            const auto depth_at = [&](__m256 inverse) {
                const __m256 pu = bounded8(along8(at_u, inverse, along_u), row.width);
                const __m256 pv = bounded8(along8(at_v, inverse, along_v), row.height);
                return depth8(row, floor8(_mm256_add_ps(pu, half)),
                              floor8(_mm256_add_ps(pv, half)));
            };
            const __m256 first = depth_at(w);
            const __m256 second = depth_at(first);
            const __m256 third = depth_at(second);
            const __m256 off =
                _mm256_mul_ps(magnitude8(_mm256_sub_ps(third, second)),
                              _mm256_add_ps(magnitude8(along_u), magnitude8(along_v)));
            w = _mm256_blendv_ps(
                third, _mm256_blendv_ps(second, first, _mm256_cmp_ps(second, third, _CMP_LT_OQ)),
                _mm256_cmp_ps(off, half, _CMP_GT_OQ));
        }
        __m256 to_u = along8(at_u, w, along_u);
        __m256 to_v = along8(at_v, w, along_v);
        const auto inside = [&](__m256 p, int size) {
            return _mm256_and_ps(
                _mm256_cmp_ps(p, all(-0.5f), _CMP_GE_OQ),
                _mm256_cmp_ps(p, all(static_cast<float>(size) - 0.5f), _CMP_LT_OQ));
        };
        const int in =
            _mm256_movemask_ps(_mm256_and_ps(inside(to_u, row.width), inside(to_v, row.height)));
        outside += 8 - __builtin_popcount(static_cast<unsigned>(in));
        to_u = bounded8(to_u, row.width);
        to_v = bounded8(to_v, row.height);
        if (kDepths) {
            const __m256i one = _mm256_set1_epi32(1);
            const __m256i i = floor8(to_u);
            const __m256i j = floor8(to_v);
            const __m256 apart =
                magnitude8(_mm256_sub_ps(depth8(row, i, j), depth8(row, _mm256_add_epi32(i, one),
                                                                   _mm256_add_epi32(j, one))));
            const __m256 edge = _mm256_cmp_ps(
                _mm256_mul_ps(apart, _mm256_add_ps(magnitude8(along_u), magnitude8(along_v))), half,
                _CMP_GT_OQ);
            to_u = _mm256_blendv_ps(to_u, _mm256_floor_ps(_mm256_add_ps(to_u, half)), edge);
            to_v = _mm256_blendv_ps(to_v, _mm256_floor_ps(_mm256_add_ps(to_v, half)), edge);
        }
        _mm256_storeu_ps(u + x, to_u);
        _mm256_storeu_ps(v + x, to_v);
    }
    return outside + places_of<kDepths>(row, x, count, u, v);
}

int places_any_avx2(const Row& row, int count, float* u, float* v) {
    return row.inverse_z != nullptr ? places_avx2<true>(row, count, u, v)
                                    : places_avx2<false>(row, count, u, v);
}

void nearest_avx2(const Source& from, const float* u, const float* v, int count,
                  std::uint32_t* out) {
    const int* pixels = reinterpret_cast<const int*>(from.pixels);
    int x = 0;
    for (; x + 8 <= count; x += 8) {
        const __m256 half = all(0.5f);
        const __m256i i = within8(floor8(_mm256_add_ps(_mm256_loadu_ps(u + x), half)), from.width);
        const __m256i j = within8(floor8(_mm256_add_ps(_mm256_loadu_ps(v + x), half)), from.height);
        _mm256_storeu_si256(reinterpret_cast<__m256i*>(out + x),
                            _mm256_i32gather_epi32(pixels, index8(i, j, from.pitch), 4));
    }
    nearest_from(from, x, u, v, count, out);
}

__m256i part8(__m256 x, __m256i whole) {
    const __m256i part = _mm256_cvttps_epi32(
        _mm256_mul_ps(_mm256_sub_ps(x, _mm256_cvtepi32_ps(whole)), all(256.0f)));
    return _mm256_or_si256(part, _mm256_slli_epi32(part, 16));  // for both channels of a word
}

// Products of 16 bits each: 255 * 256 and the rounding still fit.
__m256i between8(__m256i a, __m256i b, __m256i part) {
    const __m256i rest = _mm256_sub_epi16(_mm256_set1_epi16(256), part);
    const __m256i sum =
        _mm256_add_epi16(_mm256_add_epi16(_mm256_mullo_epi16(a, rest), _mm256_mullo_epi16(b, part)),
                         _mm256_set1_epi16(128));
    return _mm256_srli_epi16(sum, 8);
}

void bilinear_avx2(const Source& from, const float* u, const float* v, int count,
                   std::uint32_t* out) {
    const int* pixels = reinterpret_cast<const int*>(from.pixels);
    const __m256i mask = _mm256_set1_epi32(0x00FF00FF);
    const __m256i one = _mm256_set1_epi32(1);
    int x = 0;
    for (; x + 8 <= count; x += 8) {
        const __m256 pu = _mm256_loadu_ps(u + x);
        const __m256 pv = _mm256_loadu_ps(v + x);
        const __m256i i = floor8(pu);
        const __m256i j = floor8(pv);
        const __m256i part_x = part8(pu, i);
        const __m256i part_y = part8(pv, j);
        const __m256i i0 = within8(i, from.width);
        const __m256i i1 = within8(_mm256_add_epi32(i, one), from.width);
        const __m256i j0 = within8(j, from.height);
        const __m256i j1 = within8(_mm256_add_epi32(j, one), from.height);
        const auto at = [&](__m256i column, __m256i line) {
            return _mm256_i32gather_epi32(pixels, index8(column, line, from.pitch), 4);
        };
        const __m256i p00 = at(i0, j0), p10 = at(i1, j0), p01 = at(i0, j1), p11 = at(i1, j1);
        const auto even = [&](__m256i p) { return _mm256_and_si256(p, mask); };
        const auto odd = [&](__m256i p) { return _mm256_and_si256(_mm256_srli_epi32(p, 8), mask); };
        const __m256i low = between8(between8(even(p00), even(p10), part_x),
                                     between8(even(p01), even(p11), part_x), part_y);
        const __m256i high = between8(between8(odd(p00), odd(p10), part_x),
                                      between8(odd(p01), odd(p11), part_x), part_y);
        _mm256_storeu_si256(reinterpret_cast<__m256i*>(out + x),
                            _mm256_or_si256(low, _mm256_slli_epi32(high, 8)));
    }
    bilinear_from(from, x, u, v, count, out);
}

}  // namespace

const Kernels& avx2() {
    static constexpr Kernels kKernels{places_any_avx2, nearest_avx2, bilinear_avx2};
    return kKernels;
}

}  // namespace kino::deflect_rows
