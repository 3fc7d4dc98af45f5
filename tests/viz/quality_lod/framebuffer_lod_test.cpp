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

// What the world may put into guides and light: the picture stays finite, and where every sample
// has light, so has every pixel.
TEST_F(FramebufferLod, BrokenInputsLeaveNoHoleAndNoNaN) {
    const std::vector<float> depths = {0,          -1,   1e-6f, 0.04f, 1e30f,         kInfinite,
                                       -kInfinite, 2.0f, 500,   5000,  std::nanf(""), 2.001f};
    const std::vector<glm::dvec3> normals = {{0, 0, -1}, {0, 0, 1},     {1, 0, 0},
                                             {0, -1, 0}, {1, 0, -1e-3}, {0.6, 0.6, 0.53}};
    for (const double r : {1.37, 4.0, 16.0}) {
        for (const LodFormat format : {LodFormat::packed, LodFormat::wide}) {
            Random random(static_cast<std::uint64_t>(10 * r) + (format == LodFormat::wide));
            LodScene scene = random_scene(130, 98, 5, false);
            for (std::size_t i = 0; i < scene.z.size(); ++i) {
                if (random.chance(0.5)) {
                    scene.z.pixels()[i] = depths[static_cast<std::size_t>(
                        random.integer(0, static_cast<int>(depths.size()) - 1))];
                }
                if (random.chance(0.5)) {
                    scene.normal.pixels()[i] = packed_normal(normals[static_cast<std::size_t>(
                        random.integer(0, static_cast<int>(normals.size()) - 1))]);
                }
                if (random.chance(0.1)) scene.normal.pixels()[i] = 0;
                scene.albedo.pixels()[i].a = 255;  // whatever its depth says
                // Dark and bright texels side by side.
                if (random.chance(0.3)) scene.albedo.pixels()[i] = {0, 0, 0, 255};
            }
            FramebufferLodOptions options{.r = r, .format = format};
            const LodResult lit = rig().run(scene, options, [](int, int, const glm::vec3& albedo) {
                return glm::vec4(0.5f * albedo, 1);
            });
            for (std::size_t i = 0; i < lit.picture.size(); ++i) {
                // One light everywhere: what comes out is albedo times it.
                const double wanted = 0.5 * from_srgb(scene.albedo.pixels()[i].g / 255.0);
                ASSERT_NEAR(lit.picture.pixels()[i].g, wanted, 2e-3) << "pixel " << i;
            }
            const LodResult broken =
                rig().run(scene, options, [&](int, int, const glm::vec3& albedo) {
                    glm::vec4 light(albedo, 1);
                    if (random.chance(0.2)) light.x = std::nanf("");
                    if (random.chance(0.2)) light.y = kInfinite;
                    if (random.chance(0.2)) light.z = -kInfinite;
                    return light;
                });
            for (const glm::vec4& c : broken.picture.pixels()) {
                ASSERT_TRUE(std::isfinite(c.x) && std::isfinite(c.y) && std::isfinite(c.z));
            }
        }
    }
}

TEST_F(FramebufferLod, WithoutSigmasItIsBilinearResizing) {
    const LodScene scene = random_scene(150, 112, 77, false);
    for (const double r : {1.37, 2.0, 7.3}) {
        FramebufferLodOptions options{.r = r, .sigma_z = kInfinite, .sigma_n = kInfinite};
        options.fine_grained = false;
        for (const int way : {0, 1, 2}) {
            options.format = way == 0 ? LodFormat::wide : LodFormat::packed;
            options.reconstruction =
                way == 2 ? Reconstruction::bilinear : Reconstruction::geometry_aware;
            const LodResult result = rig().run(scene, options, random_light(3));
            const auto samples = lod_samples(result, options);
            Image<glm::dvec3> reference(150, 112);
            for (int y = 0; y < 112; ++y) {
                for (int x = 0; x < 150; ++x) {
                    reference.at(x, y) = reference::lod_bilinear(samples, 150, 112, x, y);
                }
            }
            EXPECT_LT(compare(result.picture, reference, 1e-3).error, 1e-3)
                << "r " << r << ", way " << way;
        }
    }
}

