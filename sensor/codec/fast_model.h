#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sensor/codec/fast_bits.h"
#include "sensor/codec/fast_kernels.h"

namespace kino::fast {

/// How often each symbol comes in each context. Of a context that is used they sum to
/// 1 << kProbabilityBits, of any other to 0.
using Frequencies = std::array<std::array<std::uint16_t, kSymbols>, kContexts>;

[[nodiscard]] Frequencies frequencies_of(std::span<const std::uint16_t> tokens);

void write_frequencies(const Frequencies& frequencies, BitWriter& out);
/// False if they are none.
[[nodiscard]] bool read_frequencies(BitReader& in, Frequencies& frequencies);

/// EncodeJob::entries.
using EncodeTable = std::array<std::uint32_t, kContexts * kSymbols>;
void fill(const Frequencies& frequencies, EncodeTable& table);

/// DecodeJob::slots. A context that is not used gives holes and leaves the state as it is.
using DecodeTable = std::array<std::uint32_t, kContexts << kProbabilityBits>;
void fill(const Frequencies& frequencies, DecodeTable& table);

/// The values that a plane has beside its hole value, in rising order; index i + 1 stands for
/// values[i].
void write_palette(std::span<const std::uint16_t> values, BitWriter& out);
[[nodiscard]] bool read_palette(BitReader& in, std::vector<std::uint16_t>& values);

}  // namespace kino::fast
