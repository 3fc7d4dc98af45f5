#include "viz/quality/image_metrics.h"

#include <gmock/gmock.h>

#include <cmath>

#include "tests/support/random.h"

namespace kino {
namespace {

using test::random_rgba8;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr Rgba8 kBlack{0, 0, 0, 255};

ImageDifference difference(const Image<Rgba8>& a, const Image<Rgba8>& b,
                           const CompareOptions& options = {}) {
    const auto result = compare_images(a, b, options);
    EXPECT_TRUE(result) << result.error().to_string();
    return result.value_or(ImageDifference{});
}

TEST(ImageMetrics, EqualPicturesHaveNoDifference) {
    const auto image = random_rgba8(33, 17, 1);
    const auto result = difference(image, image);
    EXPECT_TRUE(result.equal());
    EXPECT_EQ(result.failing_pixels, 0);
    EXPECT_EQ(result.rmse, 0);
    EXPECT_TRUE(std::isinf(result.psnr_db) && result.psnr_db > 0);
}

TEST(ImageMetrics, OnePixelOneStepIsFoundInEveryChannelAndPlace) {
    const auto image = random_rgba8(9, 7, 2);
    for (std::size_t i = 0; i < image.size(); ++i) {
        for (int channel = 0; channel < 4; ++channel) {
            auto changed = image;
            auto* const bytes = &changed.pixels()[i].r;
            bytes[channel] = static_cast<std::uint8_t>(bytes[channel] ^ 1u);
            const auto result = difference(image, changed);
            EXPECT_EQ(result.failing_pixels, 1);
            EXPECT_EQ(result.max_abs[static_cast<std::size_t>(channel)], 1);
            EXPECT_EQ(result.max_abs_any(), 1);
            EXPECT_DOUBLE_EQ(result.failing_fraction, 1.0 / 63);
        }
    }
}

TEST(ImageMetrics, ClosedFormOfAConstantDifference) {
    // All of r, g, b off by d: RMSE is d; PSNR of d = 1 is the known 48.13 dB.
    for (const int d : {1, 2, 16, 255}) {
        const auto byte = static_cast<std::uint8_t>(d);
        const auto result =
            difference(Image<Rgba8>(40, 30, kBlack), Image<Rgba8>(40, 30, {byte, byte, byte, 255}));
        EXPECT_DOUBLE_EQ(result.rmse, d);
        EXPECT_DOUBLE_EQ(result.psnr_db, 20 * std::log10(255.0 / d));
        EXPECT_EQ(result.failing_fraction, 1);
    }
    EXPECT_NEAR(20 * std::log10(255.0), 48.1308, 1e-4);
    const auto white = difference(Image<Rgba8>(2, 2, kBlack), Image<Rgba8>(2, 2, {255, 255, 255}));
    EXPECT_EQ(white.psnr_db, 0);
}

TEST(ImageMetrics, ClosedFormOfOneChannelInOnePixel) {
    Image<Rgba8> a(4, 4, kBlack);
    Image<Rgba8> b = a;
    b.at(3, 0).g = 60;
    const auto result = difference(a, b);
    EXPECT_THAT(result.max_abs, ElementsAre(0, 60, 0, 0));
    EXPECT_DOUBLE_EQ(result.rmse, std::sqrt(60.0 * 60.0 / (3 * 16)));
}

TEST(ImageMetrics, AlphaFailsPixelsButIsNoColourError) {
    Image<Rgba8> a(4, 4, kBlack);
    Image<Rgba8> b = a;
    b.at(1, 1).a = 0;
    const auto result = difference(a, b);
    EXPECT_EQ(result.failing_pixels, 1);
    EXPECT_EQ(result.rmse, 0);
    EXPECT_FALSE(result.equal());
}

TEST(ImageMetrics, SymmetricInItsOperands) {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        const auto a = random_rgba8(13, 11, 2 * seed);
        const auto b = random_rgba8(13, 11, 2 * seed + 1);
        for (const int radius : {0, 1, 2}) {
            const CompareOptions options{.tolerance = 90, .shift_radius = radius};
            const auto ab = difference(a, b, options);
            const auto ba = difference(b, a, options);
            EXPECT_EQ(ab.failing_pixels, ba.failing_pixels) << "seed " << seed;
            EXPECT_EQ(ab.max_abs, ba.max_abs);
            EXPECT_EQ(ab.rmse, ba.rmse);
        }
    }
}

TEST(ImageMetrics, NeverNaN) {
    for (const auto& other : {Image<Rgba8>(1, 1, kBlack), Image<Rgba8>(1, 1, {1, 0, 0, 0})}) {
        const auto result = difference(Image<Rgba8>(1, 1, kBlack), other);
        EXPECT_FALSE(std::isnan(result.rmse) || std::isnan(result.psnr_db) ||
                     std::isnan(result.failing_fraction));
    }
}

TEST(ImageMetrics, ToleranceIsInclusive) {
    const Image<Rgba8> a(3, 3, kBlack);
    const Image<Rgba8> b(3, 3, {5, 0, 0, 255});
    EXPECT_EQ(difference(a, b, {.tolerance = 5}).failing_pixels, 0);
    EXPECT_EQ(difference(a, b, {.tolerance = 4}).failing_pixels, 9);
}

TEST(ImageMetrics, MoreToleranceOrShiftNeverFailsMore) {
    const auto a = random_rgba8(21, 19, 5);
    const auto b = random_rgba8(21, 19, 6);
    std::int64_t before = 21 * 19;
    for (int tolerance = 0; tolerance <= 255; tolerance += 15) {
        const auto still = difference(a, b, {.tolerance = tolerance}).failing_pixels;
        const auto shifted =
            difference(a, b, {.tolerance = tolerance, .shift_radius = 1}).failing_pixels;
        EXPECT_LE(still, before);
        EXPECT_LE(shifted, still);
        before = still;
    }
    EXPECT_EQ(before, 0);
}

TEST(ImageMetrics, ShiftOfOnePixelIsForgivenOnlyWithRadius) {
    Image<Rgba8> a(16, 16, kBlack);
    Image<Rgba8> b = a;
    for (int y = 0; y < 16; ++y) {
        a.at(7, y) = {200, 100, 0, 255};
        b.at(8, y) = {200, 100, 0, 255};
    }
    EXPECT_EQ(difference(a, b).failing_pixels, 32);
    EXPECT_EQ(difference(a, b, {.shift_radius = 1}).failing_pixels, 0);
}

TEST(ImageMetrics, ASpeckInOnlyOnePictureIsNotForgiven) {
    const Image<Rgba8> plain(16, 16, kBlack);
    Image<Rgba8> speck = plain;
    speck.at(8, 8) = {200, 100, 0, 255};
    EXPECT_EQ(difference(plain, speck, {.shift_radius = 1}).failing_pixels, 1);
    EXPECT_EQ(difference(speck, plain, {.shift_radius = 1}).failing_pixels, 1);
}

TEST(ImageMetrics, DifferentSizesAndEmptyPicturesAreErrors) {
    const auto sizes = compare_images(Image<Rgba8>(3, 4), Image<Rgba8>(4, 3));
    ASSERT_FALSE(sizes);
    EXPECT_THAT(sizes.error().what, HasSubstr("3x4 and 4x3"));
    EXPECT_FALSE(compare_images({}, {}));
}

TEST(GoldenGate, ExactPasses) {
    const auto image = random_rgba8(50, 40, 9);
    const auto verdict = judge_golden(image, image);
    ASSERT_TRUE(verdict);
    EXPECT_TRUE(verdict->passes && verdict->exact);
}

TEST(GoldenGate, LimitIsAThousandthOfThePixels) {
    const Image<Rgba8> golden(100, 40, {100, 100, 100, 255});
    auto actual = golden;
    const auto judge = [&] { return judge_golden(actual, golden)->passes; };
    for (const int x : {0, 20, 40, 60}) actual.at(x, 5).r = 103;
    EXPECT_TRUE(judge());  // 4 of 4000
    actual.at(80, 5).r = 102;
    EXPECT_TRUE(judge());  // within 2/255 does not count
    actual.at(80, 5).r = 103;
    EXPECT_FALSE(judge());
}

TEST(GoldenGate, TwoStepsEverywherePassThreeDoNot) {
    const Image<Rgba8> golden(20, 20, {100, 100, 100, 255});
    const auto two = judge_golden(Image<Rgba8>(20, 20, {102, 98, 100, 255}), golden);
    EXPECT_TRUE(two->passes);
    EXPECT_FALSE(two->exact);
    EXPECT_FALSE(judge_golden(Image<Rgba8>(20, 20, {103, 100, 100, 255}), golden)->passes);
}

TEST(DifferencePicture, MarksExactlyTheDifferentPixels) {
    const auto a = random_rgba8(12, 10, 3);
    auto b = a;
    b.at(4, 7).b = static_cast<std::uint8_t>(b.at(4, 7).b ^ 1u);
    const auto picture = difference_picture(a, b);
    for (int y = 0; y < 10; ++y) {
        for (int x = 0; x < 12; ++x) {
            const Rgba8 pixel = picture.at(x, y);
            const bool grey = pixel.r == pixel.g && pixel.g == pixel.b;
            EXPECT_EQ(grey, !(x == 4 && y == 7)) << x << ", " << y;
        }
    }
}

TEST(DifferencePicture, LargestDifferenceIsYellowSmallestIsBlue) {
    const auto at = [](int d) {
        return difference_picture(Image<Rgba8>(1, 1, kBlack),
                                  Image<Rgba8>(1, 1, {static_cast<std::uint8_t>(d), 0, 0, 255}))
            .at(0, 0);
    };
    EXPECT_EQ(at(255), (Rgba8{255, 255, 0, 255}));
    EXPECT_EQ(at(16), (Rgba8{255, 0, 0, 255}));
    EXPECT_GT(at(1).b, 200);
}

TEST(DifferencePicture, OfDifferentSizesShowsWhatOnlyOneHas) {
    const auto picture = difference_picture(Image<Rgba8>(3, 1, kBlack), Image<Rgba8>(1, 2, kBlack));
    EXPECT_EQ(picture.width(), 3);
    EXPECT_EQ(picture.height(), 2);
    EXPECT_EQ(picture.at(2, 0), (Rgba8{255, 0, 255, 255}));
    EXPECT_EQ(picture.at(0, 0), (Rgba8{0, 0, 0, 255}));
}

}  // namespace
}  // namespace kino
