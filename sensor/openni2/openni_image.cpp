#include "sensor/openni2/openni_image.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "sensor/openni2/openni_c.h"

namespace kino {
namespace {

constexpr std::uint16_t kNoDisparity = 2047;

/// Checks that every row lies inside the bytes.
Result<void> check_size(const OpenniPixels& pixels, int bytes_per_pixel) {
    const std::int64_t row = std::int64_t{bytes_per_pixel} * pixels.width;
    if (pixels.width <= 0 || pixels.height <= 0 || pixels.stride < row) {
        return fail(fmt::format("OpenNI2 gave a frame of {} x {} with rows of {} bytes",
                                pixels.width, pixels.height, pixels.stride));
    }
    const std::int64_t needed = std::int64_t{pixels.stride} * (pixels.height - 1) + row;
    if (static_cast<std::int64_t>(pixels.bytes.size()) < needed) {
        return fail(
            fmt::format("OpenNI2 gave {} bytes for a frame of {}", pixels.bytes.size(), needed));
    }
    return {};
}

/// Calls `put(x, y, bytes of the pixel)` for every pixel of the unmirrored picture.
template <class Put>
void for_each_pixel(const OpenniPixels& pixels, int bytes_per_pixel, Put&& put) {
    for (int y = 0; y < pixels.height; ++y) {
        const std::uint8_t* row = pixels.bytes.data() + std::ptrdiff_t{pixels.stride} * y;
        for (int x = 0; x < pixels.width; ++x, row += bytes_per_pixel) {
            put(pixels.mirrored ? pixels.width - 1 - x : x, y, row);
        }
    }
}

Image<std::uint16_t> words(const OpenniPixels& pixels) {
    Image<std::uint16_t> out(pixels.width, pixels.height);
    if (pixels.mirrored) {
        for_each_pixel(pixels, 2, [&](int x, int y, const std::uint8_t* bytes) {
            std::memcpy(&out.at(x, y), bytes, 2);
        });
        return out;
    }
    for (int y = 0; y < pixels.height; ++y) {
        std::memcpy(out.row(y), pixels.bytes.data() + std::ptrdiff_t{pixels.stride} * y,
                    std::size_t{2} * pixels.width);
    }
    return out;
}

}  // namespace

Result<DepthFrame> depth_from_openni(const OpenniPixels& pixels) {
    DepthFrame frame;
    switch (pixels.pixel_format) {
        case openni::kDepth1Mm:
            frame.metres_per_unit = 0.001;
            break;
        case openni::kDepth100Um:
            frame.metres_per_unit = 0.0001;
            break;
        case openni::kShift92:
        case openni::kShift93:
            frame.unit = DepthUnit::kinect_disparity11;
            break;
        default:
            return fail(fmt::format("OpenNI2 depth format {}", pixels.pixel_format));
    }
    KINO_TRY(check_size(pixels, 2));
    frame.raw = words(pixels);
    if (frame.unit == DepthUnit::kinect_disparity11) {
        const int dropped = pixels.pixel_format == openni::kShift93 ? 1 : 0;
        for (std::uint16_t& value : frame.raw.pixels()) {
            const int shift = value >> dropped;
            value = shift == 0 || shift > kNoDisparity ? kNoDisparity
                                                       : static_cast<std::uint16_t>(shift);
        }
    }
    return frame;
}

Result<ColorFrame> color_from_openni(const OpenniPixels& pixels) {
    ColorFrame frame;
    int bytes_per_pixel = 0;
    switch (pixels.pixel_format) {
        case openni::kRgb888:
            frame.format = PixelFormat::rgb8;
            bytes_per_pixel = 3;
            break;
        case openni::kYuv422:
            frame.format = PixelFormat::uyvy;
            bytes_per_pixel = 2;
            break;
        case openni::kYuyv:
            frame.format = PixelFormat::yuyv;
            bytes_per_pixel = 2;
            break;
        case openni::kGray8:
            frame.format = PixelFormat::gray8;
            bytes_per_pixel = 1;
            break;
        case openni::kJpeg:
            frame.format = PixelFormat::mjpeg;
            break;
        default:
            return fail(fmt::format("OpenNI2 colour format {}", pixels.pixel_format));
    }
    if (pixels.mirrored && (bytes_per_pixel == 0 || bytes_per_pixel == 2)) {
        return fail(
            fmt::format("a mirrored picture of {}", openni_format_name(pixels.pixel_format)));
    }
    frame.width = pixels.width;
    frame.height = pixels.height;
    frame.pitch = bytes_per_pixel * pixels.width;
    if (frame.format == PixelFormat::mjpeg) {
        if (pixels.bytes.empty()) return fail("OpenNI2 gave an empty JPEG");
        frame.bytes.assign(pixels.bytes.begin(), pixels.bytes.end());
        return frame;
    }
    KINO_TRY(check_size(pixels, bytes_per_pixel));
    frame.bytes.resize(static_cast<std::size_t>(frame.pitch) *
                       static_cast<std::size_t>(frame.height));
    if (pixels.mirrored) {
        for_each_pixel(pixels, bytes_per_pixel, [&](int x, int y, const std::uint8_t* bytes) {
            std::memcpy(frame.bytes.data() + std::ptrdiff_t{frame.pitch} * y + bytes_per_pixel * x,
                        bytes, static_cast<std::size_t>(bytes_per_pixel));
        });
        return frame;
    }
    for (int y = 0; y < frame.height; ++y) {
        std::memcpy(frame.bytes.data() + std::ptrdiff_t{frame.pitch} * y,
                    pixels.bytes.data() + std::ptrdiff_t{pixels.stride} * y,
                    static_cast<std::size_t>(frame.pitch));
    }
    return frame;
}

Result<InfraredFrame> infrared_from_openni(const OpenniPixels& pixels) {
    InfraredFrame frame;
    switch (pixels.pixel_format) {
        case openni::kGray16:
            KINO_TRY(check_size(pixels, 2));
            frame.raw = words(pixels);
            frame.significant_bits = 10;
            return frame;
        case openni::kGray8:
        case openni::kRgb888: {
            const int bytes_per_pixel = pixels.pixel_format == openni::kGray8 ? 1 : 3;
            KINO_TRY(check_size(pixels, bytes_per_pixel));
            frame.raw = Image<std::uint16_t>(pixels.width, pixels.height);
            frame.significant_bits = 8;
            for_each_pixel(pixels, bytes_per_pixel, [&](int x, int y, const std::uint8_t* bytes) {
                frame.raw.at(x, y) = bytes[bytes_per_pixel / 2];
            });
            return frame;
        }
        default:
            return fail(fmt::format("OpenNI2 infrared format {}", pixels.pixel_format));
    }
}

const char* openni_format_name(int pixel_format) {
    switch (pixel_format) {
        case openni::kDepth1Mm:
            return "16 bit, millimetres";
        case openni::kDepth100Um:
            return "16 bit, tenths of a millimetre";
        case openni::kShift92:
            return "11 bit, disparity";
        case openni::kShift93:
            return "12 bit, disparity";
        case openni::kRgb888:
            return "rgb";
        case openni::kYuv422:
            return "uyvy";
        case openni::kYuyv:
            return "yuyv";
        case openni::kGray8:
            return "8 bit, grey";
        case openni::kGray16:
            return "10 bit in 16, grey";
        case openni::kJpeg:
            return "jpeg";
        default:
            return "";
    }
}

}  // namespace kino
