#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/random.h"
#include "viz/quality/edge_band.h"
#include "viz/quality/flip.h"
#include "viz/quality/ssim.h"

namespace kino {
namespace {

using test::random_picture;
using test::random_rgba8;

Image<Rgba8> plain(Rgba8 color, int width = 40, int height = 30) {
    return {width, height, color};
}

double flip(const Image<Rgba8>& a, const Image<Rgba8>& b) {
    const auto result = flip_error(a, b);
    EXPECT_TRUE(result);
    return result ? result->mean : -1;
}

TEST(Flip, EqualPicturesShowNothing) {
    const auto image = random_rgba8(37, 23, 1);
    const auto result = flip_error(image, image);
    ASSERT_TRUE(result);
    EXPECT_EQ(result->mean, 0);
    EXPECT_EQ(flip_picture(*result).at(5, 5), (Rgba8{0, 0, 0, 255}));
}

// Plain pictures have no features and filters change nothing, so only HyAB distance and its
// remapping are left: computed here from the CIELAB values of sRGB's corners as tables print them.
TEST(Flip, PlainPicturesFollowTheClosedForm) {
    struct Lab {
        double l, a, b;
    };
    const auto hunt = [](Lab c) { return Lab{c.l, c.a * c.l / 100, c.b * c.l / 100}; };
    const auto hyab = [&](Lab p, Lab q) {
        p = hunt(p);
        q = hunt(q);
        return std::abs(p.l - q.l) + std::hypot(p.a - q.a, p.b - q.b);
    };
    const Lab green{87.735, -86.183, 83.180};
    const Lab blue{32.300, 79.195, -107.854};
    const Lab red{53.239, 80.092, 67.203};
    const Lab white{100, 0, 0};
    const Lab black{0, 0, 0};
    const double most = std::pow(hyab(green, blue), 0.7);
    const auto expected = [&](Lab p, Lab q) {
        const double e = std::pow(hyab(p, q), 0.7);
        return e < 0.4 * most ? 0.95 * e / (0.4 * most)
                              : 0.95 + 0.05 * (e - 0.4 * most) / (0.6 * most);
    };
    constexpr Rgba8 kGreen{0, 255, 0, 255};
    constexpr Rgba8 kBlue{0, 0, 255, 255};
    constexpr Rgba8 kRed{255, 0, 0, 255};
    constexpr Rgba8 kBright{255, 255, 255, 255};
    constexpr Rgba8 kDark{0, 0, 0, 255};
    EXPECT_NEAR(flip(plain(kGreen), plain(kBlue)), 1.0, 1e-9);
    EXPECT_NEAR(flip(plain(kDark), plain(kBright)), expected(black, white), 2e-4);
    EXPECT_NEAR(flip(plain(kDark), plain(kBright)), 0.967, 1e-3);
    EXPECT_NEAR(flip(plain(kRed), plain(kGreen)), expected(red, green), 2e-4);
    EXPECT_NEAR(flip(plain(kRed), plain(kDark)), expected(red, black), 2e-4);
    EXPECT_NEAR(flip(plain(kBlue), plain(kDark)), expected(blue, black), 2e-4);
    // A grey step below the knee: L* of sRGB 119 is 50.03, of 143 is 59.43.
    EXPECT_NEAR(flip(plain({119, 119, 119}), plain({143, 143, 143})),
                expected({50.034, 0, 0}, {59.431, 0, 0}), 2e-3);
}

TEST(Flip, SymmetricAndWithinItsRange) {
    for (std::uint64_t seed = 0; seed < 6; ++seed) {
        const auto a = random_rgba8(29, 31, 2 * seed);
        const auto b = random_picture(29, 31, 2 * seed + 1);
        const auto ab = flip_error(a, b);
        const auto ba = flip_error(b, a);
        ASSERT_TRUE(ab && ba);
        EXPECT_EQ(ab->map, ba->map);
        double sum = 0;
        for (const float e : ab->map.pixels()) {
            EXPECT_TRUE(e >= 0 && e <= 1);
            sum += e;
        }
        EXPECT_NEAR(ab->mean, sum / static_cast<double>(ab->map.size()), 1e-6);
    }
}

TEST(Flip, LargerStepsAreSeenMore) {
    double before = 0;
    for (int step = 4; step <= 124; step += 20) {
        const auto level = static_cast<std::uint8_t>(100 + step);
        const double now = flip(plain({100, 100, 100}), plain({level, level, level}));
        EXPECT_GT(now, before);
        before = now;
    }
}

/// Pixels of an image as a function of place.
template <class Value>
Image<Rgba8> drawn(int width, int height, Value value) {
    Image<Rgba8> image(width, height);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const auto v = static_cast<std::uint8_t>(value(x, y));
            image.at(x, y) = {v, v, v, 255};
        }
    }
    return image;
}

