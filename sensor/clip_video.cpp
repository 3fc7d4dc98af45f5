#include "sensor/clip_video.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <deque>
#include <map>
#include <utility>
#include <vector>

#include "base/check.h"
#include "sensor/file_bytes.h"

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/log.h>
}

namespace kino {
namespace {

constexpr std::size_t kMaxPacketBytes = std::size_t{32} << 20;
constexpr std::size_t kKeptPictureBytes = std::size_t{40} << 20;
constexpr int kMaxClipEdge = 4096;
constexpr int kIoBuffer = 1 << 15;

struct FormatClose {
    void operator()(AVFormatContext* c) const { avformat_close_input(&c); }
};
struct CodecFree {
    void operator()(AVCodecContext* c) const { avcodec_free_context(&c); }
};
struct ParametersFree {
    void operator()(AVCodecParameters* p) const { avcodec_parameters_free(&p); }
};
struct PacketFree {
    void operator()(AVPacket* p) const { av_packet_free(&p); }
};
struct FrameFree {
    void operator()(AVFrame* f) const { av_frame_free(&f); }
};
struct IoFree {
    void operator()(AVIOContext* c) const {
        av_freep(&c->buffer);
        avio_context_free(&c);
    }
};
using Format = std::unique_ptr<AVFormatContext, FormatClose>;
using Codec = std::unique_ptr<AVCodecContext, CodecFree>;
using Parameters = std::unique_ptr<AVCodecParameters, ParametersFree>;
using Packet = std::unique_ptr<AVPacket, PacketFree>;
using Frame = std::unique_ptr<AVFrame, FrameFree>;
using Io = std::unique_ptr<AVIOContext, IoFree>;

/// The file in memory, as libavformat wants to read it: no path, no protocol, no locale.
struct MemoryFile {
    std::vector<std::uint8_t> bytes;
    std::int64_t position = 0;

    static int read(void* opaque, std::uint8_t* out, int wanted) {
        auto& file = *static_cast<MemoryFile*>(opaque);
        const auto size = static_cast<std::int64_t>(file.bytes.size());
        const auto count = static_cast<int>(std::min<std::int64_t>(wanted, size - file.position));
        if (count <= 0) return AVERROR_EOF;
        std::memcpy(out, file.bytes.data() + file.position, static_cast<std::size_t>(count));
        file.position += count;
        return count;
    }

    static std::int64_t seek(void* opaque, std::int64_t offset, int whence) {
        auto& file = *static_cast<MemoryFile*>(opaque);
        const auto size = static_cast<std::int64_t>(file.bytes.size());
        whence &= ~AVSEEK_FORCE;
        if (whence == AVSEEK_SIZE) return size;
        if (whence == SEEK_CUR) offset += file.position;
        if (whence == SEEK_END) offset += size;
        if (offset < 0 || offset > size) return AVERROR(EINVAL);
        return file.position = offset;
    }
};

std::string reason(int code) {
    char text[AV_ERROR_MAX_STRING_SIZE] = {};
    av_strerror(code, text, sizeof text);
    return text;
}

/// One shown picture: its packet and the unshown ones it needs before it.
struct Entry {
    std::vector<Packet> packets;
    TimeNs time = 0;
    std::int64_t key = 0;  ///< entry its group starts at
};

/// RFC 6386, 9.1: bit 4 of the frame tag is show_frame.
bool is_shown(const AVPacket& packet) {
    return packet.size > 0 && (packet.data[0] & 0x10) != 0;
}

/// A group may only start where the container and the bitstream (bit 0 of the frame tag clear)
/// agree; damage that turns a key frame into another one then joins it to the group before.
bool is_key(const AVPacket& packet) {
    return (packet.flags & AV_PKT_FLAG_KEY) != 0 && packet.size > 0 && (packet.data[0] & 1) == 0;
}

void copy_plane(const AVFrame& frame, int plane, int width, int height, Image<std::uint8_t>& out) {
    out.resize(width, height);
    for (int y = 0; y < height; ++y) {
        const std::uint8_t* row = frame.data[plane] + std::ptrdiff_t{frame.linesize[plane]} * y;
        std::memcpy(out.row(y), row, static_cast<std::size_t>(width));
    }
}

}  // namespace

struct ClipVideo::State {
    std::string where;
    int width = 0;
    int height = 0;
    std::vector<Entry> entries;
    Parameters parameters;
    Codec codec;
    Frame frame;
    std::int64_t decoded_next = -1;  ///< entry the decoder stands before; -1: unknown
    std::map<std::int64_t, std::shared_ptr<const YuvPicture>> kept;
    std::deque<std::int64_t> kept_order;

