#include <zstd.h>

#include "base/check.h"
#include "sensor/codec/codecs.h"
#include "sensor/codec/rvl.h"

namespace kino {
namespace {

constexpr int kLevel = 1;
constexpr const char* kRvlName = "rvl+zstd";

struct CompressFree {
    void operator()(ZSTD_CCtx* c) const { ZSTD_freeCCtx(c); }
};
struct DecompressFree {
    void operator()(ZSTD_DCtx* c) const { ZSTD_freeDCtx(c); }
};

class RvlZstdEncoder final : public ImageEncoder {
  public:
    explicit RvlZstdEncoder(std::size_t frame_bytes)
        : frame_bytes_(frame_bytes),
          rvl_(rvl_bound_bytes(frame_bytes / 2)),
          out_(ZSTD_compressBound(rvl_.size())),
          context_(ZSTD_createCCtx()) {
        KINO_CHECK(context_ != nullptr);
        ZSTD_CCtx_setParameter(context_.get(), ZSTD_c_compressionLevel, kLevel);
        ZSTD_CCtx_setParameter(context_.get(), ZSTD_c_checksumFlag, 1);
    }

    std::span<const std::uint8_t> private_data() const override { return {}; }

    Result<std::span<const std::uint8_t>> encode(std::span<const std::uint8_t> pixels) override {
        KINO_CHECK_EQ(pixels.size(), frame_bytes_);
        const std::size_t bytes = rvl_encode(pixels, rvl_);
        const std::size_t size =
            ZSTD_compress2(context_.get(), out_.data(), out_.size(), rvl_.data(), bytes);
        if (ZSTD_isError(size)) return fail(ZSTD_getErrorName(size), kRvlName);
        return std::span<const std::uint8_t>(out_).first(size);
    }

  private:
    std::size_t frame_bytes_;
    std::vector<std::uint8_t> rvl_;
    std::vector<std::uint8_t> out_;
    std::unique_ptr<ZSTD_CCtx, CompressFree> context_;
};

class RvlZstdDecoder final : public ImageDecoder {
  public:
    explicit RvlZstdDecoder(std::size_t frame_bytes)
        : frame_bytes_(frame_bytes),
          rvl_(rvl_bound_bytes(frame_bytes / 2)),
          context_(ZSTD_createDCtx()) {
        KINO_CHECK(context_ != nullptr);
    }

    Result<void> decode(std::span<const std::uint8_t> data,
                        std::span<std::uint8_t> pixels) override {
        KINO_CHECK_EQ(pixels.size(), frame_bytes_);
        // One frame and nothing behind it: zstd would join several.
        if (ZSTD_findFrameCompressedSize(data.data(), data.size()) != data.size()) {
            return fail("not one zstd frame", kRvlName);
        }
        const std::size_t size =
            ZSTD_decompressDCtx(context_.get(), rvl_.data(), rvl_.size(), data.data(), data.size());
        if (ZSTD_isError(size)) return fail(ZSTD_getErrorName(size), kRvlName);
        if (!rvl_decode(std::span<const std::uint8_t>(rvl_).first(size), pixels)) {
            return fail("the runs and differences are not a picture of this size", kRvlName);
        }
        return {};
    }

  private:
    std::size_t frame_bytes_;
    std::vector<std::uint8_t> rvl_;
    std::unique_ptr<ZSTD_DCtx, DecompressFree> context_;
};

}  // namespace

std::unique_ptr<ImageEncoder> make_rvl_zstd_encoder(const ImageFormat& format) {
    return std::make_unique<RvlZstdEncoder>(bytes_per_frame(format));
}

std::unique_ptr<ImageDecoder> make_rvl_zstd_decoder(const ImageFormat& format) {
    return std::make_unique<RvlZstdDecoder>(bytes_per_frame(format));
}

}  // namespace kino
