#include "sensor/png_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "sensor/file_bytes.h"
#include "test_folder.h"

namespace kino {
namespace {

using test::TestFolder;
using ::testing::HasSubstr;

Image<std::uint16_t> random_depth(int width, int height, unsigned seed) {
    std::mt19937 random(seed);
    Image<std::uint16_t> image(width, height);
    for (std::uint16_t& pixel : image.pixels()) pixel = static_cast<std::uint16_t>(random());
    return image;
}

Image<Rgba8> random_picture(int width, int height, unsigned seed) {
    std::mt19937 random(seed);
    Image<Rgba8> image(width, height);
    for (Rgba8& p : image.pixels()) {
        const auto bits = random();
        p = {static_cast<std::uint8_t>(bits), static_cast<std::uint8_t>(bits >> 8),
             static_cast<std::uint8_t>(bits >> 16), static_cast<std::uint8_t>(bits >> 24)};
    }
    return image;
}

TEST(PngIo, Gray16RoundTripIsExact) {
    const TestFolder folder;
    for (const auto& [width, height] : {std::pair(1, 1), std::pair(3, 7), std::pair(640, 5)}) {
        for (const int level : {0, 1, 6}) {
            const auto image = random_depth(width, height, 7);
            const auto path = folder.path() / "tiefe.png";
            ASSERT_TRUE(write_png_gray16(path, image, {level}));
            const auto back = read_png_gray16(path);
            ASSERT_TRUE(back) << back.error().to_string();
            EXPECT_EQ(*back, image);
        }
    }
}

TEST(PngIo, Rgba8RoundTripIsExactAlsoFromPaddedRows) {
    const TestFolder folder;
    const auto image = random_picture(9, 6, 3);
    const auto path = folder.path() / "bild.png";
    const ImageView<const Rgba8> part{image.data() + 1, 5, 6, 9};
    ASSERT_TRUE(write_png_rgba8(path, part));
    const auto back = read_png_rgba8(path);
    ASSERT_TRUE(back) << back.error().to_string();
    for (int y = 0; y < 6; ++y) {
        for (int x = 0; x < 5; ++x) EXPECT_EQ(back->at(x, y), image.at(x + 1, y));
    }
}

TEST(PngIo, EncodingToMemoryDecodesBack) {
    const auto image = random_picture(31, 17, 5);
    const auto bytes = encode_png_rgba8(image.view());
    ASSERT_TRUE(bytes);
    const auto back = decode_png_rgba8(*bytes, "memory");
    ASSERT_TRUE(back);
    EXPECT_EQ(*back, image);
}

TEST(PngIo, MissingFileSaysSo) {
    const auto result = read_png_gray16("no/such/file.png");
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().what, "no such file");
    EXPECT_EQ(result.error().where, "no/such/file.png");
}

TEST(PngIo, ATruncatedFileIsAnErrorOrLosesNoPixel) {
    const TestFolder folder;
    const auto path = folder.path() / "a.png";
    const auto image = random_depth(20, 20, 1);
    ASSERT_TRUE(write_png_gray16(path, image));
    const auto bytes = read_file_bytes(path, 1 << 20);
    ASSERT_TRUE(bytes);
    for (std::size_t size = 0; size < bytes->size(); ++size) {
        const auto cut = decode_png_gray16(std::span(*bytes).first(size), "cut");
        if (cut) {
            EXPECT_EQ(*cut, image) << size;
            // Behind the pixels: the stream's checksum, the chunk's, and the 12 bytes of IEND.
            EXPECT_GT(size + 24, bytes->size());
        } else {
            EXPECT_EQ(cut.error().where, "cut");
        }
    }
}

TEST(PngIo, TruncatedFileNamesTheReason) {
    const TestFolder folder;
    const auto path = folder.path() / "a.png";
    ASSERT_TRUE(write_png_gray16(path, random_depth(64, 64, 1)));
    auto bytes = *read_file_bytes(path, 1 << 20);
    ASSERT_TRUE(write_file_bytes(path, bytes.data(), bytes.size() / 2));
    const auto result = read_png_gray16(path);
    ASSERT_FALSE(result);
    EXPECT_THAT(result.error().what, HasSubstr("cut off"));
}

TEST(PngIo, DepthAndPicturesAreNotMixedUp) {
    const TestFolder folder;
    const auto depth = folder.write_depth("d.png", 4, 4, 9);
    const auto color = folder.write_color("c.png", 4, 4, {1, 2, 3, 4});
    const auto as_picture = read_png_rgba8(depth);
    ASSERT_FALSE(as_picture);
    EXPECT_THAT(as_picture.error().what, HasSubstr("16 bit grey"));
    const auto as_depth = read_png_gray16(color);
    ASSERT_FALSE(as_depth);
    EXPECT_THAT(as_depth.error().what, HasSubstr("8 bit RGBA"));
}

std::vector<std::uint8_t> header_only(std::uint32_t width, std::uint32_t height) {
    std::vector<std::uint8_t> bytes = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n',
                                       0,    0,   0,   13,  'I',  'H',  'D',  'R'};
    for (const std::uint32_t v : {width, height}) {
        for (int shift = 24; shift >= 0; shift -= 8) {
            bytes.push_back(static_cast<std::uint8_t>(v >> shift));
        }
    }
    bytes.insert(bytes.end(), {16, 0, 0, 0, 0});
    std::uint32_t crc = 0xFFFFFFFF;
    for (std::size_t i = 12; i < bytes.size(); ++i) {
        crc ^= bytes[i];
        for (int k = 0; k < 8; ++k) crc = (crc >> 1) ^ ((crc & 1) != 0 ? 0xEDB88320u : 0u);
    }
    crc = ~crc;
    for (int shift = 24; shift >= 0; shift -= 8) {
        bytes.push_back(static_cast<std::uint8_t>(crc >> shift));
    }
    return bytes;
}

TEST(PngIo, AbsurdSizesAreRefusedBeforeAnyAllocation) {
    const auto huge = decode_png_gray16(header_only(20000, 4), "huge");
    ASSERT_FALSE(huge);
    EXPECT_THAT(huge.error().what, HasSubstr("larger than 16384x16384"));
    const auto hollow = decode_png_gray16(header_only(16384, 16384), "hollow");
    ASSERT_FALSE(hollow);
    EXPECT_THAT(hollow.error().what, HasSubstr("cut off"));
}

TEST(PngIo, SizeIsReadFromTheHeader) {
    const TestFolder folder;
    const auto size = read_png_size(folder.write_depth("d.png", 12, 34, 0));
    ASSERT_TRUE(size);
    EXPECT_EQ(size->width, 12);
    EXPECT_EQ(size->height, 34);
}

TEST(PngIo, UnwritablePathIsAnError) {
    const Image<Rgba8> image(2, 2);
    EXPECT_FALSE(write_png_rgba8("no/such/folder/a.png", image.view()));
    EXPECT_FALSE(encode_png_rgba8(ImageView<const Rgba8>{}));
}

}  // namespace
}  // namespace kino
