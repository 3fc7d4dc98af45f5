#include <fmt/format.h>

#include "codec_pictures.h"
#include "codec_reference.h"
#include "sensor/codec/fast_kernels.h"
#include "sensor/codec/rvl.h"

namespace kino {
namespace {

using test::Bytes;

struct Codec {
    std::unique_ptr<ImageEncoder> encoder;
    std::unique_ptr<ImageDecoder> decoder;
};

Codec make_fast(const ImageFormat& format, bool simd) {
    auto encoder = make_image_encoder(format, {.simd = simd});
    auto decoder = make_image_decoder(format, {}, {.simd = simd});
    EXPECT_TRUE(encoder && decoder);
    return {std::move(*encoder), std::move(*decoder)};
}

/// Pictures of all layouts, odd sizes and contents, and what comes of them: visit(format, pixels).
template <class Visit>
void each_picture(Visit visit) {
    constexpr std::pair<int, int> kSizes[] = {{1, 1},   {3, 2},   {8, 16},  {9, 17},
                                              {31, 47}, {66, 31}, {200, 90}};
    for (const PixelLayout layout : test::kLayouts) {
        for (auto [width, height] : kSizes) {
            const bool yuv = layout == PixelLayout::yuv422 || layout == PixelLayout::yuyv422;
            if (yuv) width += width % 2;
            const ImageFormat format{ImageCodec::fast, layout, width, height};
            for (const test::Content content : test::kContents) {
                SCOPED_TRACE(fmt::format("layout {}, {}x{}, content {}", static_cast<int>(layout),
                                         width, height, static_cast<int>(content)));
                visit(format, test::make_picture(format, content, 3));
            }
        }
    }
    for (const test::RealDepth& frame : test::real_depth()) {
        SCOPED_TRACE(frame.name);
        visit(ImageFormat{ImageCodec::fast, PixelLayout::gray16, frame.image.width(),
                          frame.image.height()},
              test::bytes_of(frame.image));
    }
}

TEST(Fast, BothFormsGiveTheSameBytesAndReadEachOther) {
    if (!__builtin_cpu_supports("avx2")) GTEST_SKIP() << "no AVX2 here";
    each_picture([](const ImageFormat& format, const Bytes& pixels) {
        Codec simd = make_fast(format, true);
        Codec portable = make_fast(format, false);
        const Bytes data = test::encoded(*simd.encoder, pixels);
        ASSERT_TRUE(data == test::encoded(*portable.encoder, pixels));
        Bytes by_simd(pixels.size(), 1);
        Bytes by_portable(pixels.size(), 2);
        ASSERT_TRUE(simd.decoder->decode(data, by_simd));
        ASSERT_TRUE(portable.decoder->decode(data, by_portable));
        EXPECT_TRUE(by_simd == pixels);
        EXPECT_TRUE(by_portable == pixels);
    });
}

TEST(Fast, ADecoderWrittenFromTheDocumentReadsIt) {
    each_picture([](const ImageFormat& format, const Bytes& pixels) {
        const Bytes data = test::encoded(*make_fast(format, true).encoder, pixels);
        const auto back = reference::decode_fast(format, data);
        ASSERT_TRUE(back.has_value());
        EXPECT_TRUE(*back == pixels);
    });
}

TEST(Fast, DisagreesWithTheDocumentOnNoDamagedFrame) {
    test::Random random(5);
    const ImageFormat format{ImageCodec::fast, PixelLayout::gray16, 23, 19};
    Codec simd = make_fast(format, true);
    Codec portable = make_fast(format, false);
    Bytes back(bytes_per_frame(format));
    Bytes other(bytes_per_frame(format));
    int accepted = 0;
    for (int i = 0; i < 4000; ++i) {
        Bytes data = test::encoded(*simd.encoder,
                                   test::make_picture(format, test::Content::scene, 1 + i % 7));
        for (int k = random.integer(1, 3); k > 0; --k) {
            data[static_cast<std::size_t>(random.integer(5, static_cast<int>(data.size()) - 1))] ^=
                static_cast<std::uint8_t>(1 << random.integer(0, 7));
        }
        const std::uint32_t crc = fast::kPortableKernels.crc32c(data.data() + 5, data.size() - 5);
        for (int k = 0; k < 4; ++k) data[1 + k] = static_cast<std::uint8_t>(crc >> 8 * k);
        const auto expected = reference::decode_fast(format, data);
        ASSERT_EQ(simd.decoder->decode(data, back).has_value(), expected.has_value()) << i;
        ASSERT_EQ(portable.decoder->decode(data, other).has_value(), expected.has_value()) << i;
        if (!expected) continue;
        ++accepted;
        ASSERT_TRUE(back == *expected && other == *expected) << i;
    }
    EXPECT_GT(accepted, 0);
    EXPECT_LT(accepted, 2000);
}

TEST(Fast, TheChecksumIsCastagnolis) {
    const Bytes nine = {'1', '2', '3', '4', '5', '6', '7', '8', '9'};
    EXPECT_EQ(fast::kPortableKernels.crc32c(nine.data(), nine.size()), 0xE3069283u);
    if (__builtin_cpu_supports("avx2")) {
        EXPECT_EQ(fast::kAvx2Kernels.crc32c(nine.data(), nine.size()), 0xE3069283u);
    }
}

TEST(Fast, NoiseIsStoredAndCostsFiveBytes) {
    for (const PixelLayout layout : test::kLayouts) {
        const ImageFormat format{ImageCodec::fast, layout, 64, 48};
        const Bytes pixels = test::make_picture(format, test::Content::noise, 1);
        EXPECT_EQ(test::encoded(*make_fast(format, true).encoder, pixels).size(),
                  pixels.size() + 5);
    }
}

TEST(Fast, RealDepthShrinksAtLeastNinefold) {
    std::size_t before = 0;
    std::size_t after = 0;
    for (const test::RealDepth& frame : test::real_depth()) {
        const ImageFormat format{ImageCodec::fast, PixelLayout::gray16, frame.image.width(),
                                 frame.image.height()};
        const Bytes pixels = test::bytes_of(frame.image);
        const std::size_t size = test::encoded(*make_fast(format, true).encoder, pixels).size();
        EXPECT_GT(pixels.size(), 9 * size) << frame.name;
        before += pixels.size();
        after += size;
    }
    EXPECT_GT(before, 14 * after);
}

TEST(Rvl, ADecoderWrittenFromTheDocumentReadsIt) {
    for (const test::Content content : test::kContents) {
        const ImageFormat format{ImageCodec::rvl_zstd, PixelLayout::gray16, 77, 31};
        const Bytes pixels = test::make_picture(format, content, 4);
        Bytes data(rvl_bound_bytes(pixels.size() / 2));
        data.resize(rvl_encode(pixels, data));
        EXPECT_EQ(reference::decode_rvl(data, pixels.size() / 2), pixels);
    }
}

}  // namespace
}  // namespace kino
