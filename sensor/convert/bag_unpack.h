#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/error.h"

namespace kino {

/// Chunks that unpack to more are refused; recorders make them below 1 MB, or of one picture.
constexpr std::uint64_t kMaxBagChunk = std::uint64_t{64} << 20;

/// An LZ4 frame (as roslz4 writes them) or a bzip2 stream. `size` is what the bag says comes out
/// and at most kMaxBagChunk. `cut`: the input may end early; what came until then is the answer.
/// Fails for damaged input, and for more or (unless cut) fewer bytes than `size`.
[[nodiscard]] Result<std::vector<std::uint8_t>> unpack_lz4(std::span<const std::uint8_t> packed,
                                                           std::size_t size, bool cut);
[[nodiscard]] Result<std::vector<std::uint8_t>> unpack_bz2(std::span<const std::uint8_t> packed,
                                                           std::size_t size, bool cut);

}  // namespace kino