// What the filters are for: a pattern too fine to be seen matters less than a coarse one of the
// same pixels, and an edge that comes or goes more than its colours alone.
TEST(Flip, FineNoiseHidesAndEdgesShow) {
    const auto grey = plain({128, 128, 128}, 64, 64);
    const auto fine = drawn(64, 64, [](int x, int y) { return (x + y) % 2 == 0 ? 108 : 148; });
    const auto coarse =
        drawn(64, 64, [](int x, int y) { return (x / 16 + y / 16) % 2 == 0 ? 108 : 148; });
    EXPECT_LT(flip(grey, fine), 0.5 * flip(grey, coarse));

    const auto step = drawn(64, 64, [](int x, int) { return x < 32 ? 108 : 148; });
    const auto result = flip_error(plain({108, 108, 108}, 64, 64), step);
    ASSERT_TRUE(result);
    EXPECT_GT(result->map.at(35, 32), 1.1 * result->map.at(60, 32));
}

TEST(Flip, BordersCountAsTheRest) {
    // A plain difference has the same error at every pixel.
    const auto result = flip_error(plain({90, 20, 10}, 25, 9), plain({10, 120, 60}, 25, 9));
    ASSERT_TRUE(result);
    for (const float e : result->map.pixels()) EXPECT_NEAR(e, result->map.at(12, 4), 1e-6);
}

TEST(Flip, OnePixelPicturesAndErrors) {
    const double e = flip(plain({0, 0, 0}, 1, 1), plain({255, 255, 255}, 1, 1));
    EXPECT_NEAR(e, 0.967, 1e-3);
    EXPECT_FALSE(flip_error(plain({}, 3, 4), plain({}, 4, 3)));
    EXPECT_FALSE(flip_error({}, {}));
}

TEST(Ssim, EqualIsOneAndOppositeIsNot) {
    const auto image = random_picture(40, 33, 3);
    EXPECT_DOUBLE_EQ(ssim(image, image).value(), 1);
    Image<Rgba8> negative = image;
    for (Rgba8& p : negative.pixels()) {
        p = {static_cast<std::uint8_t>(255 - p.r), static_cast<std::uint8_t>(255 - p.g),
             static_cast<std::uint8_t>(255 - p.b), 255};
    }
    EXPECT_LT(ssim(image, negative).value(), 0.3);
    EXPECT_DOUBLE_EQ(ssim(image, negative).value(), ssim(negative, image).value());
}

// Without structure only the luminance term is left: (2 ab + C1) / (a^2 + b^2 + C1).
TEST(Ssim, PlainPicturesFollowTheClosedForm) {
    const double c1 = 0.01 * 255 * 0.01 * 255;
    for (const int b : {0, 30, 100, 255}) {
        const auto level = static_cast<std::uint8_t>(b);
        const double got = ssim(plain({100, 100, 100}), plain({level, level, level})).value();
        EXPECT_NEAR(got, (2 * 100.0 * b + c1) / (100.0 * 100 + b * b + c1), 1e-9) << b;
    }
}

