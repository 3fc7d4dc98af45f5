#include "sensor/codec/fast_model.h"

#include <algorithm>

namespace kino::fast {
namespace {

constexpr std::uint32_t kTotal = 1u << kProbabilityBits;
/// The last class of large residuals; what lies beyond is no symbol.
constexpr int kLastSymbol = 1 + kDirect + 15;

/// Counts scaled to sum to kTotal, none that came becoming 0.
void scale(const std::uint32_t* counts, std::array<std::uint16_t, kSymbols>& out) {
    std::uint64_t total = 0;
    for (int s = 0; s < kSymbols; ++s) total += counts[s];
    out.fill(0);
    if (total == 0) return;
    std::int32_t left = kTotal;
    for (int s = 0; s < kSymbols; ++s) {
        if (counts[s] == 0) continue;
        const std::uint64_t rounded = (std::uint64_t{counts[s]} * kTotal + total / 2) / total;
        out[s] = static_cast<std::uint16_t>(std::max<std::uint64_t>(rounded, 1));
        left -= out[s];
    }
    while (left != 0) {
        auto& largest = *std::max_element(out.begin(), out.end());
        const std::int32_t step = left > 0 ? left : -1;
        largest = static_cast<std::uint16_t>(largest + step);
        left -= step;
    }
}

}  // namespace

Frequencies frequencies_of(std::span<const std::uint16_t> tokens) {
    // Four tables, so that a run of one token does not wait for its own count.
    constexpr std::size_t kTables = 4;
    std::array<std::array<std::uint32_t, kContexts * kSymbols>, kTables> counts{};
    for (std::size_t i = 0; i + kTables <= tokens.size(); i += kTables) {
        for (std::size_t k = 0; k < kTables; ++k) ++counts[k][tokens[i + k]];
    }
    static_assert(kLanes % kTables == 0);
    for (std::size_t i = 0; i < counts[0].size(); ++i) {
        for (std::size_t k = 1; k < kTables; ++k) counts[0][i] += counts[k][i];
    }
    Frequencies out;
    for (int c = 0; c < kContexts; ++c) scale(&counts[0][c * kSymbols], out[c]);
    return out;
}

void write_frequencies(const Frequencies& frequencies, BitWriter& out) {
    for (const auto& context : frequencies) {
        int count = kSymbols;
        while (count > 0 && context[count - 1] == 0) --count;
        out.put_number(static_cast<std::uint32_t>(count));
        for (int s = 0; s < count; ++s) out.put_number(context[s]);
    }
}

bool read_frequencies(BitReader& in, Frequencies& frequencies) {
    for (auto& context : frequencies) {
        context.fill(0);
        const std::uint32_t count = in.get_number();
        if (count > kLastSymbol + 1) return false;
        std::uint32_t total = 0;
        for (std::uint32_t s = 0; s < count; ++s) {
            const std::uint32_t frequency = in.get_number();
            if (frequency > kTotal) return false;
            context[s] = static_cast<std::uint16_t>(frequency);
            total += frequency;
        }
        if (count > 0 && total != kTotal) return false;
    }
    return !in.overrun();
}

void fill(const Frequencies& frequencies, EncodeTable& table) {
    for (int c = 0; c < kContexts; ++c) {
        std::uint32_t start = 0;
        for (int s = 0; s < kSymbols; ++s) {
            table[c * kSymbols + s] = frequencies[c][s] | start << 16;
            start += frequencies[c][s];
        }
    }
}

void fill(const Frequencies& frequencies, DecodeTable& table) {
    constexpr int kSymbolBit = 2 * kProbabilityBits + 1;
    for (int c = 0; c < kContexts; ++c) {
        std::uint32_t* slot = &table[c << kProbabilityBits];
        const std::uint32_t* end = slot + kTotal;
        for (std::uint32_t s = 0; s < kSymbols; ++s) {
            const std::uint32_t frequency = frequencies[c][s];
            for (std::uint32_t i = 0; i < frequency; ++i) {
                *slot++ = i | frequency << kProbabilityBits | s << kSymbolBit;
            }
        }
        for (std::uint32_t i = 0; slot != end; ++i) *slot++ = i | kTotal << kProbabilityBits;
    }
}

void write_palette(std::span<const std::uint16_t> values, BitWriter& out) {
    out.put_number(static_cast<std::uint32_t>(values.size()));
    std::uint32_t next = 0;
    for (const std::uint16_t value : values) {
        out.put_number(value - next);
        next = std::uint32_t{value} + 1;
    }
}

bool read_palette(BitReader& in, std::vector<std::uint16_t>& values) {
    values.clear();
    const std::uint32_t count = in.get_number();
    if (count > UINT16_MAX) return false;
    std::uint32_t next = 0;
    for (std::uint32_t i = 0; i < count && !in.overrun(); ++i) {
        const std::uint32_t value = next + in.get_number();
        if (value > UINT16_MAX) return false;
        values.push_back(static_cast<std::uint16_t>(value));
        next = value + 1;
    }
    return !in.overrun();
}

}  // namespace kino::fast
