#include <algorithm>
#include <array>
#include <bit>
#include <cstdlib>
#include <cstring>

#include "sensor/codec/fast_kernels.h"

static_assert(std::endian::native == std::endian::little);

namespace kino::fast {
namespace {

constexpr std::uint32_t kMask = (1u << kProbabilityBits) - 1;

void to_stripes(const std::uint16_t* plane, int height, Stripes stripes, std::uint16_t* indices) {
    const auto [width, rows] = stripes;
    for (int row = 0; row < rows; ++row) {
        for (int stripe = 0; stripe < kLanes; ++stripe) {
            const int y = stripe * rows + row;
            std::uint16_t* out = indices + static_cast<std::size_t>(row) * width * kLanes + stripe;
            const std::uint16_t* in = plane + static_cast<std::size_t>(y) * width;
            for (int x = 0; x < width; ++x) out[x * kLanes] = y < height ? in[x] : 0;
        }
    }
}

void from_stripes(const std::uint16_t* indices, int height, Stripes stripes, std::uint16_t* plane) {
    const auto [width, rows] = stripes;
    for (int y = 0; y < height; ++y) {
        const std::uint16_t* in =
            indices + static_cast<std::size_t>(y % rows) * width * kLanes + y / rows;
        std::uint16_t* out = plane + static_cast<std::size_t>(y) * width;
        for (int x = 0; x < width; ++x) out[x] = in[x * kLanes];
    }
}

/// What is known of one stripe before a pixel: neighbours to the left, above left, above and above
/// right, and which of left and above are holes.
struct Neighbours {
    std::uint16_t w, nw, n, ne;
    bool w_hole, n_hole;
};

std::uint16_t predict(const Neighbours& a) {
    const std::uint16_t low = std::min(a.w, a.n);
    const std::uint16_t high = std::max(a.w, a.n);
    if (a.nw >= high) return low;
    if (a.nw <= low) return high;
    return static_cast<std::uint16_t>(a.w + a.n - a.nw);
}

int context_of(const Neighbours& a, int shift) {
    if (a.w_hole || a.n_hole) return 6 + (a.w_hole ? 1 : 0) + (a.n_hole ? 2 : 0);
    const int activity =
        std::min(std::abs(a.nw - a.n) + std::abs(a.ne - a.n) + std::abs(a.w - a.nw), 65535);
    return kActivityContext[std::min(activity >> shift, 15)];
}

/// Walks the pixels of all stripes in stream order. At each, visit(i, stripe, prediction, context)
/// answers what stands there for the neighbours to come.
struct Seen {
    std::uint16_t value;
    bool hole;
};

template <class Visit, class EndStep>
bool walk(Stripes stripes, int shift, std::uint16_t* above, std::uint16_t* above_hole, Visit visit,
          EndStep end_step) {
    const auto [width, rows] = stripes;
    std::array<Seen, kLanes> left{};
    std::array<std::uint16_t, kLanes> above_left{};
    for (auto& seen : left) seen.hole = true;
    std::size_t i = 0;
    for (int row = 0; row < rows; ++row) {
        for (int x = 0; x < width; ++x) {
            for (int stripe = 0; stripe < kLanes; ++stripe, ++i) {
                const int at = x * kLanes + stripe;
                Seen& w = left[stripe];
                Neighbours near{w.value, w.value, w.value, w.value, w.hole, w.hole};
                if (row > 0) {
                    near.n = above[at];
                    near.n_hole = above_hole[at] != 0;
                    near.nw = x > 0 ? above_left[stripe] : near.n;
                    near.ne = x + 1 < width ? above[at + kLanes] : near.n;
                    if (x == 0) {
                        near.w = near.n;
                        near.w_hole = near.n_hole;
                    }
                }
                above_left[stripe] = near.n;
                w = visit(i, stripe, predict(near), context_of(near, shift));
                above[at] = w.value;
                above_hole[at] = w.hole ? 0xFFFF : 0;
            }
            if (!end_step()) return false;
        }
    }
    return true;
}

std::size_t make_tokens(const TokenJob& job) {
    std::size_t escapes = 0;
    walk(
        job.stripes, job.shift, job.above, job.above_hole,
        [&](std::size_t i, int, std::uint16_t prediction, int context) {
            const std::uint16_t index = job.indices[i];
            int symbol = 0;
            if (index != 0) {
                const auto residual =
                    static_cast<std::int16_t>(static_cast<std::uint16_t>(index - prediction));
                const int zigzag = static_cast<std::uint16_t>(residual * 2 ^ residual >> 15);
                symbol = 1 + zigzag;
                if (zigzag >= kDirect) {
                    const auto escape = static_cast<std::uint16_t>(zigzag - kDirect + 1);
                    job.escapes[escapes++] = escape;
                    symbol = 1 + kDirect + std::bit_width(escape) - 1;
                }
            }
            job.tokens[i] = static_cast<std::uint16_t>(context * kSymbols + symbol);
            return Seen{index != 0 ? index : prediction, index == 0};
        },
        [] { return true; });
    return escapes;
}

std::uint8_t* encode(const EncodeJob& job) {
    std::fill_n(job.states, kLanes, kStateFloor);
    std::uint8_t* out = job.words_end;
    for (std::size_t step = job.steps; step-- > 0;) {
        for (int i = kLanes; i-- > 0;) {
            const int stripe = kStreamOrder[i];
            const std::uint32_t entry = job.entries[job.tokens[step * kLanes + stripe]];
            const std::uint32_t frequency = entry & 0xFFFF;
            std::uint32_t x = job.states[stripe];
            if (x >> (31 - kProbabilityBits) >= frequency) {
                const auto word = static_cast<std::uint16_t>(x);
                out -= 2;
                std::memcpy(out, &word, 2);
                x >>= 16;
            }
            job.states[stripe] =
                (x / frequency << kProbabilityBits) + x % frequency + (entry >> 16);
        }
    }
    return out;
}

Decoded decode(const DecodeJob& job) {
    Decoded out;
    const std::uint8_t* words = job.words;
    out.whole = walk(
        job.stripes, job.shift, job.above, job.above_hole,
        [&](std::size_t i, int stripe, std::uint16_t prediction, int context) {
            std::uint32_t& x = job.states[stripe];
            const std::uint32_t slot =
                job.slots[static_cast<std::uint32_t>(context) << kProbabilityBits | (x & kMask)];
            x = (slot >> kProbabilityBits & 0x7FF) * (x >> kProbabilityBits) + (slot & kMask);
            const int symbol = static_cast<int>(slot >> 21);
            Seen seen{prediction, symbol == 0};
            if (symbol > 0) {
                int zigzag = symbol - 1;
                if (zigzag >= kDirect) {
                    const int bits = zigzag - kDirect;
                    std::uint32_t raw = 0;
                    std::memcpy(&raw, job.escapes + out.escape_bits / 8, 4);
                    raw = raw >> out.escape_bits % 8 & ((1u << bits) - 1);
                    out.escape_bits += bits;
                    zigzag = static_cast<std::uint16_t>((1u << bits) + raw - 1 + kDirect);
                }
                seen.value = static_cast<std::uint16_t>(prediction + (zigzag >> 1 ^ -(zigzag & 1)));
            }
            job.indices[i] = symbol == 0 ? 0 : seen.value;
            out.largest = std::max(out.largest, job.indices[i]);
            return seen;
        },
        [&] {
            for (const int stripe : kStreamOrder) {
                std::uint32_t& x = job.states[stripe];
                if (x >= kStateFloor) continue;
                std::uint16_t word = 0;
                std::memcpy(&word, words, 2);
                words += 2;
                x = x << 16 | word;
            }
            return words <= job.words_end && out.escape_bits <= job.escape_bits;
        });
    out.word_bytes = static_cast<std::size_t>(words - job.words);
    return out;
}

/// Castagnoli's polynomial, reflected: the one of RFC 3720 and of SSE 4.2.
constexpr auto kCrcTable = [] {
    std::array<std::uint32_t, 256> table{};
    for (std::uint32_t byte = 0; byte < 256; ++byte) {
        std::uint32_t crc = byte;
        for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ (crc & 1 ? 0x82F63B78u : 0);
        table[byte] = crc;
    }
    return table;
}();

std::uint32_t crc32c(const std::uint8_t* data, std::size_t bytes) {
    std::uint32_t crc = 0xFFFFFFFF;
    for (std::size_t i = 0; i < bytes; ++i) crc = crc >> 8 ^ kCrcTable[(crc ^ data[i]) & 0xFF];
    return ~crc;
}

}  // namespace

const Kernels kPortableKernels = {&to_stripes, &from_stripes, &make_tokens,
                                  &encode,     &decode,       &crc32c};

}  // namespace kino::fast