// One window over the whole of an 11x11 picture, summed the obvious way.
TEST(Ssim, OneWindowIsTheFormula) {
    const auto a = random_rgba8(11, 11, 8);
    const auto b = random_rgba8(11, 11, 9);
    double sw = 0, sa = 0, sb = 0;
    const auto luma = [](Rgba8 p) { return 0.299 * p.r + 0.587 * p.g + 0.114 * p.b; };
    const auto each = [&](auto visit) {
        for (int y = 0; y < 11; ++y) {
            for (int x = 0; x < 11; ++x) {
                const double w =
                    std::exp(-((x - 5) * (x - 5) + (y - 5) * (y - 5)) / (2 * 1.5 * 1.5));
                visit(w, luma(a.at(x, y)), luma(b.at(x, y)));
            }
        }
    };
    each([&](double w, double p, double q) {
        sw += w;
        sa += w * p;
        sb += w * q;
    });
    sa /= sw;
    sb /= sw;
    double va = 0, vb = 0, ab = 0;
    each([&](double w, double p, double q) {
        va += w / sw * (p - sa) * (p - sa);
        vb += w / sw * (q - sb) * (q - sb);
        ab += w / sw * (p - sa) * (q - sb);
    });
    const double c1 = 2.55 * 2.55;
    const double c2 = 7.65 * 7.65;
    EXPECT_NEAR(ssim(a, b).value(),
                (2 * sa * sb + c1) * (2 * ab + c2) / ((sa * sa + sb * sb + c1) * (va + vb + c2)),
                1e-9);
    EXPECT_FALSE(ssim(plain({}, 3, 4), plain({}, 4, 3)));
}

TEST(EdgeBand, LiesAroundSilhouettesOnly) {
    Image<float> z(20, 10, 2.0f);
    for (int y = 0; y < 10; ++y) {
        for (int x = 10; x < 20; ++x) z.at(x, y) = 3.0f;
    }
    const auto band = depth_edge_band(z);
    for (int x = 0; x < 20; ++x) EXPECT_EQ(band.at(x, 5), x >= 7 && x <= 12 ? 1 : 0) << x;
    // A slope is no edge, the border of what is there is one.
    Image<float> slope(20, 10);
    for (int y = 0; y < 10; ++y) {
        for (int x = 0; x < 20; ++x) slope.at(x, y) = 2.0f + 0.05f * static_cast<float>(x);
    }
    EXPECT_EQ(depth_edge_band(slope), Image<std::uint8_t>(20, 10, 0));
    Image<float> hole(20, 10, 2.0f);
    hole.at(10, 5) = 0;
    EXPECT_EQ(depth_edge_band(hole).at(12, 5), 1);
    EXPECT_EQ(depth_edge_band(hole).at(14, 5), 0);
}

TEST(EdgeBand, ErrorCountsOnlyItsPixels) {
    const auto a = plain({100, 100, 100}, 8, 4);
    auto b = a;
    b.at(1, 1).g = 130;  // in the band
    b.at(6, 1).g = 0;    // outside
    Image<std::uint8_t> band(8, 4, 0);
    for (int y = 0; y < 4; ++y) band.at(1, y) = 1;
    const auto error = band_error(a, b, band);
    ASSERT_TRUE(error);
    EXPECT_EQ(error->pixels, 4);
    EXPECT_DOUBLE_EQ(error->mse, 30.0 * 30 / (3 * 4));
    EXPECT_EQ(band_error(a, b, Image<std::uint8_t>(8, 4, 0))->mse, 0);
    EXPECT_FALSE(band_error(a, b, Image<std::uint8_t>(7, 4, 0)));
    const auto luma = luma_edge_band(b);
    EXPECT_EQ(luma.at(6, 1), 1);
    EXPECT_EQ(luma.at(1, 1), 0) << "a step of 30 in green is 18 of luma";
}

}  // namespace
}  // namespace kino
