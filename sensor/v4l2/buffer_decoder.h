#pragma once

#include <cstdint>
#include <span>

#include "base/error.h"
#include "base/frame.h"
#include "sensor/source.h"
#include "sensor/v4l2/video_format.h"

namespace kino {

/// How the bytes of one buffer become a frame, as agreed with the driver.
struct BufferLayout {
    const VideoFormat* format = nullptr;
    StreamKind kind = StreamKind::color;  ///< one of those that `format` can be
    int width = 0;                        ///< px
    int height = 0;                       ///< px
    std::size_t stride = 0;               ///< bytes from row to row; no meaning for jpeg
    DepthUnit unit = DepthUnit::linear;
    double metres_per_unit = 0.001;  ///< for DepthUnit::linear
    YuvMatrix matrix = YuvMatrix::bt601;
    YuvRange range = YuvRange::full;
    /// Whether what a short buffer holds stands at its place. Cameras on USB string together the
    /// packets that arrived, so that everything behind a lost one has moved up.
    bool short_rows_in_place = true;

    /// Bytes that a whole picture takes at least (the last row's padding may be missing).
    [[nodiscard]] std::size_t whole_bytes() const;
};

constexpr int kMaxVideoSize = 16384;  ///< px, in either direction

/// Refuses sizes of 0 or beyond kMaxVideoSize, rows that overlap, meanings that a format cannot
/// have, and odd widths where pixels come in pairs.
[[nodiscard]] Result<void> validate(const BufferLayout& layout);

/// The frame in `bytes`, which are what the driver says it filled, not what it mapped. A short
/// buffer gives a frame with its last rows marked as damaged, and an error where not even one row
/// is whole, where rows are not at their place, or where the format has none. `layout` is valid.
/// - packed10 as kinect_disparity11: twice the count, 1023 becomes 2047.
/// - words: bits above format->bits are cleared.
/// - jpeg: passed on up to its end marker; the start and end markers must be there.
[[nodiscard]] Result<StreamFrame> decode_buffer(const BufferLayout& layout,
                                                std::span<const std::uint8_t> bytes,
                                                const FrameHeader& header);

}  // namespace kino
