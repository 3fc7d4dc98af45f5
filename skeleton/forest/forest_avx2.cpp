#include "skeleton/forest/forest_kernel.h"

#if defined(__x86_64__)
#include <immintrin.h>

namespace kino::forest {
namespace {

// Eight pixels on their way down the tree.
struct Eight {
    __m256i xy;
    __m256i scale;  // in both halves of each lane
    __m256i at;
};

struct Constants {
    __m256i last;     // max_x, max_y
    __m256i address;  // 1, pitch
    const int* depth;
};

__m256i sample(const Constants& c, __m256i xy, __m256i scale, __m256i offset) {
    // mulhrs is the kernel's rounding shift; saturation keeps far offsets outside.
    __m256i place = _mm256_adds_epi16(xy, _mm256_mulhrs_epi16(offset, scale));
    place = _mm256_min_epi16(_mm256_max_epi16(place, _mm256_setzero_si256()), c.last);
    const __m256i index = _mm256_madd_epi16(place, c.address);
    const __m256i pair = _mm256_i32gather_epi32(c.depth, index, 2);
    return _mm256_and_si256(pair, _mm256_set1_epi32(0xFFFF));
}

// A field of eight nodes each: loads and a transposition, since gathers cost a multiple of that on
// processors that guard them.
struct Nodes {
    __m256i u, v, threshold, child;
};

__m256i two(const WalkNode& low, const WalkNode& high) {
    return _mm256_inserti128_si256(
        _mm256_castsi128_si256(_mm_load_si128(reinterpret_cast<const __m128i*>(&low))),
        _mm_load_si128(reinterpret_cast<const __m128i*>(&high)), 1);
}

Nodes load_nodes(const WalkNode* nodes, __m256i at) {
    alignas(32) std::int32_t i[8];
    _mm256_store_si256(reinterpret_cast<__m256i*>(i), at);
    const __m256i a = two(nodes[i[0]], nodes[i[4]]);
    const __m256i b = two(nodes[i[1]], nodes[i[5]]);
    const __m256i c = two(nodes[i[2]], nodes[i[6]]);
    const __m256i d = two(nodes[i[3]], nodes[i[7]]);
    const __m256i ab_low = _mm256_unpacklo_epi32(a, b), ab_high = _mm256_unpackhi_epi32(a, b);
    const __m256i cd_low = _mm256_unpacklo_epi32(c, d), cd_high = _mm256_unpackhi_epi32(c, d);
    return {_mm256_unpacklo_epi64(ab_low, cd_low), _mm256_unpackhi_epi64(ab_low, cd_low),
            _mm256_unpacklo_epi64(ab_high, cd_high), _mm256_unpackhi_epi64(ab_high, cd_high)};
}

// One level down; true once all are on leaves.
bool step(const WalkNode* nodes, const Constants& c, Eight& p) {
    const Nodes n = load_nodes(nodes, p.at);
    const __m256i difference =
        _mm256_sub_epi32(sample(c, p.xy, p.scale, n.u), sample(c, p.xy, p.scale, n.v));
    // The comparison is -1 where true.
    const __m256i next = _mm256_sub_epi32(n.child, _mm256_cmpgt_epi32(difference, n.threshold));
    const __m256i same = _mm256_cmpeq_epi32(next, p.at);
    p.at = next;
    return _mm256_movemask_epi8(same) == -1;
}

Eight load(const WalkPixels& in, std::size_t i) {
    const __m256i scale =
        _mm256_cvtepu16_epi32(_mm_loadu_si128(reinterpret_cast<const __m128i*>(in.scale + i)));
    return {_mm256_loadu_si256(reinterpret_cast<const __m256i*>(in.xy + i)),
            _mm256_or_si256(scale, _mm256_slli_epi32(scale, 16)), _mm256_setzero_si256()};
}

void walk(const WalkNode* nodes, const WalkImage& image, const WalkPixels& in, std::int32_t* leaf) {
    const auto halves = [](std::int32_t low, std::int32_t high) {
        return _mm256_set1_epi32(low | high << 16);
    };
    const Constants c{halves(image.max_x, image.max_y), halves(1, image.pitch),
                      reinterpret_cast<const int*>(image.depth)};
    std::size_t i = 0;
    // Several chains at once hide each other's cache misses.
    for (; i + 32 <= in.count; i += 32) {
        Eight p[4] = {load(in, i), load(in, i + 8), load(in, i + 16), load(in, i + 24)};
        bool done = false;
        while (!done) {
            const bool d0 = step(nodes, c, p[0]);
            const bool d1 = step(nodes, c, p[1]);
            const bool d2 = step(nodes, c, p[2]);
            const bool d3 = step(nodes, c, p[3]);
            done = d0 && d1 && d2 && d3;
        }
        for (int k = 0; k < 4; ++k)
            _mm256_storeu_si256(reinterpret_cast<__m256i*>(leaf + i + 8 * k),
                                load_nodes(nodes, p[k].at).u);
    }
    for (; i + 8 <= in.count; i += 8) {
        Eight p = load(in, i);
        while (!step(nodes, c, p)) {
        }
        _mm256_storeu_si256(reinterpret_cast<__m256i*>(leaf + i), load_nodes(nodes, p.at).u);
    }
    portable_functions().walk(nodes, image, {in.xy + i, in.scale + i, in.count - i}, leaf + i);
}

// minpos finds the lowest index of the least, so it is given what is missing to all votes.
void vote(const VoteInput& in, std::size_t count, std::uint8_t* label, std::uint16_t* votes) {
    const int parts = in.stride / 8;
    const __m128i ones = _mm_set1_epi32(-1);
    for (std::size_t i = 0; i < count; ++i) {
        __m128i sum[4] = {};
        for (int t = 0; t < in.tree_count; ++t) {
            const std::uint8_t* row =
                in.distributions + static_cast<std::ptrdiff_t>(in.leaf[t][i]) * in.stride;
            for (int k = 0; k < parts; ++k)
                sum[k] = _mm_add_epi16(sum[k], _mm_cvtepu8_epi16(_mm_loadl_epi64(
                                                   reinterpret_cast<const __m128i*>(row + 8 * k))));
        }
        unsigned best = 0x10000, best_label = 0;
        for (int k = 0; k < parts; ++k) {
            const auto found = static_cast<unsigned>(
                _mm_cvtsi128_si32(_mm_minpos_epu16(_mm_xor_si128(sum[k], ones))));
            if ((found & 0xFFFF) < best) {
                best = found & 0xFFFF;
                best_label = static_cast<unsigned>(8 * k) + (found >> 16);
            }
        }
        label[i] = static_cast<std::uint8_t>(best_label);
        votes[i] = static_cast<std::uint16_t>(0xFFFF - best);
    }
}

void probe(const WalkImage& image, const ProbePixel& p, const std::uint32_t* u,
           const std::uint32_t* v, std::size_t count, std::int32_t* out) {
    const auto halves = [](std::int32_t low, std::int32_t high) {
        return _mm256_set1_epi32(low | high << 16);
    };
    const Constants c{halves(image.max_x, image.max_y), halves(1, image.pitch),
                      reinterpret_cast<const int*>(image.depth)};
    const __m256i xy = _mm256_set1_epi32(static_cast<std::int32_t>(p.xy));
    const __m256i scale = halves(p.scale, p.scale);
    const __m256i low = _mm256_set1_epi32(p.low), high = _mm256_set1_epi32(p.high);
    const auto load8 = [](const std::uint32_t* from) {
        return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(from));
    };
    const __m256i own = sample(c, xy, scale, _mm256_setzero_si256());
    for (std::size_t i = 0; i < count; i += 8) {
        const __m256i second = v == nullptr ? own : sample(c, xy, scale, load8(v + i));
        __m256i d = _mm256_sub_epi32(sample(c, xy, scale, load8(u + i)), second);
        d = _mm256_sub_epi32(_mm256_min_epi32(_mm256_max_epi32(d, low), high), low);
        _mm256_storeu_si256(reinterpret_cast<__m256i*>(out + i), d);
    }
}

}  // namespace

const Functions* avx2_functions() {
    static constexpr Functions kAvx2{walk, vote, probe, "avx2"};
    return &kAvx2;
}

}  // namespace kino::forest

#endif
