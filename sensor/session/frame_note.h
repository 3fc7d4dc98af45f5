#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/frame.h"
#include "sensor/session/stream_format.h"

namespace kino {

/// A format that a frame brings along because the file has no track for it.
struct OwnFormat {
    StreamFormat format;
    std::vector<std::uint8_t> private_data;  ///< of the codec
};

/// What stands beside a picture's bytes: the BlockAdditional of docs/session-format.md.
struct FrameNote {
    FrameHeader header;
    std::vector<RowRange> damaged_rows;
    std::optional<OwnFormat> own_format;
};

/// The BlockAddID it has.
constexpr std::uint64_t kFrameNoteId = 4;

/// Fails only for more than 65535 ranges of rows, or ranges with negative numbers.
[[nodiscard]] Result<std::vector<std::uint8_t>> write_frame_note(const FrameNote& note);
/// Any bytes are safe.
[[nodiscard]] Result<FrameNote> read_frame_note(std::span<const std::uint8_t> bytes);

}  // namespace kino
