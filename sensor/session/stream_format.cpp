#include "sensor/session/stream_format.h"

#include <fmt/format.h>

#include <array>
#include <cstring>

#include "sensor/json_cursor.h"

namespace kino {
namespace {

using nlohmann::json;

template <class E, std::size_t N>
struct Names {
    std::array<std::pair<E, const char*>, N> pairs;

    [[nodiscard]] const char* name(E value) const {
        for (const auto& [other, text] : pairs) {
            if (other == value) return text;
        }
        return "";
    }

    [[nodiscard]] Result<E> read(const JsonCursor& object, const char* key) const {
        KINO_ASSIGN(const JsonCursor member, object.member(key));
        KINO_ASSIGN(const std::string text, member.text());
        for (const auto& [value, other] : pairs) {
            if (text == other) return value;
        }
        return member.error(fmt::format("\"{}\" is not known", text));
    }
};

constexpr Names<StreamKind, 5> kKinds{{{{StreamKind::depth, "depth"},
                                        {StreamKind::color, "color"},
                                        {StreamKind::infrared, "infrared"},
                                        {StreamKind::bodies, "bodies"},
                                        {StreamKind::motion, "motion"}}}};
constexpr Names<ImageCodec, 4> kCodecs{{{{ImageCodec::raw, "raw"},
                                         {ImageCodec::ffv1, "ffv1"},
                                         {ImageCodec::rvl_zstd, "rvl_zstd"},
                                         {ImageCodec::fast, "fast"}}}};
constexpr Names<DepthUnit, 2> kUnits{
    {{{DepthUnit::linear, "linear"}, {DepthUnit::kinect_disparity11, "kinect_disparity11"}}}};
constexpr Names<PixelFormat, 7> kPixels{{{{PixelFormat::rgba8, "rgba8"},
                                          {PixelFormat::rgb8, "rgb8"},
                                          {PixelFormat::gray8, "gray8"},
                                          {PixelFormat::bayer_grbg8, "bayer_grbg8"},
                                          {PixelFormat::uyvy, "uyvy"},
                                          {PixelFormat::yuyv, "yuyv"},
                                          {PixelFormat::mjpeg, "mjpeg"}}}};
constexpr Names<YuvMatrix, 2> kMatrices{
    {{{YuvMatrix::bt601, "bt601"}, {YuvMatrix::bt709, "bt709"}}}};
constexpr Names<YuvRange, 2> kRanges{{{{YuvRange::full, "full"}, {YuvRange::limited, "limited"}}}};

PixelLayout layout_of(PixelFormat format) {
    switch (format) {
        case PixelFormat::rgba8:
            return PixelLayout::rgba8;
        case PixelFormat::rgb8:
            return PixelLayout::rgb8;
        case PixelFormat::bayer_grbg8:
            return PixelLayout::bayer8;
        case PixelFormat::uyvy:
            return PixelLayout::yuv422;
        case PixelFormat::yuyv:
            return PixelLayout::yuyv422;
        case PixelFormat::gray8:
        case PixelFormat::mjpeg:
            break;
    }
    return PixelLayout::gray8;
}

ImageCodec codec_of(SessionCodec codec, PixelLayout layout) {
    switch (codec) {
        case SessionCodec::ffv1:
            return ImageCodec::ffv1;
        case SessionCodec::fast:
            return ImageCodec::fast;
        case SessionCodec::rvl:
            return layout == PixelLayout::gray16 ? ImageCodec::rvl_zstd : ImageCodec::raw;
        case SessionCodec::raw:
            break;
    }
    return ImageCodec::raw;
}

StreamFormat gray16_format(StreamId id, const Image<std::uint16_t>& image, SessionCodec codec) {
    StreamFormat format;
    format.id = id;
    format.image = {codec_of(codec, PixelLayout::gray16), PixelLayout::gray16, image.width(),
                    image.height()};
    return format;
}

}  // namespace

StreamFormat format_of(int device, const DepthFrame& frame, SessionCodec codec) {
    StreamFormat format = gray16_format({device, StreamKind::depth}, frame.raw, codec);
    format.unit = frame.unit;
    // Has a meaning for linear depth only; one value for all others keeps them on one track.
    if (frame.unit == DepthUnit::linear) format.metres_per_unit = frame.metres_per_unit;
    return format;
}

StreamFormat format_of(int device, const ColorFrame& frame, SessionCodec codec) {
    StreamFormat format;
    format.id = {device, StreamKind::color};
    format.jpeg = frame.format == PixelFormat::mjpeg;
    const PixelLayout layout = layout_of(frame.format);
    format.image = {format.jpeg ? ImageCodec::raw : codec_of(codec, layout), layout, frame.width,
                    frame.height};
    format.pixel_format = frame.format;
    format.matrix = frame.matrix;
    format.range = frame.range;
    return format;
}

StreamFormat format_of(int device, const InfraredFrame& frame, SessionCodec codec) {
    StreamFormat format = gray16_format({device, StreamKind::infrared}, frame.raw, codec);
    format.significant_bits = frame.significant_bits;
    return format;
}

std::string codec_id_of(const StreamFormat& format) {
    if (format.jpeg) return "V_MJPEG";
    switch (format.image.codec) {
        case ImageCodec::raw:
            break;
        case ImageCodec::ffv1:
            return "V_FFV1";
        case ImageCodec::rvl_zstd:
            return "V_KINO/RVL_ZSTD";
        case ImageCodec::fast:
            return "V_KINO/FAST";
    }
    return "V_UNCOMPRESSED";
}

std::string fourcc_of(const StreamFormat& format) {
    switch (format.image.layout) {
        case PixelLayout::gray16:
            return {'Y', '1', 0, 16};  // FFmpeg's and NUT's name of 16-bit grey, little-endian
        case PixelLayout::gray8:
        case PixelLayout::bayer8:
            break;
        case PixelLayout::rgb8:
            return {'R', 'G', 'B', 24};
        case PixelLayout::rgba8:
            return "RGBA";
        case PixelLayout::yuv422:
            return "UYVY";
        case PixelLayout::yuyv422:
            return "YUY2";
    }
    return "Y800";
}

std::string format_to_json(const StreamFormat& format) {
    json object = {{"stream", track_name(format.id.kind)},
                   {"device", format.id.device},
                   {"width", format.image.width},
                   {"height", format.image.height},
                   {"codec", format.jpeg ? "jpeg" : kCodecs.name(format.image.codec)}};
    switch (format.id.kind) {
        case StreamKind::depth:
            object["unit"] = kUnits.name(format.unit);
            if (format.unit == DepthUnit::linear) {
                object["metres_per_unit"] = format.metres_per_unit;
            }
            break;
        case StreamKind::color:
            object["pixels"] = kPixels.name(format.pixel_format);
            object["matrix"] = kMatrices.name(format.matrix);
            object["range"] = kRanges.name(format.range);
            break;
        case StreamKind::infrared:
            object["significant_bits"] = format.significant_bits;
            break;
        case StreamKind::bodies:
        case StreamKind::motion:
            break;
    }
    return object.dump(-1, ' ', true, json::error_handler_t::replace);
}

Result<StreamFormat> format_from_json(std::string_view text, const std::string& where) {
    KINO_ASSIGN(const json value, parse_json(text, where));
    const JsonCursor object(value, where);
    StreamFormat format;
    KINO_ASSIGN(format.id.kind, kKinds.read(object, "stream"));
    const auto integer = [&](const char* key, std::int64_t least, std::int64_t most,
                             int& out) -> Result<void> {
        KINO_ASSIGN(const JsonCursor member, object.member(key));
        KINO_ASSIGN(const std::int64_t number, member.integer(least, most));
        out = static_cast<int>(number);
        return {};
    };
    KINO_TRY(integer("device", 0, 1000, format.id.device));
    KINO_TRY(integer("width", 1, 16384, format.image.width));
    KINO_TRY(integer("height", 1, 16384, format.image.height));
    KINO_ASSIGN(const JsonCursor codec, object.member("codec"));
    KINO_ASSIGN(const std::string codec_name, codec.text());
    format.jpeg = codec_name == "jpeg";
    if (format.jpeg) {
        format.image.codec = ImageCodec::raw;
    } else {
        KINO_ASSIGN(format.image.codec, kCodecs.read(object, "codec"));
    }
    switch (format.id.kind) {
        case StreamKind::depth: {
            KINO_ASSIGN(format.unit, kUnits.read(object, "unit"));
            KINO_TRY(object.read("metres_per_unit", format.metres_per_unit));
            if (!(format.metres_per_unit > 0)) return object.error("metres_per_unit must be > 0");
            break;
        }
        case StreamKind::color: {
            KINO_ASSIGN(format.pixel_format, kPixels.read(object, "pixels"));
            KINO_ASSIGN(format.matrix, kMatrices.read(object, "matrix"));
            KINO_ASSIGN(format.range, kRanges.read(object, "range"));
            format.image.layout = layout_of(format.pixel_format);
            break;
        }
        case StreamKind::infrared:
            KINO_TRY(integer("significant_bits", 1, 16, format.significant_bits));
            break;
        case StreamKind::bodies:
        case StreamKind::motion:
            return object.error("only pictures have a format");
    }
    if (format.jpeg !=
        (format.id.kind == StreamKind::color && format.pixel_format == PixelFormat::mjpeg)) {
        return object.error("codec \"jpeg\" and pixels \"mjpeg\" belong together");
    }
    return format;
}

const char* track_name(StreamKind kind) {
    return kKinds.name(kind);
}

Result<StreamKind> stream_kind_of(std::string_view name, const std::string& where) {
    for (const auto& [kind, text] : kKinds.pairs) {
        if (name == text) return kind;
    }
    return fail(fmt::format("\"{}\" is not a kind of stream", name), where);
}

std::string describe(const StreamFormat& format) {
    const std::string codec = format.jpeg ? "jpeg" : kCodecs.name(format.image.codec);
    switch (format.id.kind) {
        case StreamKind::depth:
            return format.unit == DepthUnit::linear ? fmt::format("16 bit, {:.6g} per metre, {}",
                                                                  1 / format.metres_per_unit, codec)
                                                    : fmt::format("11 bit disparity, {}", codec);
        case StreamKind::color:
            return fmt::format("{}, {}", kPixels.name(format.pixel_format), codec);
        case StreamKind::infrared:
            return fmt::format("{} bit, {}", format.significant_bits, codec);
        case StreamKind::bodies:
        case StreamKind::motion:
            break;
    }
    return "text";
}

int packed_pitch(PixelFormat format, int width) {
    switch (format) {
        case PixelFormat::rgba8:
            return width * 4;
        case PixelFormat::rgb8:
            return width * 3;
        case PixelFormat::uyvy:
        case PixelFormat::yuyv:
            return width * 2;
        case PixelFormat::gray8:
        case PixelFormat::bayer_grbg8:
            return width;
        case PixelFormat::mjpeg:
            break;
    }
    return 0;
}

Result<std::span<const std::uint8_t>> packed_pixels(const ColorFrame& frame,
                                                    std::vector<std::uint8_t>& store) {
    if (frame.format == PixelFormat::mjpeg) return std::span<const std::uint8_t>(frame.bytes);
    const int packed = packed_pitch(frame.format, frame.width);
    if (frame.width < 1 || frame.height < 1 || frame.pitch < packed) {
        return fail(fmt::format("a colour frame of {}x{} with {} bytes a row makes no sense",
                                frame.width, frame.height, frame.pitch));
    }
    const auto row = static_cast<std::size_t>(packed);
    const auto pitch = static_cast<std::size_t>(frame.pitch);
    const auto rows = static_cast<std::size_t>(frame.height);
    if (frame.bytes.size() < (rows - 1) * pitch + row) {
        return fail(fmt::format("a colour frame of {}x{} has only {} bytes", frame.width,
                                frame.height, frame.bytes.size()));
    }
    if (row == pitch) return std::span(frame.bytes).first(rows * row);
    store.resize(rows * row);
    for (std::size_t y = 0; y < rows; ++y) {
        std::memcpy(store.data() + y * row, frame.bytes.data() + y * pitch, row);
    }
    return std::span<const std::uint8_t>(store);
}

}  // namespace kino
