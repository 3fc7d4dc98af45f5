#include <immintrin.h>

#include "sensor/kinect1/unpack.h"

namespace kino::kinect1 {
namespace {

// Loads reach 16 bytes; the groups at the end whose loads would reach beyond the last packed byte
// go to the portable code.

// Eight values of eleven bits, from 16 readable bytes of which 11 count, as eight 32-bit lanes.
inline __m256i eight_of_eleven(const std::uint8_t* p) {
    const __m256i twice =
        _mm256_broadcastsi128_si256(_mm_loadu_si128(reinterpret_cast<const __m128i*>(p)));
    // Little-endian lanes of three bytes, last byte first; the eighth starts one byte early so
    // that its three bytes are there.
    const __m256i pick = _mm256_setr_epi8(2, 1, 0, -1, 3, 2, 1, -1, 4, 3, 2, -1, 6, 5, 4, -1,  //
                                          7, 6, 5, -1, 8, 7, 6, -1, 10, 9, 8, -1, 10, 9, 8, -1);
    const __m256i shift = _mm256_setr_epi32(13, 10, 7, 12, 9, 6, 11, 0);
    const __m256i lanes = _mm256_srlv_epi32(_mm256_shuffle_epi8(twice, pick), shift);
    return _mm256_and_si256(lanes, _mm256_set1_epi32(0x7FF));
}

void eleven(const std::uint8_t* p, std::size_t n, std::uint16_t* out) {
    std::size_t i = 0;
    // The second load of a round ends 27 bytes on; 32 values are 44 bytes.
    for (; i + 32 <= n; i += 16, p += 22, out += 16) {
        const __m256i packed = _mm256_packus_epi32(eight_of_eleven(p), eight_of_eleven(p + 11));
        _mm256_storeu_si256(reinterpret_cast<__m256i*>(out),
                            _mm256_permute4x64_epi64(packed, 0b11011000));
    }
    kPortableUnpacker.eleven(p, n - i, out);
}

// Sixteen values of ten bits from 26 readable bytes of which 20 count.
inline __m256i sixteen_of_ten(const std::uint8_t* p) {
    const __m256i bytes = _mm256_inserti128_si256(
        _mm256_castsi128_si256(_mm_loadu_si128(reinterpret_cast<const __m128i*>(p))),
        _mm_loadu_si128(reinterpret_cast<const __m128i*>(p + 10)), 1);
    const __m256i pick = _mm256_setr_epi8(1, 0, 2, 1, 3, 2, 4, 3, 6, 5, 7, 6, 8, 7, 9, 8,  //
                                          1, 0, 2, 1, 3, 2, 4, 3, 6, 5, 7, 6, 8, 7, 9, 8);
    // Multiplying shifts each lane by its own count: the ten bits come to stand first.
    const __m256i scale = _mm256_setr_epi16(1, 4, 16, 64, 1, 4, 16, 64, 1, 4, 16, 64, 1, 4, 16, 64);
    return _mm256_srli_epi16(_mm256_mullo_epi16(_mm256_shuffle_epi8(bytes, pick), scale), 6);
}

void ten(const std::uint8_t* p, std::size_t n, std::uint16_t* out) {
    std::size_t i = 0;
    for (; i + 32 <= n; i += 16, p += 20, out += 16) {
        _mm256_storeu_si256(reinterpret_cast<__m256i*>(out), sixteen_of_ten(p));
    }
    kPortableUnpacker.ten(p, n - i, out);
}

void ten_doubled(const std::uint8_t* p, std::size_t n, std::uint16_t* out) {
    std::size_t i = 0;
    for (; i + 32 <= n; i += 16, p += 20, out += 16) {
        const __m256i value = sixteen_of_ten(p);
        const __m256i none = _mm256_cmpeq_epi16(value, _mm256_set1_epi16(1023));  // -1 where true
        _mm256_storeu_si256(reinterpret_cast<__m256i*>(out),
                            _mm256_sub_epi16(_mm256_add_epi16(value, value), none));
    }
    kPortableUnpacker.ten_doubled(p, n - i, out);
}

}  // namespace

const Unpacker kAvx2Unpacker = {eleven, ten, ten_doubled, "avx2"};

}  // namespace kino::kinect1
