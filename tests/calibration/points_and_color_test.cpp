#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "calibration/color_in_depth.h"
#include "calibration/depth_points.h"
#include "tests/calibration/rig_samples.h"

namespace kino {
namespace {

TEST(DepthPoints, EveryPixelIsDepthTimesRay) {
    RigSamples samples(1);
    for (const int width : {1, 7, 8, 9, 64, 131}) {
        Image<float> depth(width, 11);
        Image<RayXy> rays(width, 11);
        for (std::size_t i = 0; i < depth.size(); ++i) {
            const auto z = static_cast<float>(samples.uniform(0.3, 9));
            depth.pixels()[i] = i % 7 == 3 ? 0.0f : z;
            rays.pixels()[i] = {static_cast<float>(samples.normal(1)),
                                static_cast<float>(samples.normal(1))};
            if (i % 41 == 40) rays.pixels()[i].x = std::numeric_limits<float>::quiet_NaN();
            if (i % 41 == 20) rays.pixels()[i].y = std::numeric_limits<float>::quiet_NaN();
        }
        Image<glm::vec3> points;
        unproject_depth(depth, rays, points);
        for (std::size_t i = 0; i < depth.size(); ++i) {
            const RayXy ray = rays.pixels()[i];
            const float z = depth.pixels()[i];
            const glm::vec3 p = points.pixels()[i];
            if (std::isnan(ray.x) || std::isnan(ray.y)) {
                EXPECT_EQ(p, glm::vec3(0)) << i;
            } else {
                EXPECT_EQ(p, glm::vec3(z * ray.x, z * ray.y, z)) << i;
            }
        }
    }
}

Image<Rgba8> random_color(RigSamples& samples, int width, int height) {
    Image<Rgba8> image(width, height);
    const auto byte = [&] { return static_cast<std::uint8_t>(samples.uniform(0, 255.99)); };
    for (auto& c : image.pixels()) c = {byte(), byte(), byte(), byte()};
    return image;
}

TEST(ColorInDepth, WholePixelsCopyTheColour) {
    RigSamples samples(2);
    const Image<Rgba8> color = random_color(samples, 33, 21);
    Image<ColorUv> uv(33, 21);
    for (int y = 0; y < 21; ++y) {
        for (int x = 0; x < 33; ++x) {
            uv.at(x, y) = {static_cast<std::uint16_t>(16 * x), static_cast<std::uint16_t>(16 * y)};
        }
    }
    for (const auto sampling : {ColorSampling::nearest, ColorSampling::bilinear}) {
        Image<Rgba8> out;
        register_color(uv, color, sampling, out);
        for (std::size_t i = 0; i < out.size(); ++i) {
            Rgba8 expected = color.pixels()[i];
            expected.a = 255;
            EXPECT_EQ(out.pixels()[i], expected);
        }
    }
}

TEST(ColorInDepth, BilinearIsTheWeightedMean) {
    RigSamples samples(3);
    const Image<Rgba8> color = random_color(samples, 17, 13);
    Image<ColorUv> uv(400, 1);
    for (auto& p : uv.pixels()) {
        p = {static_cast<std::uint16_t>(samples.uniform(0, 16 * 16)),
             static_cast<std::uint16_t>(samples.uniform(0, 12 * 16))};
    }
    Image<Rgba8> out;
    register_color(uv, color, ColorSampling::bilinear, out);
    for (std::size_t i = 0; i < uv.size(); ++i) {
        const double u = uv.pixels()[i].u / 16.0;
        const double v = uv.pixels()[i].v / 16.0;
        double sum[3] = {0, 0, 0};
        for (int y = 0; y < 13; ++y) {
            for (int x = 0; x < 17; ++x) {
                const double weight =
                    std::max(0.0, 1 - std::abs(u - x)) * std::max(0.0, 1 - std::abs(v - y));
                sum[0] += weight * color.at(x, y).r;
                sum[1] += weight * color.at(x, y).g;
                sum[2] += weight * color.at(x, y).b;
            }
        }
        EXPECT_NEAR(out.pixels()[i].r, sum[0], 0.5001);
        EXPECT_NEAR(out.pixels()[i].g, sum[1], 0.5001);
        EXPECT_NEAR(out.pixels()[i].b, sum[2], 0.5001);
        EXPECT_EQ(out.pixels()[i].a, 255);
    }
}

TEST(ColorInDepth, NearestTakesTheNearest) {
    RigSamples samples(4);
    const Image<Rgba8> color = random_color(samples, 5, 5);
    Image<ColorUv> uv(4, 1);
    uv.at(0, 0) = {16 * 2 + 7, 16};
    uv.at(1, 0) = {16 * 2 + 9, 16};
    uv.at(2, 0) = {16, 16 * 3 + 7};
    uv.at(3, 0) = {16, 16 * 3 + 9};
    Image<Rgba8> out;
    register_color(uv, color, ColorSampling::nearest, out);
    EXPECT_EQ(out.at(0, 0).r, color.at(2, 1).r);
    EXPECT_EQ(out.at(1, 0).r, color.at(3, 1).r);
    EXPECT_EQ(out.at(2, 0).g, color.at(1, 3).g);
    EXPECT_EQ(out.at(3, 0).g, color.at(1, 4).g);
}

TEST(ColorInDepth, InvalidAndOutsideAreTransparent) {
    Image<ColorUv> uv(4, 1);
    uv.at(1, 0) = {16 * 8, 0};
    uv.at(2, 0) = {0, 16 * 8};
    uv.at(3, 0) = {16 * 7, 16 * 7};
    for (const auto sampling : {ColorSampling::nearest, ColorSampling::bilinear}) {
        Image<Rgba8> out;
        register_color(uv, Image<Rgba8>(8, 8, Rgba8{9, 9, 9, 0}), sampling, out);
        for (int x = 0; x < 3; ++x) EXPECT_EQ(out.at(x, 0), (Rgba8{0, 0, 0, 0}));
        EXPECT_EQ(out.at(3, 0), (Rgba8{9, 9, 9, 255}));
        register_color(uv, Image<Rgba8>(), sampling, out);
        EXPECT_EQ(out.at(3, 0), (Rgba8{0, 0, 0, 0}));
    }
}

}  // namespace
}  // namespace kino
