#include "calibration/registration_holes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace kino {
namespace {

using registration::HoleFiller;

constexpr int kWidth = 60;
constexpr int kHeight = 40;

// A wall, slanted by `a` and `b` in 1/z a pixel.
Image<float> wall(double a = 0, double b = 0) {
    Image<float> out(kWidth, kHeight);
    for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
            out.at(x, y) = static_cast<float>(1 / (0.5 + a * (x - 30) + b * (y - 20)));
        }
    }
    return out;
}

void cut(Image<float>& image, int left, int top, int width, int height, float z = 0) {
    for (int y = top; y < top + height; ++y) {
        for (int x = left; x < left + width; ++x) image.at(x, y) = z;
    }
}

Image<float> filled(Image<float> image, int largest_px = 100) {
    HoleFiller().fill(image, largest_px);
    return image;
}

TEST(EnclosedHoles, GetTheSurfaceThatEnclosesThem) {
    for (const double slant : {0.0, 0.002, -0.004}) {
        const Image<float> whole = wall(slant, -slant / 3);
        Image<float> image = whole;
        cut(image, 10, 10, 7, 9);
        cut(image, 40, 5, 1, 1);
        cut(image, 41, 6, 1, 1);  // touches the last by a corner
        cut(image, 30, 25, 20, 2);
        const Image<float> out = filled(image);
        for (std::size_t i = 0; i < out.size(); ++i) {
            EXPECT_NEAR(out.pixels()[i], whole.pixels()[i], 1e-5);
        }
    }
}

TEST(EnclosedHoles, BetweenTwoSurfacesTheyStayEmpty) {
    Image<float> image = wall();
    cut(image, 0, 0, 25, kHeight, 1.0f);  // something near, and its shadow beside it
    cut(image, 25, 10, 5, 12);
    EXPECT_EQ(filled(image), image);
    // Around a thing that stands in the middle of the wall.
    image = wall();
    cut(image, 20, 10, 9, 9);
    cut(image, 23, 13, 3, 3, 1.0f);
    EXPECT_EQ(filled(image), image);
    // One pixel of something else on the rim.
    image = wall();
    cut(image, 20, 10, 9, 9);
    cut(image, 29, 14, 1, 1, 1.5f);
    EXPECT_EQ(filled(image), image);
}

TEST(EnclosedHoles, AtTheBorderTheyStayEmpty) {
    Image<float> image = wall();
    cut(image, 0, 10, 3, 3);
    cut(image, 57, 20, 3, 3);
    cut(image, 20, 0, 3, 1);
    cut(image, 20, 37, 3, 3);
    EXPECT_EQ(filled(image), image);
}

TEST(EnclosedHoles, LargerOnesStayEmpty) {
    Image<float> image = wall();
    cut(image, 10, 10, 10, 10);
    EXPECT_EQ(filled(image, 99), image);
    EXPECT_EQ(filled(image, 100), wall());
}

TEST(EnclosedHoles, ThreeQuantisationStepsAreOneSurface) {
    // Steps of a Kinect v1 in 1/z: two of them around the hole are noise, eight are an edge.
    for (const int steps : {2, 8}) {
        Image<float> image = wall();
        cut(image, 30, 0, 30, kHeight, static_cast<float>(1 / (0.5 + steps * 0.00307)));
        cut(image, 27, 17, 6, 6);
        const bool closed = filled(image).at(30, 20) > 0;
        EXPECT_EQ(closed, steps == 2);
    }
}

TEST(EnclosedHoles, NothingAndAlmostNothing) {
    const Image<float> nothing(kWidth, kHeight, 0.0f);
    EXPECT_EQ(filled(nothing, 1 << 20), nothing);
    for (const int size : {0, 1, 2, 3}) {
        Image<float> image(size, size, 1.0f);
        EXPECT_EQ(filled(image), image);
    }
    Image<float> ring(3, 3, 2.0f);
    ring.at(1, 1) = 0;
    EXPECT_EQ(filled(ring).at(1, 1), 2.0f);
}

}  // namespace
}  // namespace kino
