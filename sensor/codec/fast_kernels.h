#pragma once

#include <cstddef>
#include <cstdint>

/// The inner loops of the fast codec (docs/session-codec.md), each in a portable and an AVX2 form
/// that give the same bytes. Nothing here has inline functions: the AVX2 file includes it.
namespace kino::fast {

constexpr int kLanes = 16;            ///< horizontal stripes coded side by side
constexpr int kContexts = 10;         ///< 7 of activity, 3 beside holes
constexpr int kSymbols = 64;          ///< hole, direct residuals, classes of large ones
constexpr int kDirect = 46;           ///< zigzag residuals below it have a symbol of their own
constexpr int kProbabilityBits = 10;  ///< frequencies of a context sum to 1 << this
constexpr std::uint32_t kStateFloor = 1u << 15;  ///< rANS states are in [floor, floor << 16)
/// Bytes that may be read, not used, beyond the end of the words and of the escapes.
constexpr std::size_t kPadding = 64;

/// Stripe whose state is the i-th within a step of the stream: what unpacking 16 lanes of 16 bits
/// into two registers of 8 gives.
constexpr int kStreamOrder[kLanes] = {0, 1, 2, 3, 8, 9, 10, 11, 4, 5, 6, 7, 12, 13, 14, 15};

/// Activity, shifted and cut off at 15, to its context.
constexpr std::uint8_t kActivityContext[16] = {0, 1, 2, 3, 3, 4, 4, 4, 4, 5, 5, 5, 5, 5, 5, 6};

/// A plane cut into kLanes stripes of `rows` rows: index (row * width + x) * kLanes + stripe.
/// 0 = hole (and the rows below the picture), others 1 ...
struct Stripes {
    int width = 0;
    int rows = 0;
};

struct TokenJob {
    Stripes stripes;
    int shift = 0;  ///< of the activity
    const std::uint16_t* indices = nullptr;
    std::uint16_t* above = nullptr;       ///< scratch, width * kLanes
    std::uint16_t* above_hole = nullptr;  ///< scratch, width * kLanes
    std::uint16_t* tokens = nullptr;      ///< out: context * kSymbols + symbol, ordered as indices
    std::uint16_t* escapes = nullptr;     ///< out, room for all: zigzag - kDirect + 1, in order
};

struct EncodeJob {
    std::size_t steps = 0;  ///< width * rows
    const std::uint16_t* tokens = nullptr;
    const std::uint32_t* entries = nullptr;  ///< of each token: frequency | start << 16
    std::uint8_t* words_end = nullptr;       ///< written backwards from here; kPadding bytes before
    std::uint32_t* states = nullptr;         ///< out: kLanes, by stripe
};

struct DecodeJob {
    Stripes stripes;
    int shift = 0;
    /// kContexts << kProbabilityBits: offset (10 bits), frequency (11) and symbol (6), from bit 0.
    const std::uint32_t* slots = nullptr;
    const std::uint8_t* words = nullptr;
    const std::uint8_t* words_end = nullptr;
    const std::uint8_t* escapes = nullptr;
    std::size_t escape_bits = 0;
    std::uint32_t* states = nullptr;  ///< kLanes, by stripe; in and out
    std::uint16_t* above = nullptr;
    std::uint16_t* above_hole = nullptr;
    std::uint16_t* indices = nullptr;  ///< out
};

struct Decoded {
    bool whole = false;  ///< neither words nor escapes ran out
    std::size_t word_bytes = 0;
    std::size_t escape_bits = 0;
    std::uint16_t largest = 0;  ///< index
};

struct Kernels {
    /// Rows of a plane to stripes; rows below the picture become 0. `plane` is width * height.
    void (*to_stripes)(const std::uint16_t* plane, int height, Stripes stripes,
                       std::uint16_t* indices);
    void (*from_stripes)(const std::uint16_t* indices, int height, Stripes stripes,
                         std::uint16_t* plane);
    std::size_t (*make_tokens)(const TokenJob& job);  ///< number of escapes
    std::uint8_t* (*encode)(const EncodeJob& job);    ///< first byte of the words
    Decoded (*decode)(const DecodeJob& job);
    std::uint32_t (*crc32c)(const std::uint8_t* data, std::size_t bytes);
};

extern const Kernels kPortableKernels;
extern const Kernels kAvx2Kernels;  ///< only on processors with AVX2 (and so SSE 4.2)

}  // namespace kino::fast
