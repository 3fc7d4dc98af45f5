#include "sensor/v4l2/video_format.h"

#include <linux/videodev2.h>
#include <strings.h>

#include <array>

namespace kino {
namespace {

constexpr auto kDepth = StreamKind::depth;
constexpr auto kColor = StreamKind::color;
constexpr auto kInfrared = StreamKind::infrared;

constexpr std::array kFormats{
    VideoFormat{V4L2_PIX_FMT_Z16, "Z16", "Z16", PixelCode::words, 16, kDepth},
    VideoFormat{V4L2_PIX_FMT_YUYV, "YUYV", "YUYV", PixelCode::yuyv, 8, kColor},
    VideoFormat{V4L2_PIX_FMT_MJPEG, "MJPG", "MJPEG", PixelCode::jpeg, 8, kColor},
    VideoFormat{V4L2_PIX_FMT_SGRBG8, "GRBG", "SGRBG8", PixelCode::bayer, 8, kColor},
    // After Bayer: a Kinect gives this at half the rate.
    VideoFormat{V4L2_PIX_FMT_UYVY, "UYVY", "UYVY", PixelCode::uyvy, 8, kColor},
    VideoFormat{V4L2_PIX_FMT_Y16, "Y16", "Y16", PixelCode::words, 16, kInfrared},
    VideoFormat{V4L2_PIX_FMT_Y16_BE, "Y16-BE", "Y16_BE", PixelCode::words_be, 16, kInfrared},
    VideoFormat{V4L2_PIX_FMT_Y12, "Y12", "Y12", PixelCode::words, 12, kInfrared},
    VideoFormat{V4L2_PIX_FMT_Y10, "Y10", "Y10", PixelCode::words, 10, kInfrared},
    VideoFormat{V4L2_PIX_FMT_Y10BPACK, "Y10B", "Y10BPACK", PixelCode::packed10, 10, kInfrared},
    VideoFormat{V4L2_PIX_FMT_GREY, "GREY", "GREY", PixelCode::bytes, 8, kInfrared},
};

}  // namespace

bool VideoFormat::can_be(StreamKind as) const {
    switch (code) {
        case PixelCode::packed10:
        case PixelCode::words:
        case PixelCode::words_be:
            return as == kDepth || as == kInfrared;
        case PixelCode::bytes:
            return as == kInfrared || as == kColor;
        case PixelCode::bayer:
        case PixelCode::uyvy:
        case PixelCode::yuyv:
        case PixelCode::jpeg:
            return as == kColor;
    }
    return false;
}

std::size_t VideoFormat::row_bytes(int width) const {
    const auto pixels = static_cast<std::size_t>(width);
    switch (code) {
        case PixelCode::packed10:
            return (pixels * 10 + 7) / 8;
        case PixelCode::words:
        case PixelCode::words_be:
        case PixelCode::uyvy:
        case PixelCode::yuyv:
            return pixels * 2;
        case PixelCode::bytes:
        case PixelCode::bayer:
            return pixels;
        case PixelCode::jpeg:
            return 0;
    }
    return 0;
}

std::span<const VideoFormat> video_formats() {
    return kFormats;
}

const VideoFormat* find_video_format(std::uint32_t fourcc) {
    for (const VideoFormat& format : kFormats)
        if (format.fourcc == fourcc) return &format;
    return nullptr;
}

const VideoFormat* find_video_format(const std::string& name) {
    for (const VideoFormat& format : kFormats)
        if (strcasecmp(format.name, name.c_str()) == 0 ||
            strcasecmp(format.kernel_name, name.c_str()) == 0)
            return &format;
    return nullptr;
}

std::string fourcc_text(std::uint32_t fourcc) {
    constexpr std::uint32_t kBigEndian = 1u << 31;
    std::string text;
    for (unsigned shift = 0; shift < 32; shift += 8) {
        const auto letter = static_cast<char>((fourcc & ~kBigEndian) >> shift & 0xff);
        text += letter >= ' ' && letter <= '~' ? letter : '.';
    }
    text.erase(text.find_last_not_of(' ') + 1);
    return fourcc & kBigEndian ? text + "-BE" : text;
}

}  // namespace kino
