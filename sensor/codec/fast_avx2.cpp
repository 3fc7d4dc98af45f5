#include <immintrin.h>

#include "sensor/codec/fast_kernels.h"

namespace kino::fast {
namespace {

__m256i load(const std::uint16_t* from) {
    return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(from));
}

void store(std::uint16_t* to, __m256i value) {
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(to), value);
}

/// For each set of lanes that take a word: which of the words at hand (the low end for reading).
struct Permutations {
    alignas(32) std::uint32_t expand[256][8];
    /// Lanes of the set moved to the upper end, in order.
    alignas(32) std::uint32_t compact[256][8];
};

constexpr Permutations make_permutations() {
    Permutations out{};
    for (unsigned set = 0; set < 256; ++set) {
        unsigned count = 0;
        for (unsigned lane = 0; lane < 8; ++lane) {
            out.expand[set][lane] = count;
            count += set >> lane & 1;
        }
        unsigned place = 8 - count;
        for (unsigned lane = 0; lane < 8; ++lane) {
            if (set >> lane & 1) out.compact[set][place++] = lane;
        }
    }
    return out;
}

constexpr Permutations kPermutations = make_permutations();

__m256i permutation(const std::uint32_t (&table)[256][8], unsigned set) {
    return _mm256_load_si256(reinterpret_cast<const __m256i*>(table[set]));
}

/// Eight rows of eight values each, turned.
void transpose8(__m128i (&r)[8]) {
    __m128i a[8];
    for (int i = 0; i < 4; ++i) {
        a[2 * i] = _mm_unpacklo_epi16(r[2 * i], r[2 * i + 1]);
        a[2 * i + 1] = _mm_unpackhi_epi16(r[2 * i], r[2 * i + 1]);
    }
    __m128i b[8];
    for (int i = 0; i < 2; ++i) {
        for (int j = 0; j < 2; ++j) {
            b[4 * i + 2 * j] = _mm_unpacklo_epi32(a[4 * i + j], a[4 * i + j + 2]);
            b[4 * i + 2 * j + 1] = _mm_unpackhi_epi32(a[4 * i + j], a[4 * i + j + 2]);
        }
    }
    for (int i = 0; i < 4; ++i) {
        r[2 * i] = _mm_unpacklo_epi64(b[i], b[i + 4]);
        r[2 * i + 1] = _mm_unpackhi_epi64(b[i], b[i + 4]);
    }
}

void to_stripes(const std::uint16_t* plane, int height, Stripes stripes, std::uint16_t* indices) {
    const int width = stripes.width;
    for (int row = 0; row < stripes.rows; ++row) {
        std::uint16_t* out = indices + static_cast<std::size_t>(row) * width * kLanes;
        for (int half = 0; half < kLanes; half += 8) {
            const std::uint16_t* in[8];
            for (int i = 0; i < 8; ++i) {
                const int y = (half + i) * stripes.rows + row;
                in[i] = y < height ? plane + static_cast<std::size_t>(y) * width : nullptr;
            }
            int x = 0;
            for (; x + 8 <= width; x += 8) {
                __m128i r[8];
                for (int i = 0; i < 8; ++i) {
                    r[i] = in[i] == nullptr
                               ? _mm_setzero_si128()
                               : _mm_loadu_si128(reinterpret_cast<const __m128i*>(in[i] + x));
                }
                transpose8(r);
                for (int i = 0; i < 8; ++i) {
                    _mm_storeu_si128(reinterpret_cast<__m128i*>(out + (x + i) * kLanes + half),
                                     r[i]);
                }
            }
            for (; x < width; ++x) {
                for (int i = 0; i < 8; ++i) {
                    out[x * kLanes + half + i] = in[i] == nullptr ? std::uint16_t{0} : in[i][x];
                }
            }
        }
    }
}