TEST_F(FramebufferLod, FullSizeAddsNoPass) {
    const LodScene scene = random_scene(64, 48, 4, false);
    const LodShading light = random_light(4);
    const LodResult whole = rig().run(scene, {.r = 1}, light);
    EXPECT_TRUE(whole.direct);
    EXPECT_THAT(whole.passes, IsEmpty());
    EXPECT_EQ(whole.picture, whole.coarse);
    // Below the smallest coarse size, too.
    EXPECT_TRUE(rig().run(scene, {.r = 8}, light).direct);
}

TEST_F(FramebufferLod, EachKindHasOnlyItsPasses) {
    const LodScene scene = random_scene(150, 112, 4, false);
    LodRig fresh(device());
    const auto passes = [&](const FramebufferLodOptions& options) {
        return fresh.run(scene, options, random_light(4)).passes;
    };
    EXPECT_THAT(passes({.reconstruction = Reconstruction::bilinear, .fine_grained = false}),
                ElementsAre("lod/pick", "lod/up"));
    EXPECT_THAT(fresh.pipelines().names(), ElementsAre("lod/bilinear", "lod/pick"));
    EXPECT_THAT(passes({.flat_tolerance = 0}), ElementsAre("lod/pick", "lod/pack", "lod/up"));
    EXPECT_THAT(passes({.format = LodFormat::wide}), ElementsAre("lod/pick", "lod/up"));
    EXPECT_THAT(passes({}),
                ElementsAre("lod/pick", "lod/pack", "lod/classify", "lod/runs", "lod/up"));
}

TEST(LodSize, IsEvenAndBounded) {
    EXPECT_EQ(lod_size(1280, 720, 2), (LodSize{640, 360}));
    EXPECT_EQ(lod_size(1280, 720, 1.5), (LodSize{854, 480}));
    EXPECT_EQ(lod_size(1280, 720, 1), (LodSize{1280, 720}));
    EXPECT_EQ(lod_size(1279, 719, 1), (LodSize{1279, 719})) << "odd sizes stay whole at r = 1";
    EXPECT_EQ(lod_size(1280, 720, 1000), (LodSize{64, 48}));
    EXPECT_EQ(lod_size(1, 1, 8), (LodSize{1, 1}));
    int before = 1280;
    for (double r = 1; r < 16; r += 1.0 / 16) {
        const LodSize size = lod_size(1280, 720, r);
        EXPECT_TRUE(size.width % 2 == 0 && size.height % 2 == 0);
        EXPECT_LE(size.width, before);
        before = size.width;
    }
}

/// A slanted plane's depth along the ray of a pixel.
double plane_depth(const View& view, const glm::dvec3& normal, double distance, double x,
                   double y) {
    const Projection& k = view.projection;
    return -distance / glm::dot(normal, glm::dvec3((x - k.cx) / k.fx, (y - k.cy) / k.fy, 1));
}

// The coarse surface is the fine one at its texels; points lie on the rays of the coarse view.
TEST_F(FramebufferLod, CoarseSurfaceIsPickedAndItsViewFits) {
    for (const double r : {2.0, 3.0, 4.0, 1.37, 2.6}) {
        LodScene scene = random_scene(384, 288, 11, true);
        const glm::dvec3 normal = glm::normalize(glm::dvec3(0.4, -0.7, -0.6));
        for (int y = 0; y < 288; ++y) {
            for (int x = 0; x < 384; ++x) {
                scene.z.at(x, y) = static_cast<float>(plane_depth(scene.view, normal, 1.5, x, y));
                scene.normal.at(x, y) = packed_normal(normal);
            }
        }
        const LodResult result = rig().run(scene, {.r = r, .fine_grained = false}, random_light(1));
        const View& coarse = result.coarse_view;
        const bool whole = r == 2 || r == 3 || r == 4;
        double worst = 0;
        for (int y = 0; y < coarse.height; ++y) {
            for (int x = 0; x < coarse.width; ++x) {
                const int u = reference::lod_texel(x, 384, coarse.width);
                const int v = reference::lod_texel(y, 288, coarse.height);
                ASSERT_EQ(result.albedo.at(x, y), scene.albedo.at(u, v));
                ASSERT_EQ(result.normal.at(x, y), scene.normal.at(u, v));
                ASSERT_EQ(result.object.at(x, y), scene.object.at(u, v));
                const double offset = (x - coarse.projection.cx) / coarse.projection.fx -
                                      (u - scene.view.projection.cx) / scene.view.projection.fx;
                ASSERT_LE(std::abs(offset) * scene.view.projection.fx, whole ? 1e-9 : 0.5001);
                const double z = plane_depth(coarse, normal, 1.5, x, y);
                if (!(z > 0 && z < 4)) continue;  // behind, or close to the horizon
                worst = std::max(worst, std::abs(result.z.at(x, y) / z - 1));
            }
        }
        EXPECT_LT(worst, 2e-4) << "r " << r;  // 16-bit normals
    }
}

