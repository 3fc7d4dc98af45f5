#include "sensor/color_conversion.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "sensor/jpeg.h"

namespace kino {
namespace {

constexpr int kMaxColorEdge = 16384;
constexpr int kShift = 16;

/// ITU-R BT.601 and BT.709 in 1/65536, from Kr and Kb: r = y + 2 (1 - Kr) cr,
/// g = y - (2 Kb (1 - Kb) cb + 2 Kr (1 - Kr) cr) / Kg, b = y + 2 (1 - Kb) cb.
struct YuvCoefficients {
    int y_offset = 0;
    int y = 0, r_v = 0, g_u = 0, g_v = 0, b_u = 0;
};

YuvCoefficients coefficients(YuvMatrix matrix, YuvRange range) {
    const double kr = matrix == YuvMatrix::bt601 ? 0.299 : 0.2126;
    const double kb = matrix == YuvMatrix::bt601 ? 0.114 : 0.0722;
    const double kg = 1 - kr - kb;
    const bool full = range == YuvRange::full;
    const double luma = full ? 1.0 : 255.0 / 219.0;
    const double chroma = full ? 1.0 : 255.0 / 224.0;
    const auto fixed = [](double v) { return static_cast<int>(std::lround(v * (1 << kShift))); };
    return {.y_offset = full ? 0 : 16,
            .y = fixed(luma),
            .r_v = fixed(2 * (1 - kr) * chroma),
            .g_u = fixed(-2 * kb * (1 - kb) / kg * chroma),
            .g_v = fixed(-2 * kr * (1 - kr) / kg * chroma),
            .b_u = fixed(2 * (1 - kb) * chroma)};
}

std::uint8_t to_byte(int fixed) {
    return static_cast<std::uint8_t>(std::clamp((fixed + (1 << (kShift - 1))) >> kShift, 0, 255));
}

int bytes_per_pixel(PixelFormat format) {
    switch (format) {
        case PixelFormat::rgba8:
            return 4;
        case PixelFormat::rgb8:
            return 3;
        case PixelFormat::uyvy:
        case PixelFormat::yuyv:
            return 2;
        case PixelFormat::gray8:
        case PixelFormat::bayer_grbg8:
            return 1;
        case PixelFormat::mjpeg:
            return 0;
    }
    return 0;
}

Result<void> check_layout(const ColorFrame& frame) {
    if (frame.width <= 0 || frame.height <= 0 || frame.width > kMaxColorEdge ||
        frame.height > kMaxColorEdge) {
        return fail(
            fmt::format("a colour frame of {}x{} is not usable", frame.width, frame.height));
    }
    const bool yuv = frame.format == PixelFormat::uyvy || frame.format == PixelFormat::yuyv;
    if (yuv && frame.width % 2 != 0) {
        return fail(fmt::format("{} pixels a row do not make pairs of YUV 4:2:2", frame.width));
    }
    if (frame.format == PixelFormat::bayer_grbg8 && (frame.width < 2 || frame.height < 2)) {
        return fail("a Bayer frame needs at least 2x2 pixels");
    }
    const auto row = static_cast<std::size_t>(frame.width) *
                     static_cast<std::size_t>(bytes_per_pixel(frame.format));
    if (frame.pitch < 0 || static_cast<std::size_t>(frame.pitch) < row) {
        return fail(
            fmt::format("rows of {} bytes cannot hold {} pixels", frame.pitch, frame.width));
    }
    const std::size_t needed =
        static_cast<std::size_t>(frame.pitch) * static_cast<std::size_t>(frame.height - 1) + row;
    if (frame.bytes.size() < needed) {
        return fail(fmt::format("{} bytes do not fill a {}x{} frame", frame.bytes.size(),
                                frame.width, frame.height));
    }
    return {};
}

void convert_yuv(const ColorFrame& frame, Image<Rgba8>& out) {
    const YuvCoefficients c = coefficients(frame.matrix, frame.range);
    const bool luma_first = frame.format == PixelFormat::yuyv;
    for (int y = 0; y < frame.height; ++y) {
        const std::uint8_t* in = frame.bytes.data() + std::ptrdiff_t{frame.pitch} * y;
        Rgba8* row = out.row(y);
        for (int x = 0; x < frame.width; x += 2, in += 4) {
            const int u = in[luma_first ? 1 : 0] - 128;
            const int v = in[luma_first ? 3 : 2] - 128;
            const int red = c.r_v * v;
            const int green = c.g_u * u + c.g_v * v;
            const int blue = c.b_u * u;
            for (int i = 0; i < 2; ++i) {
                const int luma = c.y * (in[2 * i + (luma_first ? 0 : 1)] - c.y_offset);
                row[x + i] = {to_byte(luma + red), to_byte(luma + green), to_byte(luma + blue),
                              255};
            }
        }
    }
}

/// Reflection without repeating the border pixel: -1 -> 1, so that a colour stays on its colour.
int mirror(int i, int size) {
    return i < 0 ? -i : i >= size ? 2 * size - 2 - i : i;
}

void convert_bayer(const ColorFrame& frame, Image<Rgba8>& out) {
    for (int y = 0; y < frame.height; ++y) {
        const auto row_of = [&](int ry) {
            return frame.bytes.data() + std::ptrdiff_t{frame.pitch} * mirror(ry, frame.height);
        };
        const std::uint8_t* up = row_of(y - 1);
        const std::uint8_t* own = row_of(y);
        const std::uint8_t* down = row_of(y + 1);
        const bool red_row = y % 2 == 0;  // G R G R, then B G B G
        Rgba8* row = out.row(y);
        for (int x = 0; x < frame.width; ++x) {
            const int l = mirror(x - 1, frame.width);
            const int r = mirror(x + 1, frame.width);
            const auto beside = static_cast<std::uint8_t>((own[l] + own[r] + 1) / 2);
            const auto above = static_cast<std::uint8_t>((up[x] + down[x] + 1) / 2);
            const bool green = (x % 2 == 0) == red_row;
            if (green) {
                row[x] =
                    red_row ? Rgba8{beside, own[x], above, 255} : Rgba8{above, own[x], beside, 255};
                continue;
            }
            const auto cross =
                static_cast<std::uint8_t>((own[l] + own[r] + up[x] + down[x] + 2) / 4);
            const auto corners =
                static_cast<std::uint8_t>((up[l] + up[r] + down[l] + down[r] + 2) / 4);
            row[x] =
                red_row ? Rgba8{own[x], cross, corners, 255} : Rgba8{corners, cross, own[x], 255};
        }
    }
}

void convert_plain(const ColorFrame& frame, Image<Rgba8>& out) {
    const auto width = static_cast<std::size_t>(frame.width);
    for (int y = 0; y < frame.height; ++y) {
        const std::uint8_t* in = frame.bytes.data() + std::ptrdiff_t{frame.pitch} * y;
        Rgba8* row = out.row(y);
        if (frame.format == PixelFormat::rgba8) {
            std::memcpy(static_cast<void*>(row), in, width * 4);
        } else if (frame.format == PixelFormat::rgb8) {
            for (std::size_t x = 0; x < width; ++x) {
                row[x] = {in[3 * x], in[3 * x + 1], in[3 * x + 2], 255};
            }
        } else {
            for (std::size_t x = 0; x < width; ++x) row[x] = {in[x], in[x], in[x], 255};
        }
    }
}

}  // namespace

Result<void> to_rgba8(const ColorFrame& frame, Image<Rgba8>& out) {
    if (frame.format == PixelFormat::mjpeg) {
        return decode_jpeg(frame.bytes, frame.width, frame.height, out);
    }
    KINO_TRY(check_layout(frame));
    out.resize(frame.width, frame.height);
    switch (frame.format) {
        case PixelFormat::uyvy:
        case PixelFormat::yuyv:
            convert_yuv(frame, out);
            break;
        case PixelFormat::bayer_grbg8:
            convert_bayer(frame, out);
            break;
        default:
            convert_plain(frame, out);
            break;
    }
    return {};
}

}  // namespace kino
