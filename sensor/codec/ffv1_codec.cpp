#include <fmt/format.h>

#include <cstring>

#include "base/check.h"
#include "sensor/codec/codecs.h"
#include "sensor/codec/ffv1_pixels.h"

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavutil/crc.h>
#include <libavutil/log.h>
#include <libavutil/opt.h>
}

namespace kino {
namespace {

constexpr const char* kFfv1Name = "ffv1";

struct ContextFree {
    void operator()(AVCodecContext* c) const { avcodec_free_context(&c); }
};
struct PacketFree {
    void operator()(AVPacket* p) const { av_packet_free(&p); }
};
struct FrameFree {
    void operator()(AVFrame* f) const { av_frame_free(&f); }
};
using Context = std::unique_ptr<AVCodecContext, ContextFree>;
using Packet = std::unique_ptr<AVPacket, PacketFree>;
using Frame = std::unique_ptr<AVFrame, FrameFree>;

std::string reason(int code) {
    char text[AV_ERROR_MAX_STRING_SIZE] = {};
    av_strerror(code, text, sizeof text);
    return text;
}

/// libavcodec cuts version 3 into at least 2x2 slices beyond CIF.
int slice_count(const ImageFormat& format) {
    return format.width > 352 || format.height > 288 ? 4 : 1;
}

/// libavcodec 59 decodes what it wrote into slices one pixel wide or high as something else.
Result<void> check_slices(const ImageFormat& format) {
    const int least = slice_count(format) == 4 ? 4 : 2;
    if (format.width >= least && format.height >= least) return {};
    return fail(fmt::format("a picture of {}x{} cannot be coded", format.width, format.height),
                kFfv1Name, fmt::format("it must be at least {} pixels wide and high", least));
}

Result<Context> make_context(const AVCodec* codec, const ImageFormat& format, int threads) {
    // libavcodec speaks of damaged data on stderr; here it is an error that we return.
    av_log_set_level(AV_LOG_QUIET);
    Context context(avcodec_alloc_context3(codec));
    KINO_CHECK(context != nullptr);
    context->width = format.width;
    context->height = format.height;
    context->time_base = {1, 30};
    context->pix_fmt = static_cast<AVPixelFormat>(ffv1_pixel_format(format.layout));
    context->thread_count = threads;
    context->thread_type = FF_THREAD_SLICE;
    return context;
}

class Ffv1Encoder final : public ImageEncoder {
  public:
    Ffv1Encoder(const ImageFormat& format, Context context)
        : format_(format),
          context_(std::move(context)),
          packet_(av_packet_alloc()),
          frame_(av_frame_alloc()) {
        KINO_CHECK(packet_ != nullptr && frame_ != nullptr);
    }

    std::span<const std::uint8_t> private_data() const override {
        return {context_->extradata, static_cast<std::size_t>(context_->extradata_size)};
    }

    Result<std::span<const std::uint8_t>> encode(std::span<const std::uint8_t> pixels) override {
        KINO_CHECK_EQ(pixels.size(), bytes_per_frame(format_));
        // The encoder may still hold the frame of the call before.
        if (frame_->data[0] == nullptr) {
            frame_->format = context_->pix_fmt;
            frame_->width = format_.width;
            frame_->height = format_.height;
            KINO_TRY(checked(av_frame_get_buffer(frame_.get(), 0)));
        }
        KINO_TRY(checked(av_frame_make_writable(frame_.get())));
        pack_to_frame(format_, pixels.data(), *frame_);
        frame_->pts = next_pts_++;
        KINO_TRY(checked(avcodec_send_frame(context_.get(), frame_.get())));
        KINO_TRY(checked(avcodec_receive_packet(context_.get(), packet_.get())));
        return std::span<const std::uint8_t>(packet_->data,
                                             static_cast<std::size_t>(packet_->size));
    }

  private:
    static Result<void> checked(int code) {
        if (code < 0) return fail("libavcodec cannot encode: " + reason(code), kFfv1Name);
        return {};
    }