void from_stripes(const std::uint16_t* indices, int height, Stripes stripes, std::uint16_t* plane) {
    const int width = stripes.width;
    for (int row = 0; row < stripes.rows; ++row) {
        const std::uint16_t* in = indices + static_cast<std::size_t>(row) * width * kLanes;
        for (int half = 0; half < kLanes; half += 8) {
            int used = 0;
            std::uint16_t* out[8];
            for (int i = 0; i < 8; ++i) {
                const int y = (half + i) * stripes.rows + row;
                out[i] = plane + static_cast<std::size_t>(y < height ? y : 0) * width;
                if (y < height) used = i + 1;
            }
            int x = 0;
            for (; x + 8 <= width; x += 8) {
                __m128i r[8];
                for (int i = 0; i < 8; ++i) {
                    r[i] = _mm_loadu_si128(
                        reinterpret_cast<const __m128i*>(in + (x + i) * kLanes + half));
                }
                transpose8(r);
                for (int i = 0; i < used; ++i) {
                    _mm_storeu_si128(reinterpret_cast<__m128i*>(out[i] + x), r[i]);
                }
            }
            for (; x < width; ++x) {
                for (int i = 0; i < used; ++i) out[i][x] = in[x * kLanes + half + i];
            }
        }
    }
}

__m256i distance(__m256i a, __m256i b) {
    return _mm256_sub_epi16(_mm256_max_epu16(a, b), _mm256_min_epu16(a, b));
}

/// The neighbours of a step, one stripe a lane, and the running state of the walk.
struct Walk {
    __m256i w = _mm256_setzero_si256();
    __m256i w_hole = _mm256_set1_epi16(-1);
    __m256i above_left = _mm256_setzero_si256();
    __m256i prediction = _mm256_setzero_si256();
    __m256i context = _mm256_setzero_si256();
};

/// Prediction and context of the step at column x, as predict() and context_of() have them.
inline void look(Walk& walk, bool first_row, int x, int width, const std::uint16_t* above,
                 const std::uint16_t* above_hole, __m128i shift, __m256i activity_table) {
    __m256i n = walk.w;
    __m256i n_hole = walk.w_hole;
    __m256i nw = walk.w;
    __m256i ne = walk.w;
    if (!first_row) {
        n = load(above + x * kLanes);
        n_hole = load(above_hole + x * kLanes);
        ne = x + 1 < width ? load(above + (x + 1) * kLanes) : n;
        nw = walk.above_left;
        if (x == 0) {
            nw = n;
            walk.w = n;
            walk.w_hole = n_hole;
        }
    }
    walk.above_left = n;
    const __m256i w = walk.w;
    // What needs no left neighbour comes first: the left one is what everything waits for.
    const __m256i above_activity = _mm256_adds_epu16(distance(nw, n), distance(ne, n));
    const __m256i low = _mm256_min_epu16(w, n);
    const __m256i high = _mm256_max_epu16(w, n);
    const __m256i gradient = _mm256_add_epi16(w, _mm256_sub_epi16(n, nw));
    const __m256i at_least_high = _mm256_cmpeq_epi16(_mm256_max_epu16(nw, high), nw);
    const __m256i at_most_low = _mm256_cmpeq_epi16(_mm256_min_epu16(nw, low), nw);
    walk.prediction =
        _mm256_blendv_epi8(_mm256_blendv_epi8(gradient, high, at_most_low), low, at_least_high);
    const __m256i activity =
        _mm256_srl_epi16(_mm256_adds_epu16(above_activity, distance(w, nw)), shift);
    // The upper bytes ask for entry 0, which holds 0.
    const __m256i busy =
        _mm256_shuffle_epi8(activity_table, _mm256_min_epu16(activity, _mm256_set1_epi16(15)));
    const __m256i beside = _mm256_or_si256(_mm256_and_si256(walk.w_hole, _mm256_set1_epi16(1)),
                                           _mm256_and_si256(n_hole, _mm256_set1_epi16(2)));
    walk.context = _mm256_blendv_epi8(busy, _mm256_add_epi16(beside, _mm256_set1_epi16(6)),
                                      _mm256_or_si256(walk.w_hole, n_hole));
}

__m256i activity_table() {
    return _mm256_broadcastsi128_si256(
        _mm_loadu_si128(reinterpret_cast<const __m128i*>(kActivityContext)));
}