    Result<void> read_packets(std::vector<std::uint8_t> bytes);
    Result<void> open_codec();
    Result<std::shared_ptr<const YuvPicture>> decode(std::int64_t index);
    void keep(std::int64_t index, std::shared_ptr<const YuvPicture> picture);
};

Result<void> ClipVideo::State::read_packets(std::vector<std::uint8_t> bytes) {
    MemoryFile file{std::move(bytes), 0};
    const Io io(avio_alloc_context(static_cast<unsigned char*>(av_malloc(kIoBuffer)), kIoBuffer, 0,
                                   &file, &MemoryFile::read, nullptr, &MemoryFile::seek));
    AVFormatContext* raw = avformat_alloc_context();
    if (!io || !raw) return fail("out of memory", where);
    raw->pb = io.get();
    // The one demuxer that is wanted, without probing: hostile bytes meet no other parser.
    if (const int code =
            avformat_open_input(&raw, nullptr, av_find_input_format("matroska"), nullptr);
        code < 0) {
        return fail(fmt::format("not a WebM video: {}", reason(code)), where);
    }
    const Format format(raw);
    const AVStream* stream = nullptr;
    for (unsigned i = 0; i < format->nb_streams && !stream; ++i) {
        if (format->streams[i]->codecpar->codec_id == AV_CODEC_ID_VP8) stream = format->streams[i];
    }
    if (!stream) return fail("the video holds no VP8 track", where);
    width = stream->codecpar->width;
    height = stream->codecpar->height;
    if (width <= 0 || height <= 0 || width > kMaxClipEdge || height > kMaxClipEdge) {
        return fail(fmt::format("a video of {}x{} is not readable", width, height), where);
    }
    parameters.reset(avcodec_parameters_alloc());
    frame.reset(av_frame_alloc());
    if (!parameters || !frame || avcodec_parameters_copy(parameters.get(), stream->codecpar) < 0) {
        return fail("out of memory", where);
    }

    std::vector<Packet> waiting;
    const AVRational ns{1, 1'000'000'000};
    for (;;) {
        Packet packet(av_packet_alloc());
        if (!packet || av_read_frame(format.get(), packet.get()) < 0) break;
        if (packet->stream_index != stream->index || packet->size <= 0) continue;
        const std::int64_t pts = packet->pts;
        const bool shown = is_shown(*packet);
        if (entries.empty() && waiting.empty() && !is_key(*packet)) continue;
        waiting.push_back(std::move(packet));
        if (!shown) continue;
        if (pts == AV_NOPTS_VALUE) return fail("a frame has no time", where);
        Entry entry{std::move(waiting), av_rescale_q(pts, stream->time_base, ns), 0};
        waiting.clear();
        const auto index = static_cast<std::int64_t>(entries.size());
        const bool starts_group = is_key(*entry.packets.front());
        entry.key = starts_group ? index : entries.back().key;
        if (index > 0 && entry.time <= entries.back().time) {
            return fail(fmt::format("the time of frame {} does not rise", index), where);
        }
        entries.push_back(std::move(entry));
    }
    if (entries.empty()) return fail("the video holds no frame", where);
    return {};
}

/// Every group gets a fresh decoder: flushing keeps memory of earlier frames alive that a damaged
/// packet can bring to light.
Result<void> ClipVideo::State::open_codec() {
    const AVCodec* decoder = avcodec_find_decoder(AV_CODEC_ID_VP8);
    if (!decoder) return fail("this libavcodec has no VP8 decoder", where);
    codec.reset(avcodec_alloc_context3(decoder));
    if (!codec) return fail("out of memory", where);
    codec->thread_count = 1;
    codec->err_recognition = AV_EF_EXPLODE;
    if (avcodec_parameters_to_context(codec.get(), parameters.get()) < 0 ||
        avcodec_open2(codec.get(), decoder, nullptr) < 0) {
        codec.reset();
        return fail("the VP8 decoder could not be opened", where);
    }
    return {};
}

Result<std::shared_ptr<const YuvPicture>> ClipVideo::State::decode(std::int64_t index) {
    const Entry& entry = entries[static_cast<std::size_t>(index)];
    decoded_next = -1;
    bool got = false;
    for (const Packet& packet : entry.packets) {
        int code = avcodec_send_packet(codec.get(), packet.get());
        if (code >= 0) code = avcodec_receive_frame(codec.get(), frame.get());
        if (code < 0 && code != AVERROR(EAGAIN)) {
            return fail(fmt::format("frame {} cannot be decoded: {}", index, reason(code)), where);
        }
        got = code >= 0;
    }
    if (!got || frame->format != AV_PIX_FMT_YUV420P || frame->width != width ||
        frame->height != height) {
        return fail(fmt::format("frame {} does not have the video's layout", index), where);
    }
    auto picture = std::make_shared<YuvPicture>();
    copy_plane(*frame, 0, width, height, picture->y);
    copy_plane(*frame, 1, (width + 1) / 2, (height + 1) / 2, picture->u);
    copy_plane(*frame, 2, (width + 1) / 2, (height + 1) / 2, picture->v);
    av_frame_unref(frame.get());
    decoded_next = index + 1;
    return picture;
}

void ClipVideo::State::keep(std::int64_t index, std::shared_ptr<const YuvPicture> picture) {
    const std::size_t bytes = picture->y.size() + picture->u.size() + picture->v.size();
    const std::size_t most = std::max<std::size_t>(1, kKeptPictureBytes / bytes);
    while (kept_order.size() >= most) {
        kept.erase(kept_order.front());
        kept_order.pop_front();
    }
    if (kept.emplace(index, std::move(picture)).second) kept_order.push_back(index);
}

ClipVideo::ClipVideo(std::unique_ptr<State> state) : state_(std::move(state)) {}
ClipVideo::~ClipVideo() = default;
ClipVideo::ClipVideo(ClipVideo&&) noexcept = default;
ClipVideo& ClipVideo::operator=(ClipVideo&&) noexcept = default;

Result<ClipVideo> ClipVideo::open(const std::filesystem::path& path) {
    av_log_set_level(AV_LOG_QUIET);
    KINO_ASSIGN(auto bytes, read_file_bytes(path, kMaxPacketBytes));
    auto state = std::make_unique<State>();
    state->where = path.string();
    KINO_TRY(state->read_packets(std::move(bytes)));
    return ClipVideo(std::move(state));
}

int ClipVideo::width() const {
    return state_->width;
}
int ClipVideo::height() const {
    return state_->height;
}
std::int64_t ClipVideo::frame_count() const {
    return static_cast<std::int64_t>(state_->entries.size());
}
TimeNs ClipVideo::time_of(std::int64_t index) const {
    return state_->entries[static_cast<std::size_t>(index)].time;
}

Result<std::shared_ptr<const YuvPicture>> ClipVideo::picture(std::int64_t index) {
    KINO_CHECK_LE(0, index);
    KINO_CHECK_LT(index, frame_count());
    State& s = *state_;
    if (const auto found = s.kept.find(index); found != s.kept.end()) return found->second;
    const std::int64_t key = s.entries[static_cast<std::size_t>(index)].key;
    if (s.decoded_next < key || s.decoded_next > index) s.decoded_next = key;
    for (std::int64_t i = s.decoded_next;; ++i) {
        // A group must not depend on what was decoded before it, damaged packets included.
        if (i == key) KINO_TRY(s.open_codec());
        KINO_ASSIGN(std::shared_ptr<const YuvPicture> picture, s.decode(i));
        s.keep(i, picture);
        if (i == index) return picture;
    }
}

}  // namespace kino
