#include "viz/output/video_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "base/check.h"

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/opt.h>
#include <libswscale/swscale.h>
}

namespace kino {
namespace {

constexpr int kTicksPerSecond = 90000;

std::string av_text(int code) {
    std::array<char, AV_ERROR_MAX_STRING_SIZE> text{};
    av_strerror(code, text.data(), text.size());
    return text.data();
}

const AVCodec* find_encoder() {
    for (const char* name : {"libx264", "libopenh264", "mpeg4"}) {
        if (const AVCodec* codec = avcodec_find_encoder_by_name(name)) return codec;
    }
    return nullptr;
}

}  // namespace

struct VideoWriter::State {
    ~State() {
        sws_freeContext(scale);
        av_packet_free(&packet);
        av_frame_free(&frame);
        avcodec_free_context(&codec);
        if (format != nullptr) {
            if (format->pb != nullptr) avio_closep(&format->pb);
            avformat_free_context(format);
        }
    }

    Result<void> check(int code, const char* doing) const {
        if (code >= 0) return {};
        return fail(fmt::format("{} failed: {}", doing, av_text(code)), path);
    }
    Result<void> open_encoder(const AVCodec* encoder);
    Result<void> open_file();
    Result<void> send(const AVFrame* picture);

    std::string path;
    int width = 0, height = 0;  ///< of the video, even
    int picture_width = 0, picture_height = 0;
    AVFormatContext* format = nullptr;
    AVCodecContext* codec = nullptr;
    AVStream* stream = nullptr;
    AVFrame* frame = nullptr;
    AVPacket* packet = nullptr;
    SwsContext* scale = nullptr;
    TimeNs time = 0;
    bool header_written = false;
    bool finished = false;
};

Result<void> VideoWriter::State::open_encoder(const AVCodec* encoder) {
    codec = avcodec_alloc_context3(encoder);
    KINO_CHECK(codec != nullptr);
    codec->width = width;
    codec->height = height;
    codec->pix_fmt = AV_PIX_FMT_YUV420P;
    codec->time_base = {1, kTicksPerSecond};
    codec->framerate = {30, 1};
    codec->gop_size = 60;
    codec->colorspace = AVCOL_SPC_BT709;
    codec->color_primaries = AVCOL_PRI_BT709;
    codec->color_trc = AVCOL_TRC_BT709;
    codec->color_range = AVCOL_RANGE_MPEG;
    if (std::string(encoder->name) == "mpeg4") {
        // MPEG-4 part 2 has 16 bits for the clock's denominator.
        codec->time_base = {1, 30000};
        codec->flags |= AV_CODEC_FLAG_QSCALE;
        codec->global_quality = 3 * FF_QP2LAMBDA;
    } else {
        av_opt_set(codec->priv_data, "preset", "veryfast", 0);
        av_opt_set(codec->priv_data, "crf", "20", 0);
    }
    if ((format->oformat->flags & AVFMT_GLOBALHEADER) != 0) {
        codec->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
    }
    return check(avcodec_open2(codec, encoder, nullptr), "opening the video encoder");
}

Result<void> VideoWriter::State::open_file() {
    stream = avformat_new_stream(format, nullptr);
    KINO_CHECK(stream != nullptr);
    stream->time_base = codec->time_base;
    KINO_TRY(
        check(avcodec_parameters_from_context(stream->codecpar, codec), "describing the video"));
    KINO_TRY(check(avio_open(&format->pb, path.c_str(), AVIO_FLAG_WRITE), "opening the file"));
    // The index in front, so that a player can start before it has all.
    AVDictionary* options = nullptr;
    av_dict_set(&options, "movflags", "+faststart", 0);
    const int written = avformat_write_header(format, &options);
    av_dict_free(&options);
    KINO_TRY(check(written, "writing the header"));
    header_written = true;
    return {};
}

Result<void> VideoWriter::State::send(const AVFrame* picture) {
    KINO_TRY(check(avcodec_send_frame(codec, picture), "encoding a picture"));
    while (true) {
        const int got = avcodec_receive_packet(codec, packet);
        if (got == AVERROR(EAGAIN) || got == AVERROR_EOF) return {};
        KINO_TRY(check(got, "encoding a picture"));
        av_packet_rescale_ts(packet, codec->time_base, stream->time_base);
        packet->stream_index = stream->index;
        KINO_TRY(check(av_interleaved_write_frame(format, packet), "writing the video"));
    }
}

VideoWriter::VideoWriter(std::unique_ptr<State> state) : state_(std::move(state)) {}
VideoWriter::VideoWriter(VideoWriter&&) noexcept = default;
VideoWriter& VideoWriter::operator=(VideoWriter&&) noexcept = default;
VideoWriter::~VideoWriter() {
    if (state_ && state_->header_written && !state_->finished) (void)finish();
}

std::string VideoWriter::codec() const {
    return state_->codec->codec->name;
}

Result<VideoWriter> VideoWriter::create(const std::filesystem::path& path, int width, int height) {
    constexpr int kLeast = 16;
    auto state = std::make_unique<State>();
    State& s = *state;
    s.path = path.string();
    if (width < kLeast || height < kLeast) {
        return fail(fmt::format("a video of {}x{} is too small", width, height), s.path);
    }
    s.picture_width = width;
    s.picture_height = height;
    s.width = width & ~1;
    s.height = height & ~1;
    av_log_set_level(AV_LOG_ERROR);
    const AVCodec* encoder = find_encoder();
    if (encoder == nullptr) {
        return fail("no video encoder is there", s.path, "install libavcodec-extra59");
    }
    KINO_TRY(s.check(avformat_alloc_output_context2(&s.format, nullptr, "mp4", s.path.c_str()),
                     "preparing the video"));
    KINO_TRY(s.open_encoder(encoder));
    s.frame = av_frame_alloc();
    s.packet = av_packet_alloc();
    KINO_CHECK(s.frame != nullptr && s.packet != nullptr);
    s.frame->format = AV_PIX_FMT_YUV420P;
    s.frame->width = s.width;
    s.frame->height = s.height;
    KINO_TRY(s.check(av_frame_get_buffer(s.frame, 0), "making room for a picture"));
    s.scale = sws_getContext(s.width, s.height, AV_PIX_FMT_RGBA, s.width, s.height,
                             AV_PIX_FMT_YUV420P, SWS_BILINEAR, nullptr, nullptr, nullptr);
    if (s.scale == nullptr) return fail("no colour conversion for this size", s.path);
    const int* bt709 = sws_getCoefficients(SWS_CS_ITU709);
    sws_setColorspaceDetails(s.scale, bt709, 1, bt709, 0, 0, 1 << 16, 1 << 16);
    KINO_TRY(s.open_file());
    return VideoWriter(std::move(state));
}

Result<void> VideoWriter::add(ImageView<const Rgba8> picture, TimeNs duration) {
    State& s = *state_;
    KINO_CHECK(!s.finished);
    KINO_CHECK_EQ(picture.width, s.picture_width);
    KINO_CHECK_EQ(picture.height, s.picture_height);
    // The encoder may still hold the last picture.
    KINO_TRY(s.check(av_frame_make_writable(s.frame), "making room for a picture"));
    const auto* source = reinterpret_cast<const std::uint8_t*>(picture.data);
    const int pitch = static_cast<int>(picture.pitch) * 4;
    sws_scale(s.scale, &source, &pitch, 0, s.height, s.frame->data, s.frame->linesize);
    s.frame->pts = av_rescale(s.time, s.codec->time_base.den, kNsPerSecond);
    s.time += std::max<TimeNs>(duration, kNsPerMs);
    return s.send(s.frame);
}

Result<void> VideoWriter::finish() {
    State& s = *state_;
    if (std::exchange(s.finished, true)) return {};
    KINO_TRY(s.send(nullptr));
    KINO_TRY(s.check(av_write_trailer(s.format), "finishing the video"));
    return s.check(avio_closep(&s.format->pb), "closing the video");
}

}  // namespace kino