/// Left half at 2 m and lit, right half at 4 m and dark.
LodScene step_scene(int width, int height, int edge) {
    LodScene scene = plain_scene(width, height);
    for (int y = 0; y < height; ++y) {
        for (int x = edge; x < width; ++x) scene.z.at(x, y) = 4;
    }
    return scene;
}

// Colours 0 and 1 on two planes: resizing must not smear them into each other.
TEST_F(FramebufferLod, NothingLeaksAcrossADepthStep) {
    for (const double r : {1.37, 2.0, 3.1, 8.0}) {
        for (const float tolerance : {0.0f, 0.5f}) {
            const int edge = 251;
            const LodScene scene = step_scene(520, 390, edge);
            const LodShading light = [&](int x, int, const glm::vec3& albedo) {
                const int width = lod_size(520, 390, r).width;
                const int from = reference::lod_texel(x, 520, width);
                return glm::vec4(albedo * (from < edge ? 1.0f : 0.0f), 1);
            };
            const double bright = from_srgb(188 / 255.0);
            const auto worst = [&](const LodResult& result) {
                double most = 0;
                for (int y = 0; y < 390; ++y) {
                    for (int x = 0; x < 520; ++x) {
                        if (x == edge - 1 || x == edge) continue;
                        const double wanted = x < edge ? bright : 0;
                        most = std::max(most, std::abs(result.picture.at(x, y).g - wanted));
                    }
                }
                return most;
            };
            FramebufferLodOptions options{.r = r, .flat_tolerance = tolerance};
            EXPECT_LT(worst(rig().run(scene, options, light)), 0.02) << r << ' ' << tolerance;
            options.reconstruction = Reconstruction::bilinear;
            const double smeared = worst(rig().run(scene, options, light));
            EXPECT_TRUE(r < 5 || smeared > 0.3 * bright) << r << ": " << smeared;
        }
    }
}

// Objects that touch: depth and normal agree, only the number tells them apart.
TEST_F(FramebufferLod, ObjectsAreAHardFilter) {
    LodScene scene = plain_scene(200, 150);
    scene.object = Image<std::uint32_t>(200, 150, 5);
    for (int y = 0; y < 150; ++y) {
        for (int x = 101; x < 200; ++x) scene.object.at(x, y) = 1u << 16 | 6u;
    }
    const LodShading light = [&](int x, int, const glm::vec3& albedo) {
        return glm::vec4(albedo * (reference::lod_texel(x, 200, 68) < 101 ? 1.0f : 0.0f), 1);
    };
    for (const LodFormat format : {LodFormat::packed, LodFormat::wide}) {
        const LodResult result = rig().run(scene, {.r = 3, .format = format}, light);
        ASSERT_EQ(result.coarse.width(), 68);
        for (int y = 0; y < 150; ++y) {
            for (int x = 0; x < 200; ++x) {
                const double wanted = x < 101 ? from_srgb(188 / 255.0) : 0;
                ASSERT_NEAR(result.picture.at(x, y).g, wanted, 4e-3) << x;
            }
        }
    }
}

// A feature one pixel wide that no coarse texel saw takes a neighbour's light and its own albedo.
TEST_F(FramebufferLod, ThinFeaturesKeepTheirAlbedoAndGetSomeLight) {
    LodScene scene = plain_scene(320, 240);
    for (int y = 0; y < 240; ++y) {
        scene.z.at(120, y) = 0.5f;
        scene.albedo.at(120, y) = {250, 40, 40, 255};
        scene.normal.at(120, y) = packed_normal({0.9, 0, -0.4});
    }
    const LodShading light = [](int, int, const glm::vec3& albedo) {
        return glm::vec4(0.7f * albedo, 1);
    };
    const LodResult result = rig().run(scene, {.r = 5}, light);
    ASSERT_NE(reference::lod_texel(23, 320, 64), 120);
    ASSERT_NE(reference::lod_texel(24, 320, 64), 120);
    for (int y = 0; y < 240; ++y) {
        EXPECT_NEAR(result.picture.at(120, y).r, 0.7 * from_srgb(250 / 255.0), 3e-3);
        EXPECT_NEAR(result.picture.at(120, y).g, 0.7 * from_srgb(40 / 255.0), 3e-3);
    }
}