std::size_t make_tokens(const TokenJob& job) {
    const __m256i table = activity_table();
    const __m128i shift = _mm_cvtsi32_si128(job.shift);
    const int width = job.stripes.width;
    const __m256i zero = _mm256_setzero_si256();
    const std::uint16_t* in = job.indices;
    std::uint16_t* out = job.tokens;
    std::size_t escapes = 0;
    Walk walk;
    for (int row = 0; row < job.stripes.rows; ++row) {
        for (int x = 0; x < width; ++x, in += kLanes, out += kLanes) {
            look(walk, row == 0, x, width, job.above, job.above_hole, shift, table);
            const __m256i index = load(in);
            const __m256i hole = _mm256_cmpeq_epi16(index, zero);
            const __m256i residual = _mm256_sub_epi16(index, walk.prediction);
            const __m256i zigzag =
                _mm256_xor_si256(_mm256_slli_epi16(residual, 1), _mm256_srai_epi16(residual, 15));
            const __m256i direct_end = _mm256_set1_epi16(kDirect);
            const __m256i large = _mm256_andnot_si256(
                hole, _mm256_cmpeq_epi16(_mm256_max_epu16(zigzag, direct_end), zigzag));
            const __m256i symbol =
                _mm256_andnot_si256(hole, _mm256_add_epi16(zigzag, _mm256_set1_epi16(1)));
            const __m256i base = _mm256_slli_epi16(walk.context, 6);
            store(out, _mm256_add_epi16(base, symbol));
            unsigned set = static_cast<unsigned>(_mm256_movemask_epi8(large)) & 0x55555555;
            if (set != 0) {
                alignas(32) std::uint16_t value[kLanes];
                alignas(32) std::uint16_t first[kLanes];
                store(value, zigzag);
                store(first, base);
                for (; set != 0; set &= set - 1) {
                    const int stripe = __builtin_ctz(set) / 2;
                    const unsigned escape = value[stripe] - kDirect + 1u;
                    job.escapes[escapes++] = static_cast<std::uint16_t>(escape);
                    out[stripe] = static_cast<std::uint16_t>(first[stripe] + 1 + kDirect + 31 -
                                                             __builtin_clz(escape));
                }
            }
            walk.w = _mm256_blendv_epi8(index, walk.prediction, hole);
            walk.w_hole = hole;
            store(job.above + x * kLanes, walk.w);
            store(job.above_hole + x * kLanes, hole);
        }
    }
    return escapes;
}

/// floor(x / frequency) of eight lanes, x < 2^31: doubles hold it exactly.
__m256i divide(__m256i x, __m256i frequency) {
    const auto half = [](__m128i a, __m128i b) {
        return _mm256_cvttpd_epi32(_mm256_div_pd(_mm256_cvtepi32_pd(a), _mm256_cvtepi32_pd(b)));
    };
    const __m128i low = half(_mm256_castsi256_si128(x), _mm256_castsi256_si128(frequency));
    const __m128i high =
        half(_mm256_extracti128_si256(x, 1), _mm256_extracti128_si256(frequency, 1));
    return _mm256_inserti128_si256(_mm256_castsi128_si256(low), high, 1);
}

inline __m256i encode_eight(__m256i x, __m256i entry, std::uint8_t*& out) {
    const __m256i frequency = _mm256_and_si256(entry, _mm256_set1_epi32(0xFFFF));
    const __m256i stays =
        _mm256_cmpgt_epi32(frequency, _mm256_srli_epi32(x, 31 - kProbabilityBits));
    const unsigned set =
        ~static_cast<unsigned>(_mm256_movemask_ps(_mm256_castsi256_ps(stays))) & 0xFF;
    const __m256i leaving =
        _mm256_and_si256(_mm256_permutevar8x32_epi32(x, permutation(kPermutations.compact, set)),
                         _mm256_set1_epi32(0xFFFF));
    const __m128i words =
        _mm_packus_epi32(_mm256_castsi256_si128(leaving), _mm256_extracti128_si256(leaving, 1));
    _mm_storeu_si128(reinterpret_cast<__m128i*>(out - 16), words);
    out -= 2 * __builtin_popcount(set);
    x = _mm256_blendv_epi8(_mm256_srli_epi32(x, 16), x, stays);
    const __m256i quotient = divide(x, frequency);
    const __m256i rest = _mm256_sub_epi32(x, _mm256_mullo_epi32(quotient, frequency));
    return _mm256_add_epi32(_mm256_slli_epi32(quotient, kProbabilityBits),
                            _mm256_add_epi32(rest, _mm256_srli_epi32(entry, 16)));
}

