#include "sensor/kinect1/frame_maker.h"

#include <algorithm>
#include <memory>

#include "base/check.h"
#include "sensor/kinect1/unpack.h"

namespace kino::kinect1 {
namespace {

constexpr std::uint16_t kNoDepth = 2047;

struct PixelRange {
    int first = 0;
    int end = 0;
};

// Pixels in row order of which some part lies in the bytes.
PixelRange touched_pixels(const ModeTraits& mode, const ByteRange& bytes) {
    const int group_bits = mode.bits_per_pixel * mode.pixels_per_group;
    return {bytes.first * 8 / group_bits * mode.pixels_per_group,
            (bytes.end * 8 + group_bits - 1) / group_bits * mode.pixels_per_group};
}

// Overwrites them and lists their rows; T pixels of `per_pixel` elements.
template <class T>
std::vector<RowRange> mark(const ModeTraits& mode, std::span<const ByteRange> missing, T* pixels,
                           int per_pixel, T value) {
    std::vector<RowRange> rows;
    for (const ByteRange& bytes : missing) {
        const PixelRange lost = touched_pixels(mode, bytes);
        std::fill(pixels + lost.first * per_pixel, pixels + lost.end * per_pixel, value);
        const int first = lost.first / mode.width;
        const int end = (lost.end - 1) / mode.width + 1;
        if (!rows.empty() && rows.back().first + rows.back().count >= first) {
            rows.back().count = end - rows.back().first;
        } else {
            rows.push_back({first, end - first});
        }
    }
    return rows;
}

using Unpack = void (*)(const std::uint8_t*, std::size_t, std::uint16_t*);

Image<std::uint16_t> unpacked(const ModeTraits& mode, const AssembledFrame& frame, Unpack unpack) {
    Image<std::uint16_t> image;
    image.resize(mode.width, mode.height);
    unpack(frame.bytes.data(), image.size(), image.data());
    return image;
}

StreamFrame make_depth(const ModeTraits& mode, const AssembledFrame& frame,
                       const FrameHeader& header) {
    const Unpacker& unpacker = best_unpacker();
    auto out = std::make_shared<DepthFrame>();
    out->header = header;
    out->unit = DepthUnit::kinect_disparity11;
    out->raw =
        unpacked(mode, frame, mode.bits_per_pixel == 11 ? unpacker.eleven : unpacker.ten_doubled);
    out->damaged_rows = mark(mode, frame.missing, out->raw.data(), 1, kNoDepth);
    return std::shared_ptr<const DepthFrame>(std::move(out));
}

StreamFrame make_infrared(const ModeTraits& mode, const AssembledFrame& frame,
                          const FrameHeader& header) {
    auto out = std::make_shared<InfraredFrame>();
    out->header = header;
    out->raw = unpacked(mode, frame, best_unpacker().ten);
    out->significant_bits = mode.bits_per_pixel;
    out->damaged_rows = mark(mode, frame.missing, out->raw.data(), 1, std::uint16_t{0});
    return std::shared_ptr<const InfraredFrame>(std::move(out));
}

StreamFrame make_color(const ModeTraits& mode, const AssembledFrame& frame,
                       const FrameHeader& header) {
    const int bytes_per_pixel = mode.bits_per_pixel / 8;
    auto out = std::make_shared<ColorFrame>();
    out->header = header;
    out->format = mode.pixels_per_group == 2 ? PixelFormat::uyvy : PixelFormat::bayer_grbg8;
    out->width = mode.width;
    out->height = mode.height;
    out->pitch = mode.width * bytes_per_pixel;
    // libfreenect takes the camera's luma as 16 to 235.
    out->range = YuvRange::limited;
    out->bytes.assign(frame.bytes.begin(), frame.bytes.end());
    out->damaged_rows =
        mark(mode, frame.missing, out->bytes.data(), bytes_per_pixel, std::uint8_t{0});
    return std::shared_ptr<const ColorFrame>(std::move(out));
}

}  // namespace

StreamFrame make_frame(CameraMode mode, const AssembledFrame& frame, FrameHeader header) {
    const ModeTraits& t = traits(mode);
    KINO_CHECK_EQ(static_cast<int>(frame.bytes.size()), packet_layout(mode).frame_bytes);
    header.lost_before = frame.lost_before;
    switch (t.kind) {
        case StreamKind::depth:
            return make_depth(t, frame, header);
        case StreamKind::infrared:
            return make_infrared(t, frame, header);
        default:
            return make_color(t, frame, header);
    }
}

}  // namespace kino::kinect1
