#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "sensor/codec/image_codec.h"
#include "sensor/png_io.h"
#include "tests/support/random.h"

namespace kino::test {

using Bytes = std::vector<std::uint8_t>;

constexpr PixelLayout kLayouts[] = {PixelLayout::gray16, PixelLayout::gray8, PixelLayout::bayer8,
                                    PixelLayout::rgb8,   PixelLayout::rgba8, PixelLayout::yuv422,
                                    PixelLayout::yuyv422};
constexpr ImageCodec kCodecs[] = {ImageCodec::raw, ImageCodec::ffv1, ImageCodec::rvl_zstd,
                                  ImageCodec::fast};

inline bool has_layout(ImageCodec codec, PixelLayout layout) {
    return codec != ImageCodec::rvl_zstd || layout == PixelLayout::gray16;
}

inline Bytes bytes_of(const std::vector<std::uint16_t>& values) {
    Bytes out;
    for (const std::uint16_t value : values) {
        out.push_back(static_cast<std::uint8_t>(value));
        out.push_back(static_cast<std::uint8_t>(value >> 8));
    }
    return out;
}

inline Bytes bytes_of(const Image<std::uint16_t>& image) {
    return bytes_of(std::vector<std::uint16_t>(image.pixels().begin(), image.pixels().end()));
}

enum class Content { constant, ramp, noise, extremes, scene, holes, steps, disparity };
constexpr Content kContents[] = {Content::constant, Content::ramp,     Content::noise,
                                 Content::extremes, Content::scene,    Content::holes,
                                 Content::steps,    Content::disparity};

/// Bytes of one frame. `scene`: planes with edges, noise and holes, as depth has them.
inline Bytes make_picture(const ImageFormat& format, Content content, std::uint64_t seed) {
    Random random(seed);
    Bytes out(bytes_per_frame(format));
    const bool wide = format.layout == PixelLayout::gray16;
    const std::size_t count = wide ? out.size() / 2 : out.size();
    const std::size_t row = count / static_cast<std::size_t>(format.height);
    const int top = wide ? 65535 : 255;
    for (std::size_t i = 0; i < count; ++i) {
        const int x = static_cast<int>(i % row);
        const int y = static_cast<int>(i / row);
        int value = 0;
        switch (content) {
            case Content::constant:
                value = top / 3;
                break;
            case Content::ramp:
                value = x * 3 + y * 5;
                break;
            case Content::noise:
                value = random.integer(0, top);
                break;
            case Content::extremes:
                value = random.chance(0.5) ? top : 0;
                break;
            case Content::scene:
                value = (x / 17 + y / 23) % 3 * 40 + x / 5 + y / 7 + random.integer(0, 2);
                if (random.chance(0.03) || (x / 9 + y / 11) % 7 == 0) value = 0;
                break;
            case Content::holes:
                value = random.chance(0.93) ? 0 : random.integer(1, top);
                break;
            case Content::disparity:
                value = random.chance(0.1) || x % 13 == 0 ? 2047 : 600 + x / 3 + y / 5;
                break;
            case Content::steps:
                value = (x / 3 + y / 2) % 5 * 4099;
                break;
        }
        value &= top;
        if (wide) {
            out[2 * i] = static_cast<std::uint8_t>(value);
            out[2 * i + 1] = static_cast<std::uint8_t>(value >> 8);
        } else {
            out[i] = static_cast<std::uint8_t>(value);
        }
    }
    return out;
}

inline Bytes encoded(ImageEncoder& encoder, const Bytes& pixels) {
    const auto data = encoder.encode(pixels);
    EXPECT_TRUE(data) << (data ? "" : data.error().to_string());
    return data ? Bytes(data->begin(), data->end()) : Bytes();
}

inline Bytes private_of(const ImageEncoder& encoder) {
    return {encoder.private_data().begin(), encoder.private_data().end()};
}

struct RealDepth {
    std::string name;
    Image<std::uint16_t> image;
};

/// Every 16-bit depth image in the repository.
inline std::vector<RealDepth> real_depth() {
    std::vector<RealDepth> out;
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::recursive_directory_iterator("recordings")) {
        if (entry.path().extension() == ".png" && entry.path().parent_path().filename() == "depth")
            files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
    for (const auto& file : files) {
        auto image = read_png_gray16(file);
        EXPECT_TRUE(image) << file;
        if (image) out.push_back({file.string(), std::move(*image)});
    }
    return out;
}

}  // namespace kino::test