/// States by stripe to the two registers of the stream's order, and back.
struct States {
    __m256i first, second;
};

States load_states(const std::uint32_t* states) {
    const auto four = [&](int i) {
        return _mm_loadu_si128(reinterpret_cast<const __m128i*>(states + i));
    };
    return {_mm256_set_m128i(four(8), four(0)), _mm256_set_m128i(four(12), four(4))};
}

void store_states(std::uint32_t* to, const States& from) {
    const auto four = [&](int i, __m128i value) {
        _mm_storeu_si128(reinterpret_cast<__m128i*>(to + i), value);
    };
    four(0, _mm256_castsi256_si128(from.first));
    four(4, _mm256_castsi256_si128(from.second));
    four(8, _mm256_extracti128_si256(from.first, 1));
    four(12, _mm256_extracti128_si256(from.second, 1));
}

std::uint8_t* encode(const EncodeJob& job) {
    States states{_mm256_set1_epi32(kStateFloor), _mm256_set1_epi32(kStateFloor)};
    std::uint8_t* out = job.words_end;
    const __m256i zero = _mm256_setzero_si256();
    const auto* entries = reinterpret_cast<const int*>(job.entries);
    for (std::size_t step = job.steps; step-- > 0;) {
        const __m256i tokens = load(job.tokens + step * kLanes);
        const __m256i first =
            _mm256_i32gather_epi32(entries, _mm256_unpacklo_epi16(tokens, zero), 4);
        const __m256i second =
            _mm256_i32gather_epi32(entries, _mm256_unpackhi_epi16(tokens, zero), 4);
        states.second = encode_eight(states.second, second, out);
        states.first = encode_eight(states.first, first, out);
    }
    store_states(job.states, states);
    return out;
}

inline __m256i refill(__m256i x, const std::uint8_t*& words) {
    const __m256i low = _mm256_cmpgt_epi32(_mm256_set1_epi32(kStateFloor), x);
    const unsigned set = static_cast<unsigned>(_mm256_movemask_ps(_mm256_castsi256_ps(low)));
    const __m256i next =
        _mm256_cvtepu16_epi32(_mm_loadu_si128(reinterpret_cast<const __m128i*>(words)));
    const __m256i own = _mm256_permutevar8x32_epi32(next, permutation(kPermutations.expand, set));
    words += 2 * __builtin_popcount(set);
    return _mm256_blendv_epi8(x, _mm256_or_si256(_mm256_slli_epi32(x, 16), own), low);
}

inline __m256i advance(__m256i x, __m256i slot) {
    const __m256i frequency =
        _mm256_and_si256(_mm256_srli_epi32(slot, kProbabilityBits), _mm256_set1_epi32(0x7FF));
    const __m256i offset = _mm256_and_si256(slot, _mm256_set1_epi32((1 << kProbabilityBits) - 1));
    return _mm256_add_epi32(_mm256_mullo_epi32(frequency, _mm256_srli_epi32(x, kProbabilityBits)),
                            offset);
}

inline __m256i find(const std::uint32_t* slots, __m256i context, __m256i x) {
    const __m256i place =
        _mm256_or_si256(_mm256_slli_epi32(context, kProbabilityBits),
                        _mm256_and_si256(x, _mm256_set1_epi32((1 << kProbabilityBits) - 1)));
    return _mm256_i32gather_epi32(reinterpret_cast<const int*>(slots), place, 4);
}

