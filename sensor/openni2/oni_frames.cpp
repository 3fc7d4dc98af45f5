#include "sensor/openni2/oni_frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <utility>

#include "base/check.h"
#include "sensor/jpeg.h"
#include "sensor/openni2/oni_depth_codec.h"
#include "sensor/openni2/openni_c.h"
#include "sensor/openni2/openni_image.h"

namespace kino {
namespace {

int bytes_per_pixel(int format) {
    switch (format) {
        case openni::kRgb888:
            return 3;
        case openni::kGray8:
            return 1;
        case openni::kJpeg:
            return 0;
        default:
            return 2;
    }
}

/// The format of the decoded frames.
int format_of(const OniNode& node) {
    if (node.codec == oni::kCodecJpeg) return openni::kRgb888;
    if (node.pixel_format != 0) return node.pixel_format;
    return node.type == oni::kDepthNode   ? openni::kDepth1Mm
           : node.type == oni::kImageNode ? openni::kRgb888
                                          : openni::kGray16;
}

std::size_t frame_bytes(const OniNode& node) {
    return static_cast<std::size_t>(node.width) * static_cast<std::size_t>(node.height) *
           static_cast<std::size_t>(bytes_per_pixel(format_of(node)));
}

bool is_16z(const OniNode& node) {
    return node.codec == oni::kCodec16z || node.codec == oni::kCodec16zTable;
}

/// Whether this codec can hold frames of that kind, and is understood.
bool known(const OniNode& node) {
    const int format = format_of(node);
    if (is_16z(node)) return bytes_per_pixel(format) == 2;
    if (node.codec == oni::kCodecJpeg) {
        return node.type == oni::kImageNode &&
               (node.pixel_format == 0 || node.pixel_format == openni::kRgb888);
    }
    return node.codec == oni::kCodecNone;
}

}  // namespace

Result<std::unique_ptr<OniFrames>> OniFrames::open(const std::filesystem::path& file) {
    auto frames = std::unique_ptr<OniFrames>(new OniFrames);
    frames->file_ = file;
    KINO_ASSIGN(frames->input_, open_oni_input(file));
    auto walked = walk_oni(*frames->input_);
    if (!walked) return fail(std::move(walked).error(), file.string());
    frames->records_ = std::move(*walked);
    const OniRecords& records = frames->records_;
    bool all_known = true;
    for (std::size_t i = 0; i < records.nodes.size(); ++i) {
        const OniNode& node = records.nodes[i];
        all_known &= known(node);
        if (node.frames.empty() || !known(node)) continue;
        if (node.type == oni::kDepthNode) frames->depth_node_ = static_cast<int>(i);
        if (node.type == oni::kImageNode) frames->color_node_ = static_cast<int>(i);
    }
    if (frames->depth_node_ < 0) {
        return fail("the ONI file holds no depth that can be read", file.string());
    }
    if (!all_known) frames->remark_ = "a stream of unknown codec left out";
    return frames;
}

const OniNode& OniFrames::node(int index) const {
    KINO_CHECK_LE(0, index);
    return records_.nodes[static_cast<std::size_t>(index)];
}

int OniFrames::depth_format() const {
    return format_of(node(depth_node_));
}
int OniFrames::color_format() const {
    return format_of(node(color_node_));
}

TimeNs OniFrames::depth_time(std::size_t frame) const {
    return static_cast<TimeNs>(records_.data[node(depth_node_).frames[frame]].time_us) * 1000;
}

Result<DepthFrame> OniFrames::depth(std::size_t frame) {
    const OniNode& from = node(depth_node_);
    KINO_ASSIGN(const auto bytes, pixels(depth_node_, frame));
    KINO_ASSIGN(DepthFrame out, depth_from_openni({format_of(from), from.width, from.height,
                                                   2 * from.width, from.mirrored, bytes}));
    out.header.device_time = depth_time(frame);
    return out;
}

Result<ColorFrame> OniFrames::color(std::size_t frame) {
    const OniNode& from = node(color_node_);
    KINO_ASSIGN(const auto bytes, pixels(color_node_, frame));
    const int format = format_of(from);
    KINO_ASSIGN(ColorFrame out,
                color_from_openni({format, from.width, from.height,
                                   bytes_per_pixel(format) * from.width, from.mirrored, bytes}));
    out.header.device_time = static_cast<TimeNs>(records_.data[from.frames[frame]].time_us) * 1000;
    return out;
}

Result<std::vector<std::uint8_t>> OniFrames::pixels(int index, std::size_t frame) {
    const OniNode& from = node(index);
    const OniData& data = records_.data[from.frames[frame]];
    const auto damaged = [&] {
        return fail(fmt::format("byte {}: frame {} of {} is damaged", data.position, frame,
                                from.type == oni::kDepthNode ? "depth" : "colour"),
                    file_.string());
    };
    KINO_ASSIGN(auto payload, read_payload(*input_, data));
    if (from.codec == oni::kCodecNone) {
        const bool fits = format_of(from) == openni::kJpeg || payload.size() == frame_bytes(from);
        if (!fits) return damaged();
        return payload;
    }
    std::vector<std::uint8_t> out(frame_bytes(from));
    if (is_16z(from)) {
        std::vector<std::uint16_t> words(out.size() / 2);
        if (!decode_16z(payload, from.codec == oni::kCodec16zTable, words)) return damaged();
        std::memcpy(out.data(), words.data(), out.size());
        return out;
    }
    Image<Rgba8> picture;
    if (!decode_jpeg(payload, from.width, from.height, picture)) return damaged();
    std::uint8_t* to = out.data();
    for (const Rgba8& pixel : picture.pixels()) {
        *to++ = pixel.r;
        *to++ = pixel.g;
        *to++ = pixel.b;
    }
    return out;
}

}  // namespace kino
