#include <fmt/format.h>

#include <algorithm>

#include "codec_pictures.h"

namespace kino {
namespace {

using test::Bytes;

constexpr std::pair<int, int> kSizes[] = {{1, 1},  {2, 1},   {1, 2},    {3, 5},   {8, 8},
                                          {16, 1}, {17, 33}, {34, 1},   {64, 48}, {127, 16},
                                          {1, 70}, {70, 15}, {361, 291}};

struct Pair {
    std::unique_ptr<ImageEncoder> encoder;
    std::unique_ptr<ImageDecoder> decoder;
};

Pair make_pair(const ImageFormat& format, const CodecOptions& options = {}) {
    auto encoder = make_image_encoder(format, options);
    EXPECT_TRUE(encoder) << (encoder ? "" : encoder.error().to_string());
    if (!encoder) return {};
    auto decoder = make_image_decoder(format, (*encoder)->private_data(), options);
    EXPECT_TRUE(decoder) << (decoder ? "" : decoder.error().to_string());
    if (!decoder) return {};
    return {std::move(*encoder), std::move(*decoder)};
}

void expect_round_trip(Pair& codec, const Bytes& pixels, const std::string& what) {
    const Bytes data = test::encoded(*codec.encoder, pixels);
    // Not what was there before, and nothing left of it.
    Bytes back(pixels.size(), 0xA5);
    const auto done = codec.decoder->decode(data, back);
    ASSERT_TRUE(done) << what << ": " << done.error().to_string();
    ASSERT_TRUE(back == pixels) << what;
}

class RoundTrip : public testing::TestWithParam<ImageCodec> {};

TEST_P(RoundTrip, GivesEveryPictureOfEverySizeBack) {
    for (const PixelLayout layout : test::kLayouts) {
        if (!test::has_layout(GetParam(), layout)) continue;
        for (auto [width, height] : kSizes) {
            if (layout == PixelLayout::yuv422 || layout == PixelLayout::yuyv422) {
                width += width % 2;
            }
            if (GetParam() == ImageCodec::ffv1 && (width < 2 || height < 2)) continue;
            const ImageFormat format{GetParam(), layout, width, height};
            Pair codec = make_pair(format);
            ASSERT_TRUE(codec.decoder);
            for (const test::Content content : test::kContents) {
                expect_round_trip(
                    codec, test::make_picture(format, content, 7),
                    fmt::format("layout {}, {}x{}, content {}", static_cast<int>(layout), width,
                                height, static_cast<int>(content)));
            }
        }
    }
}

TEST_P(RoundTrip, GivesNoiseBackAtEveryDensityOfHoles) {
    for (const int to : {3, 300, 2047, 65535}) {
        const ImageFormat format{GetParam(), PixelLayout::gray16, 93, 41};
        Pair codec = make_pair(format);
        ASSERT_TRUE(codec.decoder);
        for (int tenths = 0; tenths <= 10; ++tenths) {
            const auto image = test::random_raw_depth(93, 41, 11 + tenths, 1, to, tenths / 10.0);
            expect_round_trip(codec, test::bytes_of(image), fmt::format("{} tenths", tenths));
        }
    }
}

TEST_P(RoundTrip, GivesTheRealRecordingsBack) {
    std::unique_ptr<ImageEncoder> encoder;
    const auto frames = test::real_depth();
    ASSERT_GE(frames.size(), 20u);
    Pair codec;
    ImageFormat last;
    for (const test::RealDepth& frame : frames) {
        const ImageFormat format{GetParam(), PixelLayout::gray16, frame.image.width(),
                                 frame.image.height()};
        if (!codec.encoder || !(format == last)) codec = make_pair(format);
        last = format;
        ASSERT_TRUE(codec.decoder);
        expect_round_trip(codec, test::bytes_of(frame.image), frame.name);
    }
}

TEST_P(RoundTrip, OneFrameDoesNotDependOnAnother) {
    const ImageFormat format{GetParam(), PixelLayout::gray16, 60, 50};
    Pair codec = make_pair(format);
    ASSERT_TRUE(codec.decoder);
    const Bytes first = test::make_picture(format, test::Content::scene, 1);
    const Bytes data = test::encoded(*codec.encoder, first);
    (void)test::encoded(*codec.encoder, test::make_picture(format, test::Content::noise, 2));
    EXPECT_EQ(test::encoded(*codec.encoder, first), data);
    Pair other = make_pair(format);
    ASSERT_TRUE(other.decoder);
    Bytes back(first.size());
    ASSERT_TRUE(other.decoder->decode(data, back));
    EXPECT_EQ(back, first);
}

TEST_P(RoundTrip, AFrameAfterADamagedOneIsWhole) {
    const ImageFormat format{GetParam(), PixelLayout::gray16, 60, 50};
    Pair codec = make_pair(format);
    ASSERT_TRUE(codec.decoder);
    const Bytes pixels = test::make_picture(format, test::Content::scene, 1);
    const Bytes data = test::encoded(*codec.encoder, pixels);
    Bytes back(pixels.size());
    EXPECT_FALSE(codec.decoder->decode(std::span(data).first(data.size() - 1), back));
    EXPECT_FALSE(codec.decoder->decode({}, back));
    Bytes longer = data;
    longer.push_back(0);
    EXPECT_FALSE(codec.decoder->decode(longer, back));
    ASSERT_TRUE(codec.decoder->decode(data, back));
    EXPECT_EQ(back, pixels);
}

class Checked : public RoundTrip {};

TEST_P(Checked, AWrongBitNeverMakesAnotherPicture) {
    const ImageFormat format{GetParam(), PixelLayout::gray16, 40, 30};
    Pair codec = make_pair(format);
    ASSERT_TRUE(codec.decoder);
    const Bytes pixels = test::make_picture(format, test::Content::scene, 3);
    const Bytes data = test::encoded(*codec.encoder, pixels);
    Bytes back(pixels.size());
    for (std::size_t i = 0; i < data.size(); ++i) {
        for (const int bit : {0, 3, 7}) {
            Bytes wrong = data;
            wrong[i] = static_cast<std::uint8_t>(wrong[i] ^ 1 << bit);
            const auto done = codec.decoder->decode(wrong, back);
            EXPECT_TRUE(!done || back == pixels) << "byte " << i << " bit " << bit;
        }
    }
}

std::string name_of(const testing::TestParamInfo<ImageCodec>& param) {
    std::string name = codec_name(param.param);
    std::replace(name.begin(), name.end(), '+', '_');
    return name;
}

INSTANTIATE_TEST_SUITE_P(Codecs, RoundTrip, testing::ValuesIn(test::kCodecs), name_of);
// Raw pixels carry no checksum.
INSTANTIATE_TEST_SUITE_P(Codecs, Checked,
                         testing::Values(ImageCodec::ffv1, ImageCodec::rvl_zstd, ImageCodec::fast),
                         name_of);

TEST(ImageFormat, WhatNoCodecHasIsRefused) {
    const auto refused = [](ImageFormat format) {
        return !make_image_encoder(format) && !make_image_decoder(format, {});
    };
    for (const ImageCodec codec : test::kCodecs) {
        EXPECT_TRUE(refused({codec, PixelLayout::gray16, 0, 4}));
        EXPECT_TRUE(refused({codec, PixelLayout::gray16, 4, -1}));
        EXPECT_TRUE(refused({codec, PixelLayout::gray16, 16385, 4}));
        EXPECT_TRUE(refused({codec, PixelLayout::yuv422, 3, 4}));
    }
    EXPECT_TRUE(refused({ImageCodec::rvl_zstd, PixelLayout::gray8, 4, 4}));
    EXPECT_TRUE(refused({ImageCodec::ffv1, PixelLayout::gray16, 30, 1}));
    EXPECT_TRUE(refused({ImageCodec::ffv1, PixelLayout::gray16, 3, 300}));
    const Bytes extra(3);
    EXPECT_FALSE(make_image_decoder({ImageCodec::raw, PixelLayout::gray8, 4, 4}, extra));
    EXPECT_FALSE(make_image_decoder({ImageCodec::ffv1, PixelLayout::gray8, 4, 4}, extra));
}

}  // namespace
}  // namespace kino
