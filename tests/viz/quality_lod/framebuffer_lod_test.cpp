#include "viz/quality/framebuffer_lod.h"

#include <gmock/gmock.h>

#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "tests/support/random.h"
#include "tests/viz/quality_lod/lod_rig.h"
#include "tests/viz/viz_fixture.h"

namespace kino::test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr float kInfinite = std::numeric_limits<float>::infinity();

class FramebufferLod : public VizTest {
  protected:
    static LodRig& rig() {
        static auto* made = new LodRig(device());  // leaked, as the device is
        return *made;
    }
};

/// Surfaces that meet nowhere: every guide on its own, or near its neighbour's.
LodScene random_scene(int width, int height, std::uint64_t seed, bool objects) {
    Random random(seed);
    LodScene scene = plain_scene(width, height);
    if (objects) scene.object = Image<std::uint32_t>(width, height, 0);
    glm::dvec3 normal(0, 0, -1);
    double z = 2;
    for (std::size_t i = 0; i < scene.z.size(); ++i) {
        if (random.chance(0.3)) z = random.real(0.3, 9);
        if (random.chance(0.3)) {
            normal = glm::normalize(
                glm::dvec3(random.real(-1, 1), random.real(-1, 1), random.real(-1, 0.2)));
        }
        scene.z.pixels()[i] = static_cast<float>(z * (1 + random.real(-0.02, 0.02)));
        scene.normal.pixels()[i] = packed_normal(
            glm::normalize(normal + 0.1 * glm::dvec3(random.real(-1, 1), random.real(-1, 1), 0)));
        const auto byte = [&] { return static_cast<std::uint8_t>(random.integer(0, 255)); };
        scene.albedo.pixels()[i] = {byte(), byte(), byte(), 255};
        if (random.chance(0.1)) {
            scene.z.pixels()[i] = 0;
            scene.albedo.pixels()[i].a = 0;
        }
        if (objects) scene.object.pixels()[i] = random.chance(0.5) ? 7u << 16 | 3u : 12u;
    }
    return scene;
}

LodShading random_light(std::uint64_t seed) {
    return [seed](int x, int y, const glm::vec3& albedo) {
        Random random(seed + 7919 * static_cast<std::uint64_t>(x) +
                      104729 * static_cast<std::uint64_t>(y));
        const auto part = [&] { return static_cast<float>(random.real(0, 1.5)); };
        return glm::vec4(albedo * glm::vec3(part(), part(), part()), 1);
    };
}

struct Worst {
    double error = 0;  ///< largest, over 1 + the reference's value
    double far = 0;    ///< share of pixels off by more than `limit`
    std::int64_t count = 0;
};

Worst compare(const Image<glm::vec4>& picture, const Image<glm::dvec3>& reference, double limit) {
    Worst worst;
    for (std::size_t i = 0; i < picture.size(); ++i) {
        const glm::dvec3 got(picture.pixels()[i]);
        const glm::dvec3 wanted = reference.pixels()[i];
        double most = 0;
        for (int k = 0; k < 3; ++k) {
            if (!std::isfinite(got[k])) {
                ADD_FAILURE() << "pixel " << i << " is " << got[k];
                return worst;
            }
            most = std::max(most, std::abs(got[k] - wanted[k]) / (1 + wanted[k]));
        }
        worst.error = std::max(worst.error, most);
        worst.far += most > limit;
        ++worst.count;
    }
    worst.far /= static_cast<double>(worst.count);
    return worst;
}

// Eq. 1 in double precision, on guides without any order in them.
TEST_F(FramebufferLod, WideKernelIsEquationOne) {
    std::uint64_t seed = 1;
    for (const double r : {1.37, 2.0, 3.0, 7.3, 16.0}) {
        for (const RangeMetric metric :
             {RangeMetric::depth, RangeMetric::log_depth, RangeMetric::plane}) {
            const bool odd = (seed & 1) != 0;
            const LodScene scene = random_scene(150, 112, ++seed, odd);
            FramebufferLodOptions options{.r = r, .metric = metric, .fine_grained = odd};
            options.format = LodFormat::wide;
            const LodResult result = rig().run(scene, options, random_light(seed));
            const Worst worst =
                compare(result.picture, lod_reference_picture(scene, result, options), 1e-3);
            // Half floats hold eleven bits.
            EXPECT_LT(worst.error, 1e-3) << "r " << r << ", metric " << static_cast<int>(metric);
        }
    }
}

TEST_F(FramebufferLod, PackedKernelIsEquationOneOfItsWords) {
    std::uint64_t seed = 100;
    for (const double r : {1.37, 2.0, 3.0, 7.3, 16.0}) {
        for (const RangeMetric metric :
             {RangeMetric::depth, RangeMetric::log_depth, RangeMetric::plane}) {
            const bool odd = (seed & 1) != 0;
            const LodScene scene = random_scene(150, 112, ++seed, !odd);
            FramebufferLodOptions options{.r = r, .metric = metric, .fine_grained = odd};
            options.flat_tolerance = 0;
            const LodResult result = rig().run(scene, options, random_light(seed));
            const Worst worst =
                compare(result.picture, lod_reference_picture(scene, result, options), 1.0 / 255);
            // A word's last bit may round either way where its number lies half way.
            EXPECT_LT(worst.error, 1.0 / 255)
                << "r " << r << ", metric " << static_cast<int>(metric);
        }
    }
}

}  // namespace
}  // namespace kino::test
