#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <variant>

#include "base/check.h"
#include "sensor/v4l2/buffer_decoder.h"

/// What the decoder promises for any layout and any bytes. Shared by the libFuzzer driver and by
/// mutation_test.cpp.
namespace kino::fuzz {

/// A buffer whose layout the first bytes state: format, meaning, width, height, padding, flags.
inline void v4l2_buffers(std::span<const std::uint8_t> bytes) {
    constexpr std::size_t kHead = 7;
    if (bytes.size() < kHead) return;
    BufferLayout layout;
    layout.format = &video_formats()[bytes[0] % video_formats().size()];
    constexpr StreamKind kKinds[] = {StreamKind::depth, StreamKind::infrared, StreamKind::color,
                                     StreamKind::motion};
    layout.kind = kKinds[bytes[1] % 4];
    layout.width = bytes[2] - 1;
    layout.height = bytes[3] - 1;
    layout.stride = static_cast<std::size_t>(bytes[4]) * (1 + bytes[5] % 4);
    layout.unit = bytes[6] & 1 ? DepthUnit::kinect_disparity11 : DepthUnit::linear;
    layout.short_rows_in_place = (bytes[6] & 2) != 0;
    if (!validate(layout)) return;

    const auto frame = decode_buffer(layout, bytes.subspan(kHead), {});
    if (!frame) return;
    const bool is_short = bytes.size() - kHead < layout.whole_bytes();
    std::visit(
        [&](const auto& held) {
            if constexpr (requires { held->damaged_rows; }) {
                KINO_CHECK_EQ(held->damaged_rows.empty(), !is_short);
                for (const RowRange& rows : held->damaged_rows) {
                    KINO_CHECK_LT(0, rows.first);
                    KINO_CHECK_EQ(rows.first + rows.count, layout.height);
                }
            }
            if constexpr (requires { held->raw; }) {
                KINO_CHECK_EQ(held->raw.width(), layout.width);
                KINO_CHECK_EQ(held->raw.height(), layout.height);
            }
            if constexpr (requires { held->pitch; }) {
                if (layout.format->has_rows())
                    KINO_CHECK_EQ(held->bytes.size(), layout.format->row_bytes(layout.width) *
                                                          static_cast<std::size_t>(layout.height));
            }
        },
        *frame);
}

}  // namespace kino::fuzz
