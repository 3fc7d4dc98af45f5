#include "viz/quality/guided_depth.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/reference/lod_reference_depth.h"
#include "tests/support/random.h"
#include "tests/viz/quality_lod/lod_rig.h"
#include "tests/viz/viz_fixture.h"

namespace kino::test {
namespace {

class GuidedDepth : public VizTest {
  protected:
    LodRig rig_{device()};
};

Image<Rgba8> random_colors(int width, int height, Random& random) {
    Image<Rgba8> colors(width, height);
    Rgba8 color{90, 120, 60, 255};
    for (Rgba8& c : colors.pixels()) {
        const auto byte = [&] { return static_cast<std::uint8_t>(random.integer(0, 255)); };
        if (random.chance(0.15)) color = {byte(), byte(), byte(), 255};
        c = color;
        if (random.chance(0.1)) c.a = 0;
    }
    return colors;
}

// Steps, holes and what is no number, against double precision.
TEST_F(GuidedDepth, IsTheReference) {
    Random random(8);
    for (const auto& [fine_w, fine_h, w, h] :
         {std::array{160, 120, 80, 60}, {160, 120, 40, 30}, {131, 97, 50, 37}, {64, 48, 64, 48}}) {
        for (const float offset : {0.0f, 0.5f}) {
            const Image<Rgba8> color = random_colors(fine_w, fine_h, random);
            Image<float> depth(w, h);
            float z = 2;
            for (float& d : depth.pixels()) {
                if (random.chance(0.1)) z = static_cast<float>(random.real(0.5, 5));
                d = z * static_cast<float>(random.real(0.995, 1.005));
                if (random.chance(0.05)) d = 0;
                if (random.chance(0.02)) d = std::nanf("");
                if (random.chance(0.02)) d = std::numeric_limits<float>::infinity();
                if (random.chance(0.02)) d = -1;
            }
            const Image<float> got = rig_.guided_depth(depth, color, {.offset_px = offset});
            int readings = 0;
            for (int y = 0; y < fine_h; ++y) {
                for (int x = 0; x < fine_w; ++x) {
                    const auto wanted =
                        reference::guided_depth(depth, color, x, y, {.offset_px = offset});
                    ASSERT_EQ(got.at(x, y) > 0, wanted.z > 0) << x << ' ' << y;
                    if (wanted.margin < 1e-3) continue;  // two surfaces as likely
                    ASSERT_NEAR(got.at(x, y), wanted.z, 2e-5 * wanted.z) << x << ' ' << y;
                    ++readings;
                }
            }
            EXPECT_GT(readings, fine_w * fine_h / 2);
        }
    }
}

/// A slanted edge between 1 m and 3 m, and colours that change with it.
struct Step {
    Image<float> truth;
    Image<float> depth;
    Image<Rgba8> color;
};
Step step_between_surfaces(int factor) {
    Step step{.truth = Image<float>(192, 144),
              .depth = Image<float>(192 / factor, 144 / factor),
              .color = Image<Rgba8>(192, 144)};
    for (int y = 0; y < 144; ++y) {
        for (int x = 0; x < 192; ++x) {
            const bool near = 7 * x + 3 * y < 900;
            step.truth.at(x, y) = near ? 1.0f : 3.0f;
            step.color.at(x, y) = near ? Rgba8{200, 180, 160, 255} : Rgba8{60, 70, 90, 255};
        }
    }
    for (int y = 0; y < step.depth.height(); ++y) {
        for (int x = 0; x < step.depth.width(); ++x) {
            step.depth.at(x, y) = step.truth.at(factor * x + factor / 2, factor * y + factor / 2);
        }
    }
    return step;
}

// The colour says where the edge is, to the pixel, and no depth lies between the surfaces.
TEST_F(GuidedDepth, EdgesAreWhereTheColorsAre) {
    for (const int factor : {2, 4}) {
        const Step step = step_between_surfaces(factor);
        const auto wrong = [&](float sigma) {
            const Image<float> got =
                rig_.guided_depth(step.depth, step.color, {.sigma_luma = sigma, .offset_px = 0.5f});
            int count = 0;
            for (std::size_t i = 0; i < got.size(); ++i) {
                const float z = got.pixels()[i];
                EXPECT_TRUE(std::abs(z - 1) < 1e-5f || std::abs(z - 3) < 1e-5f) << z;
                count += std::abs(z - step.truth.pixels()[i]) > 0.5f;
            }
            return count;
        };
        // But where the edge cuts off a corner that no depth pixel saw.
        const int guided = wrong(0.05f);
        EXPECT_LE(guided, 12 * factor);
        EXPECT_GT(wrong(std::numeric_limits<float>::infinity()), 2 * guided + 20 * factor);
    }
}

TEST_F(GuidedDepth, FullSizeIsACopy) {
    Random random(4);
    Image<float> depth(61, 47);
    for (float& z : depth.pixels()) z = static_cast<float>(random.real(0.5, 4));
    const Image<Rgba8> color = random_colors(61, 47, random);
    EXPECT_EQ(rig_.guided_depth(depth, color, {}), depth);
}

}  // namespace
}  // namespace kino::test
