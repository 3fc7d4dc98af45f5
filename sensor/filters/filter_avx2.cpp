#include "sensor/filters/filter_kernel.h"

#if defined(__x86_64__)
#include <immintrin.h>

namespace kino::filters {
namespace {

// depth_filter.h says what a reading is; its inline functions must stay out of this file.
constexpr float kNearest = 1e-3f;
constexpr float kFarthest = 1e3f;

// The portable twin finishes what is left of a multiple of eight.
std::size_t whole_eights(std::size_t n) {
    return n & ~std::size_t{7};
}

__m256 all(float value) {
    return _mm256_set1_ps(value);
}
__m256 mul(__m256 a, __m256 b) {
    return _mm256_mul_ps(a, b);
}
__m256 add(__m256 a, __m256 b) {
    return _mm256_add_ps(a, b);
}
__m256 sub(__m256 a, __m256 b) {
    return _mm256_sub_ps(a, b);
}
__m256 both(__m256 a, __m256 b) {
    return _mm256_and_ps(a, b);
}
__m256 either(__m256 a, __m256 b) {
    return _mm256_or_ps(a, b);
}
__m256 is_reading(__m256 z) {
    return both(_mm256_cmp_ps(z, all(kNearest), _CMP_GE_OQ),
                _mm256_cmp_ps(z, all(kFarthest), _CMP_LE_OQ));
}

void invert(const float* z, std::size_t n, float* inverse) {
    const std::size_t end = whole_eights(n);
    for (std::size_t i = 0; i < end; i += 8) {
        const __m256 depth = _mm256_loadu_ps(z + i);
        const __m256 value = _mm256_div_ps(all(1.0f), depth);
        _mm256_storeu_ps(inverse + i, _mm256_blendv_ps(all(kNone), value, is_reading(depth)));
    }
    kPortable.invert(z + end, n - end, inverse + end);
}

void smooth(const Window& w, const float* inverse, const float* z, std::size_t n, float* out) {
    const __m256 zero = _mm256_setzero_ps();
    const __m256 one = all(1.0f);
    const __m256 scale = all(w.inverse_threshold);
    const std::size_t end = whole_eights(n);
    for (std::size_t i = 0; i < end; i += 8) {
        const __m256 centre = _mm256_loadu_ps(inverse + i);
        __m256 sum = zero;
        __m256 weight = one;
        for (int t = 0; t < w.taps; ++t) {
            const __m256 difference = sub(_mm256_loadu_ps(inverse + i + w.offsets[t]), centre);
            const __m256 u = mul(difference, scale);
            const __m256 q =
                mul(_mm256_max_ps(sub(one, mul(u, u)), zero), _mm256_broadcast_ss(w.weights + t));
            weight = add(weight, q);
            sum = add(sum, mul(q, difference));
        }
        const __m256 depth = _mm256_loadu_ps(z + i);
        const __m256 moved = _mm256_div_ps(depth, add(one, mul(_mm256_div_ps(sum, weight), depth)));
        _mm256_storeu_ps(out + i, both(moved, _mm256_cmp_ps(centre, zero, _CMP_GT_OQ)));
    }
    kPortable.smooth(w, inverse + end, z + end, n - end, out + end);
}

void support(const Support& s, const float* inverse, const float* z, std::size_t n, float* out) {
    const std::ptrdiff_t pairs[4] = {1, s.pitch, s.pitch + 1, s.pitch - 1};
    const __m256 zero = _mm256_setzero_ps();
    const __m256i minimum = _mm256_set1_epi32(s.minimum);
    const std::size_t end = whole_eights(n);
    for (std::size_t i = 0; i < end; i += 8) {
        const __m256 here = _mm256_loadu_ps(inverse + i);
        const __m256 limit = add(all(s.step), mul(all(s.slope), here));
        const __m256 below = sub(zero, limit);
        __m256i agreeing = _mm256_setzero_si256();
        __m256 between = zero;
        for (const std::ptrdiff_t offset : pairs) {
            const __m256 a = _mm256_loadu_ps(inverse + i - offset);
            const __m256 b = _mm256_loadu_ps(inverse + i + offset);
            const __m256 to_a = sub(a, here);
            const __m256 to_b = sub(b, here);
            const __m256 near_a = _mm256_cmp_ps(to_a, limit, _CMP_GT_OQ);
            const __m256 near_b = _mm256_cmp_ps(to_b, limit, _CMP_GT_OQ);
            const __m256 far_a = _mm256_cmp_ps(to_a, below, _CMP_LT_OQ);
            const __m256 far_b = _mm256_cmp_ps(to_b, below, _CMP_LT_OQ);
            const auto count = [&](__m256 nearer, __m256 farther) {
                // -1 where it agrees
                const __m256i differs = _mm256_castps_si256(either(nearer, farther));
                agreeing =
                    _mm256_sub_epi32(agreeing, _mm256_andnot_si256(differs, _mm256_set1_epi32(-1)));
            };
            count(near_a, far_a);
            count(near_b, far_b);
            const __m256 a_to_b = both(both(near_a, far_b), _mm256_cmp_ps(b, zero, _CMP_GT_OQ));
            const __m256 b_to_a = both(both(near_b, far_a), _mm256_cmp_ps(a, zero, _CMP_GT_OQ));
            between = either(between, either(a_to_b, b_to_a));
        }
        const __m256 weak = _mm256_castsi256_ps(_mm256_cmpgt_epi32(minimum, agreeing));
        const __m256 valid = _mm256_cmp_ps(here, zero, _CMP_GT_OQ);
        _mm256_storeu_ps(
            out + i, _mm256_andnot_ps(either(weak, between), both(valid, _mm256_loadu_ps(z + i))));
    }
    kPortable.support(s, inverse + end, z + end, n - end, out + end);
}

void blend(const Blend& b, const float* z, std::size_t n, const Memory& memory, float* out) {
    const __m256 zero = _mm256_setzero_ps();
    const __m256 one = all(1.0f);
    const __m256 running = _mm256_castsi256_ps(_mm256_set1_epi32(b.running ? -1 : 0));
    const __m256 soft = _mm256_castsi256_ps(_mm256_set1_epi32(b.soft ? -1 : 0));
    const __m256 alpha = all(b.alpha);
    const __m256i persistence = _mm256_set1_epi32(b.persistence);
    const std::size_t end = whole_eights(n);
    for (std::size_t i = 0; i < end; i += 8) {
        const __m256 depth = _mm256_loadu_ps(z + i);
        const __m256 seen = is_reading(depth);
        const __m256 held = _mm256_loadu_ps(memory.z + i);
        const __m256 frames = _mm256_loadu_ps(memory.frames + i);
        const __m256 known = _mm256_cmp_ps(held, zero, _CMP_GT_OQ);

        const __m256 difference = _mm256_div_ps(sub(held, depth), mul(held, depth));
        const __m256 u = mul(difference, all(b.inverse_threshold));
        const __m256 square = mul(u, u);
        const __m256 small = _mm256_cmp_ps(square, one, _CMP_LT_OQ);
        const __m256 capped = _mm256_blendv_ps(one, mul(square, square), small);
        const __m256 stepped = _mm256_blendv_ps(one, zero, small);
        const __m256 novelty = _mm256_blendv_ps(stepped, capped, soft);
        const __m256 mean = _mm256_div_ps(one, add(frames, one));
        const __m256 gain = _mm256_blendv_ps(alpha, _mm256_max_ps(mean, alpha), running);
        const __m256 step = add(gain, mul(sub(one, gain), novelty));
        const __m256 same = both(known, _mm256_cmp_ps(novelty, one, _CMP_LT_OQ));
        const __m256 grown = _mm256_min_ps(add(mul(frames, sub(one, novelty)), one), all(b.most));
        const __m256 count = _mm256_blendv_ps(one, grown, same);
        const __m256 mixed = _mm256_div_ps(held, add(one, mul(mul(step, difference), held)));
        const __m256 mixes = both(same, _mm256_cmp_ps(step, one, _CMP_LT_OQ));
        const __m256 next = _mm256_blendv_ps(depth, mixed, mixes);

        const __m256i unseen = _mm256_add_epi32(
            _mm256_loadu_si256(reinterpret_cast<const __m256i*>(memory.unseen + i)),
            _mm256_set1_epi32(1));
        const __m256 late = _mm256_castsi256_ps(_mm256_cmpgt_epi32(unseen, persistence));
        const __m256 keep = _mm256_andnot_ps(late, known);
        const __m256 value = _mm256_blendv_ps(both(held, keep), next, seen);
        const __m256 waits = _mm256_andnot_ps(seen, keep);
        _mm256_storeu_si256(reinterpret_cast<__m256i*>(memory.unseen + i),
                            _mm256_and_si256(unseen, _mm256_castps_si256(waits)));
        _mm256_storeu_ps(memory.frames + i, _mm256_blendv_ps(both(frames, keep), count, seen));
        _mm256_storeu_ps(memory.z + i, value);
        _mm256_storeu_ps(out + i, value);
    }
    kPortable.blend(b, z + end, n - end, {memory.z + end, memory.frames + end, memory.unseen + end},
                    out + end);
}

void classify(const float* z, std::size_t n, float* out, std::uint64_t* bits) {
    const std::size_t end = n & ~std::size_t{63};
    for (std::size_t first = 0; first < end; first += 64) {
        std::uint64_t word = 0;
        for (std::size_t i = 0; i < 64; i += 8) {
            const __m256 depth = _mm256_loadu_ps(z + first + i);
            const __m256 reading = is_reading(depth);
            _mm256_storeu_ps(out + first + i, both(depth, reading));
            word |= static_cast<std::uint64_t>(_mm256_movemask_ps(reading)) << i;
        }
        bits[first / 64] = word;
    }
    kPortable.classify(z + end, n - end, out + end, bits + end / 64);
}

// Elements 0, 2, 4 ... or 1, 3, 5 ... of sixteen.
__m256 evens(__m256 a, __m256 b) {
    return _mm256_castpd_ps(
        _mm256_permute4x64_pd(_mm256_castps_pd(_mm256_shuffle_ps(a, b, 0x88)), 0xD8));
}
__m256 odds(__m256 a, __m256 b) {
    return _mm256_castpd_ps(
        _mm256_permute4x64_pd(_mm256_castps_pd(_mm256_shuffle_ps(a, b, 0xDD)), 0xD8));
}

void order(__m256& a, __m256& b) {
    const __m256 low = _mm256_min_ps(a, b);
    b = _mm256_max_ps(a, b);
    a = low;
}

void halve(const Halve& h, const float* upper, const float* lower, std::size_t n, float* out) {
    const __m256 one = all(1.0f);
    const __m256 zero = _mm256_setzero_ps();
    const __m256 empty = all(__builtin_inff());
    const std::size_t end = whole_eights(n);
    for (std::size_t i = 0; i < end; i += 8) {
        const __m256 upper_a = _mm256_loadu_ps(upper + 2 * i);
        const __m256 upper_b = _mm256_loadu_ps(upper + 2 * i + 8);
        const __m256 lower_a = _mm256_loadu_ps(lower + 2 * i);
        const __m256 lower_b = _mm256_loadu_ps(lower + 2 * i + 8);
        __m256 z[4] = {evens(upper_a, upper_b), odds(upper_a, upper_b), evens(lower_a, lower_b),
                       odds(lower_a, lower_b)};
        __m256i count = _mm256_setzero_si256();
        for (__m256& value : z) {
            const __m256 reading = is_reading(value);
            count = _mm256_sub_epi32(count, _mm256_castps_si256(reading));
            value = _mm256_blendv_ps(empty, value, reading);
        }
        order(z[0], z[1]);
        order(z[2], z[3]);
        order(z[0], z[2]);
        order(z[1], z[3]);
        order(z[1], z[2]);
        const __m256i most = _mm256_cmpgt_epi32(count, _mm256_set1_epi32(2));
        const __m256 median = _mm256_blendv_ps(z[0], z[1], _mm256_castsi256_ps(most));
        __m256 sum = zero;
        __m256 used = zero;
        for (const __m256 value : z) {
            const __m256 difference = _mm256_div_ps(sub(median, value), mul(median, value));
            const __m256 near = both(_mm256_cmp_ps(difference, all(h.threshold), _CMP_LE_OQ),
                                     _mm256_cmp_ps(difference, all(-h.threshold), _CMP_GE_OQ));
            sum = add(sum, both(difference, near));
            used = add(used, both(one, near));
        }
        const __m256 mean = _mm256_div_ps(median, add(one, mul(_mm256_div_ps(sum, used), median)));
        const std::int32_t least = h.readings > 1 ? h.readings : 1;
        const __m256i enough = _mm256_cmpgt_epi32(count, _mm256_set1_epi32(least - 1));
        _mm256_storeu_ps(out + i, both(mean, _mm256_castsi256_ps(enough)));
    }
    kPortable.halve(h, upper + 2 * end, lower + 2 * end, n - end, out + end);
}

}  // namespace

const Functions kAvx2 = {invert, smooth, support, blend, classify, halve, "avx2"};

}  // namespace kino::filters
#endif
