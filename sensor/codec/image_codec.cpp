#include "sensor/codec/image_codec.h"

#include <fmt/format.h>

#include <cstring>

#include "base/check.h"
#include "sensor/codec/codecs.h"

namespace kino {
namespace {

constexpr int kMaxSize = 16384;

std::size_t bytes_per_pixel(PixelLayout layout) {
    switch (layout) {
        case PixelLayout::gray8:
        case PixelLayout::bayer8:
            return 1;
        case PixelLayout::gray16:
        case PixelLayout::yuv422:
        case PixelLayout::yuyv422:
            return 2;
        case PixelLayout::rgb8:
            return 3;
        case PixelLayout::rgba8:
            return 4;
    }
    return 0;
}

Result<void> check(const ImageFormat& format) {
    const std::string where = codec_name(format.codec);
    if (format.width < 1 || format.height < 1 || format.width > kMaxSize ||
        format.height > kMaxSize) {
        return fail(fmt::format("a picture of {}x{} cannot be coded", format.width, format.height),
                    where, "sizes from 1 to 16384 can");
    }
    if (bytes_per_pixel(format.layout) == 0) return fail("unknown layout of pixels", where);
    const bool yuv = format.layout == PixelLayout::yuv422 || format.layout == PixelLayout::yuyv422;
    if (yuv && format.width % 2 != 0) {
        return fail(fmt::format("a yuv422 picture cannot be {} pixels wide", format.width), where,
                    "its width must be even");
    }
    if (format.codec == ImageCodec::rvl_zstd && format.layout != PixelLayout::gray16) {
        return fail("this codec has 16-bit grey only", where);
    }
    return {};
}

class RawEncoder final : public ImageEncoder {
  public:
    explicit RawEncoder(const ImageFormat& format) : bytes_(bytes_per_frame(format)) {}
    std::span<const std::uint8_t> private_data() const override { return {}; }
    Result<std::span<const std::uint8_t>> encode(std::span<const std::uint8_t> pixels) override {
        KINO_CHECK_EQ(pixels.size(), bytes_.size());
        std::memcpy(bytes_.data(), pixels.data(), pixels.size());
        return std::span<const std::uint8_t>(bytes_);
    }

  private:
    std::vector<std::uint8_t> bytes_;
};

class RawDecoder final : public ImageDecoder {
  public:
    explicit RawDecoder(const ImageFormat& format) : bytes_(bytes_per_frame(format)) {}
    Result<void> decode(std::span<const std::uint8_t> data,
                        std::span<std::uint8_t> pixels) override {
        KINO_CHECK_EQ(pixels.size(), bytes_);
        if (data.size() != bytes_) {
            return fail(fmt::format("a raw frame has {} bytes instead of {}", data.size(), bytes_));
        }
        std::memcpy(pixels.data(), data.data(), data.size());
        return {};
    }

  private:
    std::size_t bytes_;
};

}  // namespace

const char* codec_name(ImageCodec codec) {
    switch (codec) {
        case ImageCodec::raw:
            return "raw";
        case ImageCodec::ffv1:
            return "ffv1";
        case ImageCodec::rvl_zstd:
            return "rvl+zstd";
        case ImageCodec::fast:
            return "fast";
    }
    return "unknown codec";
}

std::size_t bytes_per_frame(const ImageFormat& format) {
    return bytes_per_pixel(format.layout) * static_cast<std::size_t>(format.width) *
           static_cast<std::size_t>(format.height);
}

Result<std::unique_ptr<ImageEncoder>> make_image_encoder(const ImageFormat& format,
                                                         const CodecOptions& options) {
    KINO_TRY(check(format));
    switch (format.codec) {
        case ImageCodec::raw:
            return std::make_unique<RawEncoder>(format);
        case ImageCodec::ffv1:
            return make_ffv1_encoder(format, options);
        case ImageCodec::rvl_zstd:
            return make_rvl_zstd_encoder(format);
        case ImageCodec::fast:
            return make_fast_encoder(format, options);
    }
    return fail("unknown codec");
}

Result<std::unique_ptr<ImageDecoder>> make_image_decoder(const ImageFormat& format,
                                                         std::span<const std::uint8_t> private_data,
                                                         const CodecOptions& options) {
    KINO_TRY(check(format));
    if (format.codec != ImageCodec::ffv1 && !private_data.empty()) {
        return fail("this codec has no private data, but the stream has", codec_name(format.codec));
    }
    switch (format.codec) {
        case ImageCodec::raw:
            return std::make_unique<RawDecoder>(format);
        case ImageCodec::ffv1:
            return make_ffv1_decoder(format, private_data, options);
        case ImageCodec::rvl_zstd:
            return make_rvl_zstd_decoder(format);
        case ImageCodec::fast:
            return make_fast_decoder(format, options);
    }
    return fail("unknown codec");
}

}  // namespace kino
