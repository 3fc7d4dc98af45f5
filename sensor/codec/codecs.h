#pragma once

#include "sensor/codec/image_codec.h"

/// The codecs behind make_image_encoder() and make_image_decoder(), which have checked the size.
namespace kino {

[[nodiscard]] Result<std::unique_ptr<ImageEncoder>> make_ffv1_encoder(const ImageFormat& format,
                                                                      const CodecOptions& options);
[[nodiscard]] Result<std::unique_ptr<ImageDecoder>> make_ffv1_decoder(
    const ImageFormat& format, std::span<const std::uint8_t> private_data,
    const CodecOptions& options);

[[nodiscard]] std::unique_ptr<ImageEncoder> make_rvl_zstd_encoder(const ImageFormat& format);
[[nodiscard]] std::unique_ptr<ImageDecoder> make_rvl_zstd_decoder(const ImageFormat& format);

[[nodiscard]] std::unique_ptr<ImageEncoder> make_fast_encoder(const ImageFormat& format,
                                                              const CodecOptions& options);
[[nodiscard]] std::unique_ptr<ImageDecoder> make_fast_decoder(const ImageFormat& format,
                                                              const CodecOptions& options);

}  // namespace kino