// Nothing behind a silhouette: background keeps its own colour, the surface its light.
TEST_F(FramebufferLod, BackgroundNextToASurfaceStaysBackground) {
    LodScene scene = plain_scene(240, 180);
    for (int y = 0; y < 180; ++y) {
        for (int x = 117; x < 240; ++x) {
            scene.z.at(x, y) = 0;
            scene.albedo.at(x, y) = {20, 40, static_cast<std::uint8_t>(y), 0};
        }
    }
    const LodShading light = [](int, int, const glm::vec3& albedo) {
        return glm::vec4(0.25f * albedo, 1);
    };
    for (const double r : {2.0, 3.3}) {
        for (const LodFormat format : {LodFormat::packed, LodFormat::wide}) {
            for (const bool fine : {false, true}) {
                FramebufferLodOptions options{.r = r, .fine_grained = fine, .format = format};
                const LodResult result = rig().run(scene, options, light);
                for (int y = 0; y < 180; ++y) {
                    for (int x = 0; x < 240; ++x) {
                        const Rgba8 own = scene.albedo.at(x, y);
                        const double wanted = from_srgb(own.b / 255.0) * (own.a == 0 ? 1.0 : 0.25);
                        ASSERT_NEAR(result.picture.at(x, y).b, wanted, 1e-3) << x << ' ' << y;
                        ASSERT_EQ(result.picture.at(x, y).a, own.a == 0 ? 0.0f : 1.0f);
                    }
                }
            }
        }
    }
}

// Tiles without edges take a path without guides; the picture must not show where.
TEST_F(FramebufferLod, FlatTilesDifferLittleFromEquationOne) {
    LodScene scene = plain_scene(320, 240);
    const glm::dvec3 floor = glm::normalize(glm::dvec3(0, -1, -0.15));
    Random random(6);
    for (int y = 0; y < 240; ++y) {
        for (int x = 0; x < 320; ++x) {
            const double z = plane_depth(scene.view, floor, 1.1, x, y);
            const bool ball = std::hypot(x - 170, y - 110) < 47;
            if (!ball && z > 0 && z < 12) {
                scene.z.at(x, y) = static_cast<float>(z);
                // A little rough, so that Eq. 1 does not weigh exactly as the tent does.
                scene.normal.at(x, y) = packed_normal(glm::normalize(
                    floor + 0.02 * glm::dvec3(random.real(-1, 1), 0, random.real(-1, 1))));
            } else if (ball) {
                const glm::dvec2 d((x - 170) / 47.0, (y - 110) / 47.0);
                scene.normal.at(x, y) =
                    packed_normal(glm::dvec3(d, -std::sqrt(std::max(0.0, 1 - glm::dot(d, d)))));
                scene.z.at(x, y) = 1.4f;
            } else {
                scene.z.at(x, y) = 30;
            }
        }
    }
    const LodShading light = [](int x, int y, const glm::vec3& albedo) {
        return glm::vec4(albedo * (0.6f + 0.4f * std::sin(0.21f * static_cast<float>(x)) *
                                              std::cos(0.17f * static_cast<float>(y))),
                         1);
    };
    const LodResult all = rig().run(scene, {.flat_tolerance = 0}, light);
    const LodResult tiles = rig().run(scene, {}, light);
    double most = 0;
    double sum = 0;
    std::int64_t same = 0;
    for (std::size_t i = 0; i < all.picture.size(); ++i) {
        const double d = std::abs(all.picture.pixels()[i].g - tiles.picture.pixels()[i].g);
        most = std::max(most, d);
        sum += d;
        same += d == 0;
    }
    const auto count = static_cast<double>(all.picture.size());
    EXPECT_LT(most, 0.02);
    EXPECT_LT(sum / count, 1e-3);
    EXPECT_GT(same, 0) << "no tile with an edge";
    EXPECT_LT(static_cast<double>(same), count - 2000) << "no flat tile";
}

}  // namespace
}  // namespace kino::test
