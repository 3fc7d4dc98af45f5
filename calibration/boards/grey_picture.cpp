#include "calibration/boards/grey_picture.h"

#include <turbojpeg.h>

#include <algorithm>
#include <array>
#include <memory>
#include <utility>
#include <vector>

#include "sensor/color_conversion.h"
#include "sensor/file_bytes.h"
#include "sensor/jpeg.h"
#include "sensor/png_io.h"

namespace kino {
namespace {

constexpr std::size_t kMaxBytes = std::size_t{256} << 20;

// ITU-R BT.601 luma in 16-bit fixed point.
GreyPicture grey_of_rgba(const Image<Rgba8>& picture) {
    GreyPicture out(picture.width(), picture.height());
    std::transform(
        picture.pixels().begin(), picture.pixels().end(), out.pixels().begin(), [](Rgba8 p) {
            return static_cast<std::uint8_t>((19595u * p.r + 38470u * p.g + 7471u * p.b + 32768u) >>
                                             16);
        });
    return out;
}

Result<GreyPicture> read_jpeg(const std::vector<std::uint8_t>& bytes) {
    struct Close {
        void operator()(void* handle) const { tjDestroy(handle); }
    };
    const std::unique_ptr<void, Close> handle(tjInitDecompress());
    int width = 0;
    int height = 0;
    int subsampling = 0;
    int space = 0;
    if (!handle || tjDecompressHeader3(handle.get(), bytes.data(), bytes.size(), &width, &height,
                                       &subsampling, &space) != 0) {
        return fail("not a JPEG picture");
    }
    Image<Rgba8> picture;
    KINO_TRY(decode_jpeg(bytes, width, height, picture));
    return grey_of_rgba(picture);
}

}  // namespace

GreyPicture grey_of(const Image<std::uint16_t>& infrared) {
    std::vector<std::uint32_t> histogram(65536);
    for (const std::uint16_t value : infrared.pixels()) ++histogram[value];
    const std::size_t clip = infrared.size() / 100;
    const auto level = [&](auto begin, auto end) {
        std::size_t seen = 0;
        auto at = begin;
        while (at != end && (seen += *at) <= clip) ++at;
        return at;
    };
    const auto low =
        static_cast<int>(level(histogram.begin(), histogram.end()) - histogram.begin());
    const auto high =
        65535 - static_cast<int>(level(histogram.rbegin(), histogram.rend()) - histogram.rbegin());
    const double scale = 255.0 / std::max(1, high - low);
    GreyPicture out(infrared.width(), infrared.height());
    std::transform(
        infrared.pixels().begin(), infrared.pixels().end(), out.pixels().begin(),
        [&](std::uint16_t value) {
            return static_cast<std::uint8_t>(std::clamp((value - low) * scale + 0.5, 0.0, 255.0));
        });
    return out;
}

Result<GreyPicture> grey_of(const ColorFrame& frame) {
    Image<Rgba8> picture;
    KINO_TRY(to_rgba8(frame, picture));
    return grey_of_rgba(picture);
}

Result<GreyPicture> read_grey(const std::filesystem::path& path) {
    KINO_ASSIGN(const auto bytes, read_file_bytes(path, kMaxBytes));
    if (bytes.size() > 2 && bytes[0] == 0xFF && bytes[1] == 0xD8) {
        auto picture = read_jpeg(bytes);
        if (!picture) return fail(std::move(picture).error(), path.string());
        return picture;
    }
    constexpr std::array<std::uint8_t, 4> kPng = {0x89, 'P', 'N', 'G'};
    if (bytes.size() < 4 || !std::equal(kPng.begin(), kPng.end(), bytes.begin())) {
        return fail("neither a PNG nor a JPEG picture", path.string());
    }
    if (const auto deep = decode_png_gray16(bytes, path.string())) return grey_of(*deep);
    KINO_ASSIGN(const auto picture, decode_png_rgba8(bytes, path.string()));
    return grey_of_rgba(picture);
}

GreyPicture mirrored(const GreyPicture& picture) {
    GreyPicture out = picture;
    for (int y = 0; y < out.height(); ++y) std::reverse(out.row(y), out.row(y) + out.width());
    return out;
}

}  // namespace kino
