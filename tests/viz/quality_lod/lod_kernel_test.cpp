#include <gmock/gmock.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "tests/support/random.h"
#include "tests/viz/quality_lod/lod_rig.h"
#include "tests/viz/viz_fixture.h"

namespace kino::test {
namespace {

class LodGauss : public VizTest {};

/// Patches of surfaces with holes and two objects.
LodScene kernel_scene(int width, int height, std::uint64_t seed) {
    Random random(seed);
    LodScene scene = plain_scene(width, height);
    scene.object = Image<std::uint32_t>(width, height, 5);
    double z = 2;
    glm::dvec3 normal(0, 0, -1);
    for (std::size_t i = 0; i < scene.z.size(); ++i) {
        if (random.chance(0.1)) z = random.real(1.9, 2.2);
        if (random.chance(0.1)) {
            normal = glm::normalize(glm::dvec3(random.real(-0.3, 0.3), random.real(-0.3, 0.3), -1));
        }
        scene.z.pixels()[i] = random.chance(0.03) ? 0.0f : static_cast<float>(z);
        scene.normal.pixels()[i] = packed_normal(normal);
        scene.object.pixels()[i] = random.chance(0.2) ? 6 : 5;
        scene.albedo.pixels()[i].a = random.chance(0.03) ? 0 : 255;
    }
    return scene;
}

LodShading kernel_light(std::uint64_t seed) {
    return [seed](int x, int y, const glm::vec3& albedo) {
        Random random(seed + 7919 * static_cast<std::uint64_t>(x) +
                      104729 * static_cast<std::uint64_t>(y));
        return glm::vec4(albedo * static_cast<float>(random.real(0, 1.5)), 1);
    };
}

// Eq. 1 with a Gaussian, in double precision.
TEST_F(LodGauss, IsEquationOneOverSixteenPixels) {
    LodRig rig(device());
    std::uint64_t seed = 40;
    for (const LodFormat format : {LodFormat::packed, LodFormat::wide}) {
        for (const double r : {1.37, 2.0, 2.6}) {
            const LodScene scene = kernel_scene(153, 117, ++seed);
            FramebufferLodOptions options{
                .r = r, .format = format, .kernel = LodKernel::gauss, .fix_share = 1};
            const LodResult result = rig.run(scene, options, kernel_light(seed));
            Image<double> bits;
            const Image<glm::dvec3> wanted = lod_reference_picture(scene, result, options, &bits);
            const double limit = format == LodFormat::packed ? 1.0 / 255 : 1e-3;
            double worst = 0;
            std::size_t doubtful = 0;
            for (std::size_t i = 0; i < wanted.size(); ++i) {
                const double got = result.picture.pixels()[i].g;
                ASSERT_TRUE(std::isfinite(got));
                worst = std::max(worst,
                                 std::abs(got - wanted.pixels()[i].g) / (1 + wanted.pixels()[i].g));
                doubtful += 8 * std::sqrt(std::max(bits.pixels()[i], 0.0)) > 16.5;
            }
            EXPECT_LT(worst, limit) << "r " << r;
            EXPECT_GT(doubtful, 100u);
            EXPECT_NEAR(static_cast<double>(result.fixed.size()), static_cast<double>(doubtful),
                        0.01 * static_cast<double>(doubtful) + 2);
        }
    }
}

// It is not the tent, and what tiles there would be are not asked for.
TEST_F(LodGauss, IsSmootherThanTheTent) {
    LodRig rig(device());
    const LodScene scene = plain_scene(200, 150);
    const LodShading stripes = [](int x, int, const glm::vec3& albedo) {
        return glm::vec4(albedo * (x % 2 == 0 ? 0.2f : 1.0f), 1);
    };
    const auto spread = [&](LodKernel kernel) {
        const LodResult result = rig.run(scene, {.r = 3, .kernel = kernel}, stripes);
        EXPECT_EQ(testing::Value(result.passes, testing::Contains("lod/runs")),
                  kernel == LodKernel::tent);
        float least = 9, most = 0;
        for (int x = 20; x < 180; ++x) {
            least = std::min(least, result.picture.at(x, 75).g);
            most = std::max(most, result.picture.at(x, 75).g);
        }
        return most - least;
    };
    EXPECT_LT(spread(LodKernel::gauss), 0.6 * spread(LodKernel::tent));
}

}  // namespace
}  // namespace kino::test
