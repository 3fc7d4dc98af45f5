#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/check.h"
#include "sensor/codec/fast_kernels.h"
#include "sensor/codec/image_codec.h"
#include "sensor/codec/rvl.h"

/// What a decoder promises for any bytes at all: no crash, no memory but its own, and whatever it
/// accepts comes back from encoding it again. Shared by the libFuzzer drivers beside this file and
/// by ../codec_mutation_test.cpp. An input is: layout, width - 1, height - 1, then the frame.
namespace kino::fuzz {

using Bytes = std::span<const std::uint8_t>;
constexpr std::size_t kFrameAt = 3;

inline ImageFormat codec_format(ImageCodec codec, Bytes bytes) {
    ImageFormat format{codec, static_cast<PixelLayout>(bytes[0] % 7), bytes[1] % 64 + 1,
                       bytes[2] % 64 + 1};
    const bool yuv = format.layout == PixelLayout::yuv422 || format.layout == PixelLayout::yuyv422;
    if (yuv) format.width += format.width % 2;
    return format;
}

inline void expect_round_trip(const ImageFormat& format, Bytes pixels) {
    const auto encoder = make_image_encoder(format);
    KINO_CHECK(encoder.has_value());
    const auto data = (*encoder)->encode(pixels);
    KINO_CHECK(data.has_value());
    const auto decoder = make_image_decoder(format, (*encoder)->private_data());
    KINO_CHECK(decoder.has_value());
    std::vector<std::uint8_t> back(pixels.size());
    KINO_CHECK((*decoder)->decode(*data, back).has_value());
    KINO_CHECK(std::equal(back.begin(), back.end(), pixels.begin()));
}

/// The checksum is put right, so that what lies behind it is reached; both forms must agree.
inline void fast_frame(Bytes bytes) {
    constexpr std::size_t kHead = 5;
    if (bytes.size() < kFrameAt + kHead) return;
    const ImageFormat format = codec_format(ImageCodec::fast, bytes);
    std::vector<std::uint8_t> frame(bytes.begin() + kFrameAt, bytes.end());
    const std::uint32_t crc =
        fast::kPortableKernels.crc32c(frame.data() + kHead, frame.size() - kHead);
    for (std::size_t i = 0; i < 4; ++i) frame[1 + i] = static_cast<std::uint8_t>(crc >> 8 * i);
    std::vector<std::uint8_t> pixels(bytes_per_frame(format));
    std::vector<std::uint8_t> portable(pixels.size());
    const bool accepted = (*make_image_decoder(format, {}))->decode(frame, pixels).has_value();
    KINO_CHECK_EQ(
        accepted,
        (*make_image_decoder(format, {}, {.simd = false}))->decode(frame, portable).has_value());
    if (!accepted) return;
    KINO_CHECK(pixels == portable);
    expect_round_trip(format, pixels);
}

/// Any pixels there and back by both forms.
inline void fast_pixels(Bytes bytes) {
    if (bytes.size() < kFrameAt) return;
    const ImageFormat format = codec_format(ImageCodec::fast, bytes);
    std::vector<std::uint8_t> pixels(bytes.begin() + kFrameAt, bytes.end());
    pixels.resize(bytes_per_frame(format));
    expect_round_trip(format, pixels);
    const auto simd = make_image_encoder(format);
    const auto portable = make_image_encoder(format, {.simd = false});
    const auto a = *(*simd)->encode(pixels);
    const auto b = *(*portable)->encode(pixels);
    KINO_CHECK(std::equal(a.begin(), a.end(), b.begin(), b.end()));
}

/// The groups within the zstd frame, and the whole as a frame.
inline void rvl_zstd(Bytes bytes) {
    if (bytes.size() < kFrameAt) return;
    ImageFormat format = codec_format(ImageCodec::rvl_zstd, bytes);
    format.layout = PixelLayout::gray16;
    std::vector<std::uint8_t> pixels(bytes_per_frame(format));
    const Bytes data = bytes.subspan(kFrameAt);
    if (rvl_decode(data, pixels)) {
        std::vector<std::uint8_t> again(rvl_bound_bytes(pixels.size() / 2));
        again.resize(rvl_encode(pixels, again));
        std::vector<std::uint8_t> back(pixels.size());
        KINO_CHECK(rvl_decode(again, back));
        KINO_CHECK(back == pixels);
    }
    if ((*make_image_decoder(format, {}))->decode(data, pixels)) expect_round_trip(format, pixels);
}

/// A frame under a good header, with the slice's checksum left as it is: what storage can do to it.
inline void ffv1_frame(Bytes bytes) {
    if (bytes.size() < kFrameAt) return;
    const ImageFormat format = codec_format(ImageCodec::ffv1, bytes);
    const auto encoder = make_image_encoder(format);
    if (!encoder) return;
    const auto decoder = make_image_decoder(format, (*encoder)->private_data());
    KINO_CHECK(decoder.has_value());
    std::vector<std::uint8_t> pixels(bytes_per_frame(format));
    if ((*decoder)->decode(bytes.subspan(kFrameAt), pixels)) expect_round_trip(format, pixels);
}

/// A header, then a good frame under it.
inline void ffv1_header(Bytes bytes) {
    if (bytes.size() < kFrameAt) return;
    const ImageFormat format = codec_format(ImageCodec::ffv1, bytes);
    const auto encoder = make_image_encoder(format);
    if (!encoder) return;
    const auto decoder = make_image_decoder(format, bytes.subspan(kFrameAt));
    if (!decoder) return;
    std::vector<std::uint8_t> pixels(bytes_per_frame(format), 7);
    const auto data = (*encoder)->encode(pixels);
    KINO_CHECK(data.has_value());
    (void)(*decoder)->decode(*data, pixels);
}

}  // namespace kino::fuzz
