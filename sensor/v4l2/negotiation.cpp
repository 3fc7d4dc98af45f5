#include "sensor/v4l2/negotiation.h"

#include <fmt/format.h>
#include <linux/videodev2.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>

#include "sensor/v4l2/frame_sizes.h"

namespace kino {
namespace {

constexpr FrameSize kUsualSize{640, 480};

std::uint32_t buffer_type(bool multi_planar) {
    return multi_planar ? V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE : V4L2_BUF_TYPE_VIDEO_CAPTURE;
}

template <std::size_t N>
std::string text_of(const std::uint8_t (&field)[N]) {
    const auto* const text = reinterpret_cast<const char*>(field);
    return {text, strnlen(text, N)};
}

/// The parts of v4l2_format that both kinds of planes have.
struct FormatFields {
    std::uint32_t fourcc = 0, width = 0, height = 0, stride = 0, bytes = 0;
    std::uint32_t colorspace = 0, encoding = 0, quantization = 0;
};

FormatFields fields_of(const v4l2_format& format, bool multi_planar) {
    if (multi_planar) {
        const v4l2_pix_format_mplane& pix = format.fmt.pix_mp;
        const v4l2_plane_pix_format& plane = pix.plane_fmt[0];
        return {pix.pixelformat, pix.width,      pix.height,    plane.bytesperline,
                plane.sizeimage, pix.colorspace, pix.ycbcr_enc, pix.quantization};
    }
    const v4l2_pix_format& pix = format.fmt.pix;
    return {pix.pixelformat, pix.width,      pix.height,    pix.bytesperline,
            pix.sizeimage,   pix.colorspace, pix.ycbcr_enc, pix.quantization};
}

Result<v4l2_format> set_format(const VideoDevice& device, bool multi_planar, std::uint32_t fourcc,
                               FrameSize size) {
    v4l2_format format{};
    format.type = buffer_type(multi_planar);
    // What the driver has now is where fields start from that we have no wish about.
    if (const Called got = device.call(VIDIOC_G_FMT, format); !got)
        return device.fails(got.error());
    const auto width = static_cast<std::uint32_t>(size.width);
    const auto height = static_cast<std::uint32_t>(size.height);
    if (multi_planar) {
        v4l2_pix_format_mplane& pix = format.fmt.pix_mp;
        pix.pixelformat = fourcc;
        pix.num_planes = 1;
        pix.field = V4L2_FIELD_NONE;
        std::memset(pix.plane_fmt, 0, sizeof pix.plane_fmt);
        if (width > 0) pix.width = width, pix.height = height;
    } else {
        v4l2_pix_format& pix = format.fmt.pix;
        pix.pixelformat = fourcc;
        pix.field = V4L2_FIELD_NONE;
        pix.bytesperline = pix.sizeimage = 0;
        if (width > 0) pix.width = width, pix.height = height;
    }
    if (const Called set = device.call(VIDIOC_S_FMT, format); !set)
        return device.fails(set.error());
    if (multi_planar && format.fmt.pix_mp.num_planes != 1)
        return fail(fmt::format("{} in {} planes", fourcc_text(fourcc),
                                static_cast<int>(format.fmt.pix_mp.num_planes)),
                    device.path());
    return format;
}

void set_color_meaning(const FormatFields& fields, BufferLayout& layout) {
    const std::uint32_t encoding =
        fields.encoding != V4L2_YCBCR_ENC_DEFAULT
            ? fields.encoding
            : static_cast<std::uint32_t>(V4L2_MAP_YCBCR_ENC_DEFAULT(fields.colorspace));
    const bool bt709 = encoding == V4L2_YCBCR_ENC_709 || encoding == V4L2_YCBCR_ENC_XV709;
    layout.matrix = bt709 ? YuvMatrix::bt709 : YuvMatrix::bt601;
    const std::uint32_t quantization =
        fields.quantization != V4L2_QUANTIZATION_DEFAULT
            ? fields.quantization
            : static_cast<std::uint32_t>(
                  V4L2_MAP_QUANTIZATION_DEFAULT(false, fields.colorspace, encoding));
    layout.range =
        quantization == V4L2_QUANTIZATION_FULL_RANGE ? YuvRange::full : YuvRange::limited;
}

/// Asks for the rate where the driver takes one, and says which it has; 0 if it does not know.
Result<double> set_rate(const VideoDevice& device, bool multi_planar, std::uint32_t fourcc,
                        FrameSize size, double fps) {
    v4l2_streamparm parameters{};
    parameters.type = buffer_type(multi_planar);
    if (const Called got = device.call(VIDIOC_G_PARM, parameters); !got) {
        if (means_gone(got.error().error)) return device.fails(got.error());
        return 0;
    }
    v4l2_captureparm& capture = parameters.parm.capture;
    if (fps > 0 && (capture.capability & V4L2_CAP_TIMEPERFRAME) != 0) {
        KINO_ASSIGN(const FrameInterval interval,
                    nearest_frame_interval(device, fourcc, size, fps));
        capture.timeperframe = {interval.numerator, interval.denominator};
        if (const Called set = device.call(VIDIOC_S_PARM, parameters); !set)
            return device.fails(set.error());
    }
    const double hz =
        FrameInterval{capture.timeperframe.numerator, capture.timeperframe.denominator}.hz();
    return hz <= 10000 ? hz : 0;
}

/// gspca_kinect answers no question about rates; these are what its registers are set to.
double kinect_hz(const VideoFormat& format, int width) {
    if (format.code == PixelCode::uyvy) return 15;
    return width > 640 ? 10 : 30;
}

/// The best format that the address and the node agree on.
Result<const VideoFormat*> choose_format(const VideoDevice& device,
                                         const VideoCapabilities& capabilities,
                                         const V4l2Address& wanted) {
    KINO_ASSIGN(const auto offered, list_pixel_formats(device, capabilities.multi_planar));
    const VideoFormat* const asked =
        wanted.format.empty() ? nullptr : find_video_format(wanted.format);
    // A Kinect in depth mode offers its packed format alone.
    std::string names;
    for (const std::uint32_t fourcc : offered)
        names += (names.empty() ? "" : ", ") + fourcc_text(fourcc);
    for (const bool natural_only : {true, false}) {
        for (const VideoFormat& format : video_formats()) {
            if (std::find(offered.begin(), offered.end(), format.fourcc) == offered.end()) continue;
            if (asked != nullptr && asked != &format) continue;
            if (wanted.as && !format.can_be(*wanted.as)) continue;
            if (natural_only && wanted.as && format.kind != *wanted.as) continue;
            return &format;
        }
    }
    return fail(
        fmt::format("no picture format that fits: it has {}", names.empty() ? "none" : names),
        device.path(), "`format=` and `as=` in the address choose among them");
}

}  // namespace

StreamKind natural_kind(const VideoFormat& format, bool kinect, int width, int height) {
    if (kinect && format.code == PixelCode::packed10 && width == 640 && height == 480)
        return StreamKind::depth;
    return format.kind;
}

Result<VideoCapabilities> query_capabilities(const VideoDevice& device) {
    v4l2_capability answer{};
    if (const Called called = device.call(VIDIOC_QUERYCAP, answer); !called)
        return device.fails(called.error());
    const std::uint32_t caps = (answer.capabilities & V4L2_CAP_DEVICE_CAPS) != 0
                                   ? answer.device_caps
                                   : answer.capabilities;
    VideoCapabilities out;
    out.driver = text_of(answer.driver);
    out.card = text_of(answer.card);
    out.bus = text_of(answer.bus_info);
    const bool single = (caps & V4L2_CAP_VIDEO_CAPTURE) != 0;
    const bool multiple = (caps & V4L2_CAP_VIDEO_CAPTURE_MPLANE) != 0;
    out.multi_planar = multiple && !single;
    out.captures = (single || multiple) && (caps & V4L2_CAP_STREAMING) != 0;
    return out;
}

Result<std::vector<std::uint32_t>> list_pixel_formats(const VideoDevice& device,
                                                      bool multi_planar) {
    constexpr std::uint32_t kMostFormats = 512;
    std::vector<std::uint32_t> formats;
    for (std::uint32_t i = 0; i < kMostFormats; ++i) {
        v4l2_fmtdesc entry{};
        entry.index = i;
        entry.type = buffer_type(multi_planar);
        if (const Called called = device.call(VIDIOC_ENUM_FMT, entry); !called) {
            if (called.error().error == EINVAL) break;
            return device.fails(called.error());
        }
        formats.push_back(entry.pixelformat);
    }
    return formats;
}

Result<VideoMode> negotiate(const VideoDevice& device, const VideoCapabilities& capabilities,
                            const V4l2Address& wanted) {
    const bool kinect = capabilities.is_kinect();
    KINO_ASSIGN(const VideoFormat* const chosen, choose_format(device, capabilities, wanted));
    FrameSize size{wanted.width, wanted.height};
    if (size.width == 0) {
        KINO_ASSIGN(size, nearest_frame_size(device, chosen->fourcc, kUsualSize));
    }
    KINO_ASSIGN(const v4l2_format set,
                set_format(device, capabilities.multi_planar, chosen->fourcc, size));
    const FormatFields fields = fields_of(set, capabilities.multi_planar);
    const VideoFormat* const format = find_video_format(fields.fourcc);
    if (format == nullptr || (!wanted.format.empty() && format != chosen))
        return fail(
            fmt::format("asked for {} it gives {}", chosen->name, fourcc_text(fields.fourcc)),
            device.path());

    VideoMode mode;
    BufferLayout& layout = mode.layout;
    layout.format = format;
    constexpr std::uint32_t kBeyond = kMaxVideoSize + 1;
    layout.width = static_cast<int>(std::min(fields.width, kBeyond));
    layout.height = static_cast<int>(std::min(fields.height, kBeyond));
    layout.stride = fields.stride != 0 ? fields.stride : format->row_bytes(layout.width);
    layout.kind = wanted.as.value_or(natural_kind(*format, kinect, layout.width, layout.height));
    if (kinect && layout.kind == StreamKind::depth &&
        natural_kind(*format, kinect, layout.width, layout.height) != StreamKind::depth)
        return fail("this Kinect gives pictures, not depth", device.path(),
                    "its driver gives one or the other: `sudo modprobe -r gspca_kinect && sudo "
                    "modprobe gspca_kinect depth_mode=1`; kinect1: gives both at once");
    layout.unit = layout.kind == StreamKind::depth && format->code == PixelCode::packed10
                      ? DepthUnit::kinect_disparity11
                      : DepthUnit::linear;
    layout.short_rows_in_place = !capabilities.on_usb() && !kinect;
    set_color_meaning(fields, layout);
    if (auto valid = validate(layout); !valid) return fail(std::move(valid).error(), device.path());

    mode.buffer_bytes = std::max<std::size_t>(fields.bytes, layout.whole_bytes());
    mode.text = fmt::format("{} {}x{}", format->name, layout.width, layout.height);
    KINO_ASSIGN(mode.hz, set_rate(device, capabilities.multi_planar, format->fourcc,
                                  {layout.width, layout.height}, wanted.fps));
    if (mode.hz == 0 && kinect) mode.hz = kinect_hz(*format, layout.width);
    return mode;
}

Result<void> negotiate_again(const VideoDevice& device, const VideoCapabilities& capabilities,
                             const V4l2Address& wanted, const VideoMode& mode) {
    V4l2Address same = wanted;
    same.format = mode.layout.format->name;
    same.width = mode.layout.width;
    same.height = mode.layout.height;
    KINO_ASSIGN(const VideoMode now, negotiate(device, capabilities, same));
    if (now.text != mode.text || now.layout.stride != mode.layout.stride ||
        now.buffer_bytes != mode.buffer_bytes)
        return fail(fmt::format("gives {} now, which was {}", now.text, mode.text), device.path());
    return {};
}

}  // namespace kino
