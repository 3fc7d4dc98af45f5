#include "sensor/v4l2/buffer_decoder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "base/check.h"
#include "sensor/v4l2/pixel_unpack.h"

namespace kino {
namespace {

using Bytes = std::span<const std::uint8_t>;

/// Pixels of the row that lie wholly in its first `bytes` bytes.
std::size_t pixels_in(const VideoFormat& format, std::size_t bytes) {
    switch (format.code) {
        case PixelCode::packed10:
            return bytes * 8 / 10;
        case PixelCode::words:
        case PixelCode::words_be:
            return bytes / 2;
        default:
            return bytes;
    }
}

void unpack_row(const BufferLayout& layout, const std::uint8_t* row, std::size_t count,
                std::uint16_t* out) {
    const VideoFormat& format = *layout.format;
    switch (format.code) {
        case PixelCode::packed10:
            unpack_packed10(row, count, out);
            if (layout.kind == StreamKind::depth && layout.unit == DepthUnit::kinect_disparity11)
                widen_disparity10(out, count);
            return;
        case PixelCode::bytes:
            std::copy(row, row + count, out);
            return;
        default: {
            const auto mask = static_cast<std::uint16_t>((1u << format.bits) - 1);
            unpack_words(row, count, format.code == PixelCode::words_be, mask, out);
        }
    }
}

/// How many rows are whole, and how many bytes of the next one there are.
struct Arrived {
    int rows = 0;
    std::size_t rest = 0;
};

Arrived arrived(const BufferLayout& layout, std::size_t bytes) {
    const std::size_t row_bytes = layout.format->row_bytes(layout.width);
    if (bytes >= layout.whole_bytes()) return {layout.height, 0};
    // The padding of the last whole row need not have come.
    auto rows = bytes / layout.stride;
    std::size_t rest = bytes % layout.stride;
    if (rest >= row_bytes) {
        ++rows;
        rest = 0;
    }
    return {static_cast<int>(rows), rest};
}

std::vector<RowRange> missing(const BufferLayout& layout, const Arrived& there) {
    if (there.rows == layout.height) return {};
    return {{there.rows, layout.height - there.rows}};
}

Image<std::uint16_t> unpack(const BufferLayout& layout, Bytes bytes, const Arrived& there,
                            std::uint16_t no_reading) {
    Image<std::uint16_t> out;
    out.resize(layout.width, layout.height);
    const auto width = static_cast<std::size_t>(layout.width);
    for (int y = 0; y < there.rows; ++y)
        unpack_row(layout, bytes.data() + static_cast<std::size_t>(y) * layout.stride, width,
                   out.row(y));
    for (int y = there.rows; y < layout.height; ++y)
        std::fill(out.row(y), out.row(y) + width, no_reading);
    if (there.rest > 0)
        unpack_row(layout, bytes.data() + static_cast<std::size_t>(there.rows) * layout.stride,
                   std::min(width, pixels_in(*layout.format, there.rest)), out.row(there.rows));
    return out;
}

PixelFormat color_format(PixelCode code) {
    switch (code) {
        case PixelCode::uyvy:
            return PixelFormat::uyvy;
        case PixelCode::yuyv:
            return PixelFormat::yuyv;
        case PixelCode::bayer:
            return PixelFormat::bayer_grbg8;
        case PixelCode::jpeg:
            return PixelFormat::mjpeg;
        default:
            return PixelFormat::gray8;
    }
}

/// Up to and with the last end marker; empty if the markers are not there. Webcams pad the end.
Bytes whole_jpeg(Bytes bytes) {
    if (bytes.size() < 4 || bytes[0] != 0xff || bytes[1] != 0xd8) return {};
    for (std::size_t end = bytes.size(); end >= 4; --end)
        if (bytes[end - 1] == 0xd9 && bytes[end - 2] == 0xff) return bytes.first(end);
    return {};
}

std::shared_ptr<ColorFrame> empty_color(const BufferLayout& layout, const FrameHeader& header) {
    auto frame = std::make_shared<ColorFrame>();
    frame->header = header;
    frame->format = color_format(layout.format->code);
    frame->width = layout.width;
    frame->height = layout.height;
    frame->matrix = layout.matrix;
    frame->range = layout.range;
    return frame;
}

std::shared_ptr<const ColorFrame> color_rows(const BufferLayout& layout, Bytes bytes,
                                             const Arrived& there, const FrameHeader& header) {
    auto frame = empty_color(layout, header);
    const std::size_t row_bytes = layout.format->row_bytes(layout.width);
    frame->pitch = static_cast<int>(row_bytes);
    frame->bytes.resize(row_bytes * static_cast<std::size_t>(layout.height));
    const auto rows = static_cast<std::size_t>(there.rows);
    for (std::size_t y = 0; y < rows; ++y)
        std::memcpy(frame->bytes.data() + y * row_bytes, bytes.data() + y * layout.stride,
                    row_bytes);
    if (there.rest > 0)
        std::memcpy(frame->bytes.data() + rows * row_bytes, bytes.data() + rows * layout.stride,
                    there.rest);
    frame->damaged_rows = missing(layout, there);
    return frame;
}

}  // namespace

std::size_t BufferLayout::whole_bytes() const {
    if (!format->has_rows()) return 1;
    return stride * static_cast<std::size_t>(height - 1) + format->row_bytes(width);
}

Result<void> validate(const BufferLayout& layout) {
    if (layout.format == nullptr) return fail("no pixel format");
    const std::string name = layout.format->name;
    if (layout.width < 1 || layout.height < 1 || layout.width > kMaxVideoSize ||
        layout.height > kMaxVideoSize)
        return fail(fmt::format("{} pictures of {}x{} are not possible", name, layout.width,
                                layout.height));
    if (!layout.format->can_be(layout.kind))
        return fail(fmt::format("{} cannot be {}", name, stream_name(layout.kind)));
    const bool pairs =
        layout.format->code == PixelCode::uyvy || layout.format->code == PixelCode::yuyv;
    if (pairs && layout.width % 2 != 0)
        return fail(fmt::format("{} of odd width {}", name, layout.width));
    if (layout.format->has_rows() && layout.stride < layout.format->row_bytes(layout.width))
        return fail(fmt::format("{} rows of {} pixels do not fit into {} bytes", name, layout.width,
                                layout.stride));
    constexpr std::size_t kMostStride = std::size_t{kMaxVideoSize} * 16;
    if (layout.format->has_rows() && layout.stride > kMostStride)
        return fail(fmt::format("{} rows of {} bytes are not possible", name, layout.stride));
    return {};
}

Result<StreamFrame> decode_buffer(const BufferLayout& layout, Bytes bytes,
                                  const FrameHeader& header) {
    KINO_CHECK(layout.format != nullptr);
    if (!layout.format->has_rows()) {
        const Bytes picture = whole_jpeg(bytes);
        if (picture.empty()) return fail("a JPEG picture without its start or end");
        auto frame = empty_color(layout, header);
        frame->bytes.assign(picture.begin(), picture.end());
        return StreamFrame{std::shared_ptr<const ColorFrame>(std::move(frame))};
    }

    const Arrived there = arrived(layout, bytes.size());
    if (there.rows < layout.height && !layout.short_rows_in_place)
        return fail(fmt::format("{} bytes instead of {}, and what is missing is not known",
                                bytes.size(), layout.whole_bytes()));
    if (there.rows == 0) return fail(fmt::format("{} bytes are not even one row", bytes.size()));

    switch (layout.kind) {
        case StreamKind::depth: {
            auto frame = std::make_shared<DepthFrame>();
            frame->header = header;
            frame->unit = layout.unit;
            frame->metres_per_unit = layout.metres_per_unit;
            const bool disparity = layout.unit == DepthUnit::kinect_disparity11;
            frame->raw = unpack(layout, bytes, there, disparity ? 2047 : 0);
            frame->damaged_rows = missing(layout, there);
            return StreamFrame{std::shared_ptr<const DepthFrame>(std::move(frame))};
        }
        case StreamKind::infrared: {
            auto frame = std::make_shared<InfraredFrame>();
            frame->header = header;
            frame->significant_bits = layout.format->bits;
            frame->raw = unpack(layout, bytes, there, 0);
            frame->damaged_rows = missing(layout, there);
            return StreamFrame{std::shared_ptr<const InfraredFrame>(std::move(frame))};
        }
        default:
            return StreamFrame{color_rows(layout, bytes, there, header)};
    }
}

}  // namespace kino
