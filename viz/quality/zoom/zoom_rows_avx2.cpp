#include <immintrin.h>

#include "viz/quality/zoom/zoom_rows.h"

namespace kino::zoom_rows {
namespace {

void replicate_row_avx2(const std::uint32_t* small, int count, int z, std::uint32_t* out) {
    // Each store covers the longest block; what is too much is overwritten by the next.
    for (int i = 0; i < count; ++i, out += z) {
        _mm256_storeu_si256(reinterpret_cast<__m256i*>(out),
                            _mm256_set1_epi32(static_cast<int>(small[i])));
    }
}

/// A pixel's channels as 8.8 fixed point, four times over.
__m256i spread(std::uint32_t pixel) {
    const __m128i wide = _mm_cvtepu8_epi16(_mm_cvtsi32_si128(static_cast<int>(pixel)));
    return _mm256_slli_epi16(_mm256_broadcastq_epi64(wide), 8);
}

__m256i load(const std::uint16_t* from) {
    return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(from));
}

void blur_row_avx2(const std::uint32_t* small, int count, int z, const Taps& taps,
                   std::uint16_t* out) {
    const int vectors = z > 4 ? 2 : 1;
    __m256i before = spread(small[0]);
    __m256i at = before;
    for (int i = 0; i < count; ++i, out += 4 * z) {
        const __m256i after = spread(small[i + 1 < count ? i + 1 : i]);
        for (int v = 0; v < vectors; ++v) {
            const __m256i sum = _mm256_add_epi16(
                _mm256_add_epi16(_mm256_mulhi_epu16(before, load(taps.before[4 * v])),
                                 _mm256_mulhi_epu16(at, load(taps.at[4 * v]))),
                _mm256_mulhi_epu16(after, load(taps.after[4 * v])));
            _mm256_storeu_si256(reinterpret_cast<__m256i*>(out + 16 * v), sum);
        }
        before = at;
        at = after;
    }
}

template <bool kBefore, bool kAfter>
void blend_rows_avx2(const std::uint16_t* before, const std::uint16_t* at,
                     const std::uint16_t* after, const std::uint16_t weights[3], int count,
                     std::uint32_t* out) {
    const __m256i w0 = _mm256_set1_epi16(static_cast<short>(weights[0]));
    const __m256i w1 = _mm256_set1_epi16(static_cast<short>(weights[1]));
    const __m256i w2 = _mm256_set1_epi16(static_cast<short>(weights[2]));
    const __m256i half = _mm256_set1_epi16(128);
    const auto sum_at = [&](int i) {
        __m256i sum = _mm256_add_epi16(half, _mm256_mulhi_epu16(load(at + 4 * i), w1));
        if constexpr (kBefore) {
            sum = _mm256_add_epi16(sum, _mm256_mulhi_epu16(load(before + 4 * i), w0));
        }
        if constexpr (kAfter) {
            sum = _mm256_add_epi16(sum, _mm256_mulhi_epu16(load(after + 4 * i), w2));
        }
        return _mm256_srli_epi16(sum, 8);
    };
    const auto eight = [&](int i) {
        const __m256i packed = _mm256_packus_epi16(sum_at(i), sum_at(i + 4));
        return _mm256_permute4x64_epi64(packed, 0xD8);
    };
    int i = 0;
    for (; i + 8 <= count; i += 8) {
        _mm256_storeu_si256(reinterpret_cast<__m256i*>(out + i), eight(i));
    }
    if (i < count) {
        // Rows of 16-bit channels have slack to read; the picture has none to write.
        alignas(32) std::uint32_t last[8];
        _mm256_store_si256(reinterpret_cast<__m256i*>(last), eight(i));
        for (int k = 0; i < count; ++i, ++k) out[i] = last[k];
    }
}

void blend_any_avx2(const std::uint16_t* before, const std::uint16_t* at,
                    const std::uint16_t* after, const std::uint16_t weights[3], int count,
                    std::uint32_t* out) {
    if (before != nullptr && after != nullptr) {
        blend_rows_avx2<true, true>(before, at, after, weights, count, out);
    } else if (before != nullptr) {
        blend_rows_avx2<true, false>(before, at, after, weights, count, out);
    } else if (after != nullptr) {
        blend_rows_avx2<false, true>(before, at, after, weights, count, out);
    } else {
        blend_rows_avx2<false, false>(before, at, after, weights, count, out);
    }
}

}  // namespace

const Kernels& avx2() {
    static constexpr Kernels kKernels{replicate_row_avx2, blur_row_avx2, blend_any_avx2};
    return kKernels;
}

}  // namespace kino::zoom_rows
