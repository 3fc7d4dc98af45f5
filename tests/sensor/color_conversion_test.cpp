#include "sensor/color_conversion.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <turbojpeg.h>

#include <cmath>
#include <random>

namespace kino {
namespace {

using ::testing::HasSubstr;

ColorFrame frame_of(PixelFormat format, int width, int height, int pitch, unsigned seed) {
    ColorFrame frame;
    frame.format = format;
    frame.width = width;
    frame.height = height;
    frame.pitch = pitch;
    frame.bytes.resize(static_cast<std::size_t>(pitch) * static_cast<std::size_t>(height));
    std::mt19937 random(seed);
    for (std::uint8_t& byte : frame.bytes) byte = static_cast<std::uint8_t>(random());
    return frame;
}

/// The standards' formulas as printed, in double.
void expect_yuv(Rgba8 got, double y, double u, double v, YuvMatrix matrix, YuvRange range) {
    const double kr = matrix == YuvMatrix::bt601 ? 0.299 : 0.2126;
    const double kb = matrix == YuvMatrix::bt601 ? 0.114 : 0.0722;
    const bool full = range == YuvRange::full;
    const double luma = full ? y / 255 : (y - 16) / 219;
    const double cb = (u - 128) / (full ? 255 : 224);
    const double cr = (v - 128) / (full ? 255 : 224);
    const double r = luma + 2 * (1 - kr) * cr;
    const double b = luma + 2 * (1 - kb) * cb;
    const double g = (luma - kr * r - kb * b) / (1 - kr - kb);
    const auto close = [](double value, std::uint8_t byte) {
        EXPECT_NEAR(std::clamp(value, 0.0, 1.0) * 255, byte, 0.51);
    };
    close(r, got.r);
    close(g, got.g);
    close(b, got.b);
    EXPECT_EQ(got.a, 255);
}

TEST(ColorConversion, YuvAgreesWithTheStandardsInEveryMatrixRangeAndOrder) {
    for (const YuvMatrix matrix : {YuvMatrix::bt601, YuvMatrix::bt709}) {
        for (const YuvRange range : {YuvRange::full, YuvRange::limited}) {
            for (const PixelFormat format : {PixelFormat::uyvy, PixelFormat::yuyv}) {
                ColorFrame frame = frame_of(format, 64, 32, 131, 3);
                frame.matrix = matrix;
                frame.range = range;
                Image<Rgba8> out;
                ASSERT_TRUE(to_rgba8(frame, out));
                for (int y = 0; y < 32; ++y) {
                    for (int x = 0; x < 64; ++x) {
                        const std::uint8_t* pair = frame.bytes.data() + 131 * y + x / 2 * 4;
                        const bool uyvy = format == PixelFormat::uyvy;
                        expect_yuv(out.at(x, y), pair[x % 2 * 2 + (uyvy ? 1 : 0)],
                                   pair[uyvy ? 0 : 1], pair[uyvy ? 2 : 3], matrix, range);
                    }
                }
            }
        }
    }
}

TEST(ColorConversion, NamedYuvColours) {
    ColorFrame frame = frame_of(PixelFormat::yuyv, 2, 1, 4, 0);
    frame.range = YuvRange::limited;
    frame.bytes = {235, 128, 16, 128};
    Image<Rgba8> out;
    ASSERT_TRUE(to_rgba8(frame, out));
    EXPECT_EQ(out.at(0, 0), (Rgba8{255, 255, 255, 255}));
    EXPECT_EQ(out.at(1, 0), (Rgba8{0, 0, 0, 255}));
    frame.range = YuvRange::full;
    frame.bytes = {76, 85, 76, 255};  // JFIF's red
    ASSERT_TRUE(to_rgba8(frame, out));
    EXPECT_EQ(out.at(0, 0), (Rgba8{254, 0, 0, 255}));
}

/// What the sensor's mosaic keeps of a colour at (x, y).
double mosaic(double r, double g, double b, int x, int y) {
    if (y % 2 == 0) return x % 2 == 0 ? g : r;
    return x % 2 == 0 ? b : g;
}

TEST(ColorConversion, BayerGivesBackAnEvenColourEverywhere) {
    for (const auto& [width, height] : {std::pair(2, 2), std::pair(5, 3), std::pair(16, 9)}) {
        ColorFrame frame = frame_of(PixelFormat::bayer_grbg8, width, height, width + 3, 1);
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                frame.bytes[static_cast<std::size_t>(y * frame.pitch + x)] =
                    static_cast<std::uint8_t>(mosaic(200, 90, 30, x, y));
            }
        }
        Image<Rgba8> out;
        ASSERT_TRUE(to_rgba8(frame, out));
        for (const Rgba8& pixel : out.pixels()) EXPECT_EQ(pixel, (Rgba8{200, 90, 30, 255}));
    }
}

