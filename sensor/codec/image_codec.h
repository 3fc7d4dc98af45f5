#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "base/error.h"

namespace kino {

/// Lossless codecs of sessions. Each frame stands alone.
enum class ImageCodec : std::uint8_t {
    raw,       ///< pixels as they are, little-endian
    ffv1,      ///< RFC 9043, by libavcodec
    rvl_zstd,  ///< Wilson 2017, then zstd; 16 bit only
    fast       ///< docs/session-codec.md: our predictor and entropy stage
};

/// What a picture's bytes mean to a codec.
enum class PixelLayout : std::uint8_t {
    gray16,  ///< depth, infrared: little-endian, rows without padding
    gray8,   ///< brightness
    bayer8,  ///< one byte a pixel, 2x2 mosaic: neighbours of the same colour are two apart
    rgb8,    ///< three bytes a pixel
    rgba8,   ///< four bytes a pixel
    yuv422,  ///< UYVY, two bytes a pixel; the width is even
    yuyv422  ///< YUYV, two bytes a pixel; the width is even
};

struct ImageFormat {
    ImageCodec codec = ImageCodec::ffv1;
    PixelLayout layout = PixelLayout::gray16;
    int width = 0;   ///< px
    int height = 0;  ///< px
    friend bool operator==(const ImageFormat&, const ImageFormat&) = default;
};

struct CodecOptions {
    int threads = 1;   ///< FFV1's slices side by side; the others use one whatever is asked
    bool simd = true;  ///< false keeps to portable code; the bytes are the same
};

[[nodiscard]] const char* codec_name(ImageCodec codec);  ///< "raw", "ffv1", "rvl+zstd", "fast"

[[nodiscard]] std::size_t bytes_per_frame(const ImageFormat& format);  ///< of raw pixels

/// Not thread-safe; one per stream. Reuses its memory.
class ImageEncoder {
  public:
    virtual ~ImageEncoder() = default;
    /// What a decoder must be given beside the format (FFV1's global header); may be empty.
    [[nodiscard]] virtual std::span<const std::uint8_t> private_data() const = 0;
    /// `pixels` holds exactly bytes_per_frame(). The answer is valid until the next call.
    [[nodiscard]] virtual Result<std::span<const std::uint8_t>> encode(
        std::span<const std::uint8_t> pixels) = 0;
};

class ImageDecoder {
  public:
    virtual ~ImageDecoder() = default;
    /// Fills `pixels`, exactly bytes_per_frame() long. Any `data` is safe: what is not a frame of
    /// the format is an error.
    virtual Result<void> decode(std::span<const std::uint8_t> data,
                                std::span<std::uint8_t> pixels) = 0;
};

/// Fails for a layout that the codec does not have, for sizes outside 1 .. 16384, for odd widths of
/// yuv, and with FFV1 below 2x2 pixels (4x4 where a side is beyond 352x288).
[[nodiscard]] Result<std::unique_ptr<ImageEncoder>> make_image_encoder(
    const ImageFormat& format, const CodecOptions& options = {});
[[nodiscard]] Result<std::unique_ptr<ImageDecoder>> make_image_decoder(
    const ImageFormat& format, std::span<const std::uint8_t> private_data,
    const CodecOptions& options = {});

}  // namespace kino
