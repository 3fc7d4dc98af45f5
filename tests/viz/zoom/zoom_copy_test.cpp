#include "viz/quality/zoom/zoom_copy.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "tests/reference/zoom_reference.h"

namespace kino {
namespace {

constexpr std::uint32_t kUntouched = 0xDEADBEEF;

Image<std::uint32_t> noise(int width, int height, std::mt19937& random) {
    Image<std::uint32_t> image(width, height);
    for (std::uint32_t& pixel : image.pixels()) pixel = static_cast<std::uint32_t>(random());
    return image;
}

/// Rows with room behind them, to see whether it is left alone.
struct Padded {
    int width, height, pitch;
    std::vector<std::uint32_t> words;
    Padded(int w, int h, int pad)
        : width(w),
          height(h),
          pitch(w + pad),
          words(static_cast<std::size_t>(pitch * h), kUntouched) {}
    ImageView<std::uint32_t> view() { return {words.data(), width, height, pitch}; }
    [[nodiscard]] bool padding_untouched() const {
        for (int y = 0; y < height; ++y) {
            for (int x = width; x < pitch; ++x) {
                if (words[static_cast<std::size_t>(y * pitch + x)] != kUntouched) return false;
            }
        }
        return true;
    }
};

TEST(ZoomCopy, EqualsANaiveLoopForAllSizesAndPitches) {
    std::mt19937 random(11);
    const Image<std::uint32_t> source = noise(67, 67, random);
    int wrong = 0;
    for (int z = 1; z <= kMaxZoom; ++z) {
        for (int height = 1; height <= 67; ++height) {
            for (int width = 1; width <= 67; ++width) {
                const int w = (width + z - 1) / z;
                const int h = (height + z - 1) / z;
                const ImageView<const std::uint32_t> small{source.data(), w, h, source.width()};
                Padded out(width, height, (width * 7 + height + z) % 6);
                const std::int64_t outside = enlarge(small, z, ZoomBlur::none, out.view());
                bool equal = outside == 0 && out.padding_untouched();
                for (int y = 0; y < height; ++y) {
                    for (int x = 0; x < width; ++x) {
                        equal = equal && out.view().at(x, y) == source.at(x / z, y / z);
                    }
                }
                if (!equal && wrong++ == 0) ADD_FAILURE() << z << ": " << width << "x" << height;
            }
        }
    }
    EXPECT_EQ(wrong, 0);
}

class ZoomCopyBlur : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Zooms, ZoomCopyBlur, ::testing::Range(2, kMaxZoom + 1));

TEST_P(ZoomCopyBlur, BoxIsBilinearBetweenTheCentresOfBlocks) {
    const int z = GetParam();
    std::mt19937 random(static_cast<unsigned>(z));
    const Image<std::uint32_t> small = noise(9, 7, random);
    Image<std::uint32_t> out(9 * z - 1, 7 * z - 1);
    enlarge(small.view(), z, ZoomBlur::box, out.view());
    double worst = 0, against_boxes = 0;
    for (int y = 0; y < out.height(); ++y) {
        for (int x = 0; x < out.width(); ++x) {
            for (int c = 0; c < 4; ++c) {
                const double expected = reference::zoom_bilinear(small, z, c, x, y);
                worst = std::max(worst, std::abs(reference::channel(out.at(x, y), c) - expected));
                if (y % 3 == 0 && x % 3 == 0) {
                    against_boxes =
                        std::max(against_boxes,
                                 std::abs(reference::zoom_boxes(small, z, 1, c, x, y) - expected));
                }
            }
        }
    }
    EXPECT_LE(worst, 0.5 + 1.0 / 32);
    EXPECT_LE(against_boxes, 1e-9);  // the two references agree on what a box is
}

TEST_P(ZoomCopyBlur, SplineIsTwoBoxes) {
    const int z = GetParam();
    std::mt19937 random(static_cast<unsigned>(100 + z));
    const Image<std::uint32_t> small = noise(5, 4, random);
    Image<std::uint32_t> out(5 * z, 4 * z);
    enlarge(small.view(), z, ZoomBlur::spline, out.view());
    double worst = 0;
    for (int y = 0; y<out.height(); y += z> 4 ? 2 : 1) {
        for (int x = 0; x<out.width(); x += z> 4 ? 3 : 1) {
            const double expected = reference::zoom_boxes(small, z, 2, (x + y) % 4, x, y);
            worst =
                std::max(worst, std::abs(reference::channel(out.at(x, y), (x + y) % 4) - expected));
        }
    }
    EXPECT_LE(worst, 0.5 + 1.0 / 32);
}

TEST_P(ZoomCopyBlur, KeepsOneColourAsItIs) {
    const int z = GetParam();
    for (const std::uint32_t v : {0x00000000u, 0x01FE7F80u, 0xFFFFFFFFu}) {
        const Image<std::uint32_t> small(6, 3, v);
        for (const ZoomBlur blur : {ZoomBlur::box, ZoomBlur::spline}) {
            Image<std::uint32_t> out(6 * z - 2, 3 * z);
            enlarge(small.view(), z, blur, out.view());
            EXPECT_TRUE(std::all_of(out.pixels().begin(), out.pixels().end(),
                                    [&](std::uint32_t p) { return p == v; }));
        }
    }
}

TEST(ZoomCopy, SimdAgreesWithPortableToTheBit) {
    std::mt19937 random(5);
    for (int trial = 0; trial < 400; ++trial) {
        const int z = 1 + trial % kMaxZoom;
        const auto blur = static_cast<ZoomBlur>(trial / 8 % 3);
        const Image<std::uint32_t> small =
            noise(1 + static_cast<int>(random() % 40), 1 + static_cast<int>(random() % 12), random);
        const glm::ivec2 offset{static_cast<int>(random() % 60) - 30,
                                static_cast<int>(random() % 60) - 30};
        const int pad = static_cast<int>(random() % 5);
        Padded a(1 + static_cast<int>(random() % 90), 1 + static_cast<int>(random() % 30), pad);
        Padded b(a.width, a.height, pad);
        const auto outside = enlarge(small.view(), z, blur, a.view(), offset);
        EXPECT_EQ(outside, enlarge_portable(small.view(), z, blur, b.view(), offset));
        ASSERT_EQ(a.words, b.words) << "trial " << trial;
    }
}

TEST(ZoomCopy, AnOffsetShowsTheNearestPixelOutside) {
    std::mt19937 random(6);
    for (int trial = 0; trial < 300; ++trial) {
        const int z = 1 + trial % kMaxZoom;
        const auto blur = static_cast<ZoomBlur>(trial / 8 % 3);
        const Image<std::uint32_t> small =
            noise(1 + static_cast<int>(random() % 9), 1 + static_cast<int>(random() % 9), random);
        Image<std::uint32_t> whole(small.width() * z, small.height() * z);
        enlarge(small.view(), z, blur, whole.view());
        const glm::ivec2 offset{static_cast<int>(random() % 90) - 45,
                                static_cast<int>(random() % 90) - 45};
        Image<std::uint32_t> out(1 + static_cast<int>(random() % 30),
                                 1 + static_cast<int>(random() % 30));
        std::int64_t outside = 0;
        Image<std::uint32_t> expected(out.width(), out.height());
        for (int y = 0; y < out.height(); ++y) {
            for (int x = 0; x < out.width(); ++x) {
                const int u = x + offset.x, v = y + offset.y;
                outside += !whole.contains(u, v);
                expected.at(x, y) = whole.at(std::clamp(u, 0, whole.width() - 1),
                                             std::clamp(v, 0, whole.height() - 1));
            }
        }
        EXPECT_EQ(enlarge(small.view(), z, blur, out.view(), offset), outside);
        ASSERT_EQ(out, expected) << "trial " << trial << " z " << z;
    }
}

TEST(ZoomCopyDeathTest, RefusesToReadWhatItWrites) {
    Image<std::uint32_t> image(8, 8);
    EXPECT_DEATH(enlarge(image.view().data == nullptr
                             ? ImageView<const std::uint32_t>{}
                             : ImageView<const std::uint32_t>{image.data(), 4, 4, 8},
                         2, ZoomBlur::none, image.view()),
                 "");
}

}  // namespace
}  // namespace kino
