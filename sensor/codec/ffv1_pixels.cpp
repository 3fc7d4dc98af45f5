#include "sensor/codec/ffv1_pixels.h"

#include <cstring>

extern "C" {
#include <libavutil/frame.h>
#include <libavutil/pixfmt.h>
}

namespace kino {
namespace {

std::uint8_t* row_of(const AVFrame& frame, int plane, int y) {
    return frame.data[plane] + std::ptrdiff_t{frame.linesize[plane]} * y;
}

/// Calls visit(picture row, frame, y) for every row.
template <class Pixels, class Frame, class Visit>
void each_row(const ImageFormat& format, Pixels* pixels, Frame& frame, Visit visit) {
    const std::size_t pitch = bytes_per_frame(format) / static_cast<std::size_t>(format.height);
    for (int y = 0; y < format.height; ++y) {
        visit(pixels + pitch * static_cast<std::size_t>(y), frame, y);
    }
}

/// Places of Y0, U, Y1, V in four bytes.
struct YuvOrder {
    int y0, u, y1, v;
};

YuvOrder order_of(PixelLayout layout) {
    return layout == PixelLayout::yuv422 ? YuvOrder{1, 0, 3, 2} : YuvOrder{0, 1, 2, 3};
}

}  // namespace

int ffv1_pixel_format(PixelLayout layout) {
    switch (layout) {
        case PixelLayout::gray16:
            return AV_PIX_FMT_GRAY16LE;
        case PixelLayout::gray8:
        case PixelLayout::bayer8:
            return AV_PIX_FMT_GRAY8;
        case PixelLayout::rgb8:
            return AV_PIX_FMT_BGR0;
        case PixelLayout::rgba8:
            return AV_PIX_FMT_BGRA;
        case PixelLayout::yuv422:
        case PixelLayout::yuyv422:
            return AV_PIX_FMT_YUV422P;
    }
    return AV_PIX_FMT_NONE;
}

void pack_to_frame(const ImageFormat& format, const std::uint8_t* pixels, AVFrame& frame) {
    const int width = format.width;
    each_row(format, pixels, frame, [&](const std::uint8_t* in, AVFrame& to, int y) {
        std::uint8_t* out = row_of(to, 0, y);
        switch (format.layout) {
            case PixelLayout::gray16:
                std::memcpy(out, in, 2 * static_cast<std::size_t>(width));
                break;
            case PixelLayout::gray8:
            case PixelLayout::bayer8:
                std::memcpy(out, in, static_cast<std::size_t>(width));
                break;
            case PixelLayout::rgb8:
                for (int x = 0; x < width; ++x, in += 3, out += 4) {
                    out[0] = in[2];
                    out[1] = in[1];
                    out[2] = in[0];
                    out[3] = 0;
                }
                break;
            case PixelLayout::rgba8:
                for (int x = 0; x < width; ++x, in += 4, out += 4) {
                    out[0] = in[2];
                    out[1] = in[1];
                    out[2] = in[0];
                    out[3] = in[3];
                }
                break;
            case PixelLayout::yuv422:
            case PixelLayout::yuyv422: {
                const YuvOrder at = order_of(format.layout);
                std::uint8_t* u = row_of(to, 1, y);
                std::uint8_t* v = row_of(to, 2, y);
                for (int x = 0; x < width / 2; ++x, in += 4) {
                    out[2 * x] = in[at.y0];
                    out[2 * x + 1] = in[at.y1];
                    u[x] = in[at.u];
                    v[x] = in[at.v];
                }
            }
        }
    });
}

void unpack_from_frame(const ImageFormat& format, const AVFrame& frame, std::uint8_t* pixels) {
    const int width = format.width;
    each_row(format, pixels, frame, [&](std::uint8_t* out, const AVFrame& from, int y) {
        const std::uint8_t* in = row_of(from, 0, y);
        switch (format.layout) {
            case PixelLayout::gray16:
                std::memcpy(out, in, 2 * static_cast<std::size_t>(width));
                break;
            case PixelLayout::gray8:
            case PixelLayout::bayer8:
                std::memcpy(out, in, static_cast<std::size_t>(width));
                break;
            case PixelLayout::rgb8:
                for (int x = 0; x < width; ++x, in += 4, out += 3) {
                    out[0] = in[2];
                    out[1] = in[1];
                    out[2] = in[0];
                }
                break;
            case PixelLayout::rgba8:
                for (int x = 0; x < width; ++x, in += 4, out += 4) {
                    out[0] = in[2];
                    out[1] = in[1];
                    out[2] = in[0];
                    out[3] = in[3];
                }
                break;
            case PixelLayout::yuv422:
            case PixelLayout::yuyv422: {
                const YuvOrder at = order_of(format.layout);
                const std::uint8_t* u = row_of(from, 1, y);
                const std::uint8_t* v = row_of(from, 2, y);
                for (int x = 0; x < width / 2; ++x, out += 4) {
                    out[at.y0] = in[2 * x];
                    out[at.y1] = in[2 * x + 1];
                    out[at.u] = u[x];
                    out[at.v] = v[x];
                }
            }
        }
    });
}

}  // namespace kino