/// Zigzag residuals of the lanes in `set`, whose classes stand in `zigzag`.
__m256i read_escapes(const DecodeJob& job, unsigned set, __m256i zigzag, std::size_t& at) {
    alignas(32) std::uint16_t value[kLanes];
    store(value, zigzag);
    for (; set != 0; set &= set - 1) {
        const int stripe = __builtin_ctz(set) / 2;
        const unsigned bits = value[stripe] - kDirect;
        std::uint32_t raw = 0;
        __builtin_memcpy(&raw, job.escapes + at / 8, 4);
        raw = raw >> at % 8 & ((1u << bits) - 1);
        at += bits;
        value[stripe] = static_cast<std::uint16_t>((1u << bits) + raw - 1 + kDirect);
    }
    return load(value);
}

Decoded decode(const DecodeJob& job) {
    const __m256i table = activity_table();
    const __m128i shift = _mm_cvtsi32_si128(job.shift);
    const __m256i zero = _mm256_setzero_si256();
    const int width = job.stripes.width;
    States states = load_states(job.states);
    __m256i largest = zero;
    const std::uint8_t* words = job.words;
    std::uint16_t* out = job.indices;
    Decoded decoded;
    Walk walk;
    for (int row = 0; row < job.stripes.rows; ++row) {
        for (int x = 0; x < width; ++x, out += kLanes) {
            look(walk, row == 0, x, width, job.above, job.above_hole, shift, table);
            const __m256i first =
                find(job.slots, _mm256_unpacklo_epi16(walk.context, zero), states.first);
            const __m256i second =
                find(job.slots, _mm256_unpackhi_epi16(walk.context, zero), states.second);
            states.first = refill(advance(states.first, first), words);
            states.second = refill(advance(states.second, second), words);
            const __m256i symbol =
                _mm256_packus_epi32(_mm256_srli_epi32(first, 21), _mm256_srli_epi32(second, 21));
            const __m256i hole = _mm256_cmpeq_epi16(symbol, zero);
            __m256i zigzag = _mm256_sub_epi16(symbol, _mm256_set1_epi16(1));
            const __m256i large = _mm256_cmpgt_epi16(symbol, _mm256_set1_epi16(kDirect));
            const unsigned set = static_cast<unsigned>(_mm256_movemask_epi8(large)) & 0x55555555;
            if (set != 0) zigzag = read_escapes(job, set, zigzag, decoded.escape_bits);
            const __m256i sign =
                _mm256_sub_epi16(zero, _mm256_and_si256(zigzag, _mm256_set1_epi16(1)));
            const __m256i residual = _mm256_xor_si256(_mm256_srli_epi16(zigzag, 1), sign);
            const __m256i value = _mm256_add_epi16(walk.prediction, residual);
            walk.w = _mm256_blendv_epi8(value, walk.prediction, hole);
            walk.w_hole = hole;
            store(job.above + x * kLanes, walk.w);
            store(job.above_hole + x * kLanes, hole);
            const __m256i index = _mm256_andnot_si256(hole, value);
            largest = _mm256_max_epu16(largest, index);
            store(out, index);
            if (words > job.words_end || decoded.escape_bits > job.escape_bits) return decoded;
        }
    }
    store_states(job.states, states);
    decoded.word_bytes = static_cast<std::size_t>(words - job.words);
    decoded.whole = true;
    alignas(32) std::uint16_t each[kLanes];
    store(each, largest);
    for (const std::uint16_t index : each) {
        if (index > decoded.largest) decoded.largest = index;
    }
    return decoded;
}

std::uint32_t crc32c(const std::uint8_t* data, std::size_t bytes) {
    std::uint64_t crc = 0xFFFFFFFF;
    std::size_t i = 0;
    for (; i + 8 <= bytes; i += 8) {
        std::uint64_t eight = 0;
        __builtin_memcpy(&eight, data + i, 8);
        crc = _mm_crc32_u64(crc, eight);
    }
    for (; i < bytes; ++i) crc = _mm_crc32_u8(static_cast<std::uint32_t>(crc), data[i]);
    return ~static_cast<std::uint32_t>(crc);
}

}  // namespace

const Kernels kAvx2Kernels = {&to_stripes, &from_stripes, &make_tokens, &encode, &decode, &crc32c};

}  // namespace kino::fast