    ImageFormat format_;
    Context context_;
    Packet packet_;
    Frame frame_;
    std::int64_t next_pts_ = 0;
};

/// RFC 9043, 4.8: each slice ends with its size (24 bits), a status byte and a CRC that makes the
/// sum over the slice zero. libavcodec would paint a damaged slice over with the frame before.
bool slices_are_whole(std::span<const std::uint8_t> data, int expected) {
    constexpr std::size_t kFooter = 8;
    const AVCRC* table = av_crc_get_table(AV_CRC_32_IEEE);
    int slices = 0;
    std::size_t end = data.size();
    while (end > 0) {
        if (end < kFooter || ++slices > expected) return false;
        const std::uint8_t* size = data.data() + end - kFooter;
        const std::size_t bytes =
            (std::size_t{size[0]} << 16 | std::size_t{size[1]} << 8 | size[2]) + kFooter;
        if (bytes > end || size[3] != 0) return false;
        if (av_crc(table, 0, data.data() + end - bytes, bytes) != 0) return false;
        end -= bytes;
    }
    return slices == expected;
}

class Ffv1Decoder final : public ImageDecoder {
  public:
    Ffv1Decoder(const ImageFormat& format, Context context)
        : format_(format),
          context_(std::move(context)),
          packet_(av_packet_alloc()),
          frame_(av_frame_alloc()) {
        KINO_CHECK(packet_ != nullptr && frame_ != nullptr);
    }

    Result<void> decode(std::span<const std::uint8_t> data,
                        std::span<std::uint8_t> pixels) override {
        KINO_CHECK_EQ(pixels.size(), bytes_per_frame(format_));
        if (!slices_are_whole(data, slice_count(format_))) {
            return fail("a frame is damaged: its slices do not match their checksums", kFfv1Name);
        }
        // libavcodec reads beyond the end, up to this much.
        data_.assign(data.begin(), data.end());
        data_.resize(data.size() + AV_INPUT_BUFFER_PADDING_SIZE, 0);
        packet_->data = data_.data();
        packet_->size = static_cast<int>(data.size());
        packet_->flags = AV_PKT_FLAG_KEY;
        int code = avcodec_send_packet(context_.get(), packet_.get());
        if (code >= 0) code = avcodec_receive_frame(context_.get(), frame_.get());
        if (code < 0) {
            // An error may leave it in the middle of a packet.
            avcodec_flush_buffers(context_.get());
            return fail("a frame is damaged: " + reason(code), kFfv1Name);
        }
        const bool fits = frame_->width == format_.width && frame_->height == format_.height &&
                          frame_->format == ffv1_pixel_format(format_.layout);
        if (fits) unpack_from_frame(format_, *frame_, pixels.data());
        av_frame_unref(frame_.get());
        if (!fits) return fail("a frame has another layout than its stream", kFfv1Name);
        return {};
    }

  private:
    ImageFormat format_;
    Context context_;
    Packet packet_;
    Frame frame_;
    std::vector<std::uint8_t> data_;
};

}  // namespace

Result<std::unique_ptr<ImageEncoder>> make_ffv1_encoder(const ImageFormat& format,
                                                        const CodecOptions& options) {
    KINO_TRY(check_slices(format));
    const AVCodec* codec = avcodec_find_encoder(AV_CODEC_ID_FFV1);
    if (codec == nullptr) return fail("this libavcodec cannot encode FFV1", kFfv1Name);
    KINO_ASSIGN(auto context, make_context(codec, format, options.threads));
    context->level = 3;
    context->gop_size = 1;
    context->slices = slice_count(format);
    context->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
    av_opt_set_int(context->priv_data, "slicecrc", 1, 0);
    if (const int code = avcodec_open2(context.get(), codec, nullptr); code < 0) {
        return fail(fmt::format("libavcodec cannot encode FFV1 of {}x{}: {}", format.width,
                                format.height, reason(code)),
                    kFfv1Name, "another codec can");
    }
    return std::make_unique<Ffv1Encoder>(format, std::move(context));
}

Result<std::unique_ptr<ImageDecoder>> make_ffv1_decoder(const ImageFormat& format,
                                                        std::span<const std::uint8_t> private_data,
                                                        const CodecOptions& options) {
    constexpr std::size_t kMaxPrivateBytes = 1 << 20;
    KINO_TRY(check_slices(format));
    const AVCodec* codec = avcodec_find_decoder(AV_CODEC_ID_FFV1);
    if (codec == nullptr) return fail("this libavcodec cannot decode FFV1", kFfv1Name);
    if (private_data.empty() || private_data.size() > kMaxPrivateBytes) {
        return fail("the stream's FFV1 header is missing or much too long", kFfv1Name);
    }
    KINO_ASSIGN(auto context, make_context(codec, format, options.threads));
    context->extradata =
        static_cast<std::uint8_t*>(av_mallocz(private_data.size() + AV_INPUT_BUFFER_PADDING_SIZE));
    KINO_CHECK(context->extradata != nullptr);
    std::memcpy(context->extradata, private_data.data(), private_data.size());
    context->extradata_size = static_cast<int>(private_data.size());
    if (const int code = avcodec_open2(context.get(), codec, nullptr); code < 0) {
        return fail("the stream's FFV1 header is damaged: " + reason(code), kFfv1Name);
    }
    return std::make_unique<Ffv1Decoder>(format, std::move(context));
}

}  // namespace kino