TEST(ColorConversion, BayerFollowsALinearRampInside) {
    ColorFrame frame = frame_of(PixelFormat::bayer_grbg8, 40, 20, 40, 1);
    const auto ramp = [](int x, int y, double offset) { return 2.0 * x + 3.0 * y + offset; };
    for (int y = 0; y < 20; ++y) {
        for (int x = 0; x < 40; ++x) {
            frame.bytes[static_cast<std::size_t>(y * 40 + x)] = static_cast<std::uint8_t>(
                mosaic(ramp(x, y, 10), ramp(x, y, 40), ramp(x, y, 80), x, y));
        }
    }
    Image<Rgba8> out;
    ASSERT_TRUE(to_rgba8(frame, out));
    for (int y = 1; y < 19; ++y) {
        for (int x = 1; x < 39; ++x) {
            EXPECT_NEAR(out.at(x, y).r, ramp(x, y, 10), 0.51);
            EXPECT_NEAR(out.at(x, y).g, ramp(x, y, 40), 0.51);
            EXPECT_NEAR(out.at(x, y).b, ramp(x, y, 80), 0.51);
        }
    }
}

TEST(ColorConversion, PlainFormatsAreCopiedExactlyFromPaddedRows) {
    Image<Rgba8> out;
    const ColorFrame rgba = frame_of(PixelFormat::rgba8, 5, 4, 23, 2);
    ASSERT_TRUE(to_rgba8(rgba, out));
    const std::uint8_t* p = rgba.bytes.data() + 23 * 3 + 4 * 4;
    EXPECT_EQ(out.at(4, 3), (Rgba8{p[0], p[1], p[2], p[3]}));
    const ColorFrame rgb = frame_of(PixelFormat::rgb8, 5, 4, 17, 2);
    ASSERT_TRUE(to_rgba8(rgb, out));
    p = rgb.bytes.data() + 17 * 3 + 3 * 4;
    EXPECT_EQ(out.at(4, 3), (Rgba8{p[0], p[1], p[2], 255}));
    const ColorFrame gray = frame_of(PixelFormat::gray8, 5, 4, 7, 2);
    ASSERT_TRUE(to_rgba8(gray, out));
    const std::uint8_t g = gray.bytes[7 * 3 + 4];
    EXPECT_EQ(out.at(4, 3), (Rgba8{g, g, g, 255}));
}

ColorFrame jpeg_frame(int width, int height) {
    std::vector<std::uint8_t> rgb;
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            rgb.push_back(static_cast<std::uint8_t>(x * 255 / width));
            rgb.push_back(static_cast<std::uint8_t>(y * 255 / height));
            rgb.push_back(128);
        }
    }
    ColorFrame frame;
    frame.format = PixelFormat::mjpeg;
    frame.width = width;
    frame.height = height;
    void* handle = tjInitCompress();
    unsigned char* data = nullptr;
    unsigned long size = 0;
    EXPECT_EQ(tjCompress2(handle, rgb.data(), width, 0, height, TJPF_RGB, &data, &size, TJSAMP_444,
                          98, 0),
              0);
    frame.bytes.assign(data, data + size);
    tjFree(data);
    tjDestroy(handle);
    return frame;
}

TEST(ColorConversion, MjpegDecodesAndItsDamageIsSeen) {
    const ColorFrame frame = jpeg_frame(64, 48);
    Image<Rgba8> out;
    ASSERT_TRUE(to_rgba8(frame, out));
    for (int y = 0; y < 48; ++y) {
        for (int x = 0; x < 64; ++x) {
            EXPECT_NEAR(out.at(x, y).r, x * 255 / 64, 4);
            EXPECT_NEAR(out.at(x, y).g, y * 255 / 48, 4);
            EXPECT_NEAR(out.at(x, y).b, 128, 4);
        }
    }
    ColorFrame cut = frame;
    cut.bytes.resize(cut.bytes.size() / 2);
    EXPECT_FALSE(to_rgba8(cut, out));
    ColorFrame wrong_size = frame;
    wrong_size.width = 65;
    const auto result = to_rgba8(wrong_size, out);
    ASSERT_FALSE(result);
    EXPECT_THAT(result.error().what, HasSubstr("the JPEG is 64x48, the frame 65x48"));
    ColorFrame empty;
    empty.format = PixelFormat::mjpeg;
    EXPECT_FALSE(to_rgba8(empty, out));
}

TEST(ColorConversion, LayoutsThatDoNotFitAreErrors) {
    Image<Rgba8> out;
    ColorFrame small = frame_of(PixelFormat::rgb8, 8, 8, 24, 1);
    small.bytes.pop_back();
    EXPECT_FALSE(to_rgba8(small, out));
    ColorFrame narrow = frame_of(PixelFormat::rgba8, 8, 8, 31, 1);
    EXPECT_FALSE(to_rgba8(narrow, out));
    EXPECT_FALSE(to_rgba8(frame_of(PixelFormat::uyvy, 7, 8, 32, 1), out));
    EXPECT_FALSE(to_rgba8(frame_of(PixelFormat::bayer_grbg8, 1, 8, 32, 1), out));
    ColorFrame negative = frame_of(PixelFormat::gray8, 8, 8, 8, 1);
    negative.pitch = -8;
    EXPECT_FALSE(to_rgba8(negative, out));
    negative.pitch = 8;
    negative.height = -8;
    EXPECT_FALSE(to_rgba8(negative, out));
    EXPECT_FALSE(to_rgba8(ColorFrame{}, out));
}

}  // namespace
}  // namespace kino
