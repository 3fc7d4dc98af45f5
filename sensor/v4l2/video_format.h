#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "sensor/source.h"

namespace kino {

/// How the pixels of a buffer are laid down. Little endian where not named otherwise.
enum class PixelCode : std::uint8_t {
    packed10,  ///< 4 pixels in 5 bytes, most significant bit first
    words,     ///< 16-bit words, `bits` of them in use
    words_be,  ///< the same, big endian
    bytes,     ///< 8-bit grey
    bayer,     ///< 8 bits, GRBG
    uyvy,
    yuyv,
    jpeg,  ///< one Motion-JPEG picture; no rows
};

/// A pixel format of V4L2 that this room reads.
struct VideoFormat {
    std::uint32_t fourcc = 0;
    const char* name = "";    ///< as `format=` takes it
    const char* kernel_name;  ///< as videodev2.h has it after V4L2_PIX_FMT_, taken too
    PixelCode code = PixelCode::words;
    int bits = 16;  ///< of a pixel that carry meaning; of depth and infrared formats
    StreamKind kind = StreamKind::color;  ///< what it is where nobody says otherwise

    [[nodiscard]] bool has_rows() const { return code != PixelCode::jpeg; }
    /// Whether frames of it may be taken as `as` instead.
    [[nodiscard]] bool can_be(StreamKind as) const;
    /// Bytes that a row of `width` pixels fills; 0 where there are no rows.
    [[nodiscard]] std::size_t row_bytes(int width) const;
};

/// Best first, where a device offers several: depth, then colour, then infrared.
[[nodiscard]] std::span<const VideoFormat> video_formats();
[[nodiscard]] const VideoFormat* find_video_format(std::uint32_t fourcc);
/// Any case. Null for a name that is not in the table.
[[nodiscard]] const VideoFormat* find_video_format(const std::string& name);

/// "Y10B"; bytes that are no letters become dots, the big-endian mark becomes "-BE".
[[nodiscard]] std::string fourcc_text(std::uint32_t fourcc);

}  // namespace kino
