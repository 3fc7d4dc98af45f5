#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/packing.hpp>
#include <limits>
#include <map>

#include "tests/support/random.h"
#include "tests/viz/forward/picture_test.h"
#include "tests/viz/supersampling/edge_rig.h"

namespace kino::test {
namespace {

constexpr int kWidth = 61;
constexpr int kHeight = 43;

class EdgeSamples : public VizTest {
  protected:
    static EdgeRig& rig() {
        static auto* made = new EdgeRig(device());  // leaked, as the device is
        return *made;
    }
};

StageOptions edge_options() {
    return {.lod = FramebufferLodOptions{.r = 1}, .samples = 4, .edge_share = 1};
}

/// One surface everywhere.
EdgeScene plain() {
    EdgeScene scene;
    scene.scene.color_mode = ColorMode::relit;
    scene.view = solid_view(kWidth, kHeight);
    StoredSurface wall;
    wall.albedo = {188, 120, 60, 255};
    wall.normal = stored_normal({0, 0, -1});
    scene.centre = Image<StoredSurface>(kWidth, kHeight, wall);
    for (auto& sample : scene.samples) sample = scene.centre;
    scene.linear =
        Image<std::uint64_t>(kWidth, kHeight, glm::packHalf4x16(glm::vec4(0.3, 0.2, 0.1, 1)));
    return scene;
}

StoredSurface random_surface(Random& random) {
    StoredSurface s;
    const auto byte = [&] { return static_cast<std::uint8_t>(random.integer(0, 255)); };
    s.albedo = {byte(), byte(), byte(), 255};
    s.z = static_cast<float>(random.chance(0.5) ? 2.0 : random.real(1.8, 2.4));
    s.normal = stored_normal(
        glm::normalize(glm::dvec3(random.real(-0.5, 0.5), random.real(-0.5, 0.5), -1)));
    s.object = static_cast<std::uint32_t>(random.integer(1, 3)) << 16 |
               static_cast<std::uint32_t>(random.integer(1, 2));
    if (random.chance(0.1)) s = {.albedo = {byte(), byte(), byte(), 0}, .z = 0, .object = 0};
    return s;
}

/// A few surfaces in patches, their samples mixed at random, light of every strength.
EdgeScene patched(std::uint64_t seed) {
    Random random(seed);
    EdgeScene scene = plain();
    scene.scene.exposure = static_cast<float>(random.real(0.5, 2));
    std::array<StoredSurface, 5> palette;
    for (StoredSurface& s : palette) s = random_surface(random);
    const auto any = [&] { return palette[static_cast<std::size_t>(random.integer(0, 4))]; };
    StoredSurface now = any();
    for (std::size_t i = 0; i < scene.linear.size(); ++i) {
        if (random.chance(0.2)) now = any();
        scene.centre.pixels()[i] = now;
        for (auto& sample : scene.samples) {
            sample.pixels()[i] = random.chance(0.8) ? now : any();
        }
        const double strength = std::exp(random.real(-4, random.chance(0.05) ? 5 : 0.5));
        scene.linear.pixels()[i] =
            glm::packHalf4x16(glm::vec4(strength * random.real(0, 1), strength * random.real(0, 1),
                                        strength * random.real(0, 1), now.albedo.a != 0 ? 1 : 0));
    }
    return scene;
}

std::array<reference::EdgeSurface, 4> samples_at(const EdgeScene& scene, std::size_t i) {
    std::array<reference::EdgeSurface, 4> samples;
    for (std::size_t s = 0; s < 4; ++s) {
        samples[s] = as_reference(scene.samples[s].pixels()[i], scene.scene, true);
    }
    return samples;
}

/// Compares list and colours with the double reference; returns how many edges there were.
int compare(const EdgeScene& scene, const StageOptions& options, const EdgeResult& result) {
    Image<reference::EdgeSurface> surface(kWidth, kHeight);
    Image<glm::dvec3> picture(kWidth, kHeight);
    for (std::size_t i = 0; i < picture.size(); ++i) {
        surface.pixels()[i] = as_reference(scene.centre.pixels()[i], scene.scene, false);
        picture.pixels()[i] = glm::unpackHalf4x16(scene.linear.pixels()[i]);
    }
    const reference::EdgeRules rules = rules_of(scene, options);
    std::vector<std::uint32_t> wanted;
    int wrong = 0, edges = 0;
    for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
            const std::size_t i = static_cast<std::size_t>(y * kWidth + x);
            const auto samples = samples_at(scene, i);
            // Samples of one triangle have no edge among them.
            bool one = scene.centre.pixels()[i].object == scene.samples[0].pixels()[i].object;
            for (const auto& s : scene.samples) {
                one = one && s.pixels()[i] == scene.samples[0].pixels()[i];
            }
            const double excess =
                one ? 0 : reference::edge_excess(surface.pixels()[i], samples, x, y, rules.lod);
            const auto word = static_cast<std::uint32_t>(y << 16 | x);
            const bool listed =
                std::binary_search(result.listed.begin(), result.listed.end(), word);
            EXPECT_TRUE(std::abs(excess - 1) < 1e-3 || listed == (excess > 1)) << x << " " << y;
            if (!listed) {
                wrong += result.linear.pixels()[i] != scene.linear.pixels()[i];
                continue;
            }
            ++edges;
            const glm::dvec4 want = reference::edge_color(picture, surface, samples, x, y, rules);
            const glm::dvec4 got = glm::unpackHalf4x16(result.linear.pixels()[i]);
            EXPECT_EQ(got.a, want.a);
            for (int k = 0; k < 3; ++k) {
                // The way back through the tone curve magnifies what is lost near white.
                const double steep = rules.as_shown && rules.tone_map
                                         ? std::pow(1 + std::max(want[k] * rules.exposure, 0.7), 2)
                                         : 1.0;
                wrong += !(std::abs(got[k] - want[k]) <= 2e-3 * want[k] + 2e-5 * steep + 2e-4);
                if (::testing::Test::HasFailure()) return edges;
            }
        }
    }
    EXPECT_EQ(wrong, 0);
    return edges;
}

// Every metric, both ways to take the mean, colours in the light or apart from it, things that
// shine; each in one of three programs, for they take long to make.
TEST_F(EdgeSamples, FollowTheDoubleReference) {
    struct Case {
        RangeMetric metric;
        SampleResolve resolve;
        bool fine_grained, emission, captured;
    };
    const std::array<Case, 4> cases = {
        {{RangeMetric::plane, SampleResolve::as_shown, true, false, false},
         {RangeMetric::plane, SampleResolve::as_shown, true, false, true},
         {RangeMetric::log_depth, SampleResolve::linear, false, false, false},
         {RangeMetric::depth, SampleResolve::as_shown, true, true, false}}};
    std::uint64_t seed = 1;
    for (const Case& c : cases) {
        EdgeScene scene = patched(seed++);
        StageOptions options = edge_options();
        options.resolve = c.resolve;
        options.lod->metric = c.metric;
        options.lod->fine_grained = c.fine_grained;
        if (c.emission) {
            scene.scene.materials = {{.name = "lamp", .emission = {0.4f, 0.1f, 0.05f}},
                                     {.name = "matt"},
                                     {.name = "sign", .emission = {0, 2, 3}}};
        }
        if (c.captured) scene.scene.color_mode = ColorMode::captured;
        const EdgeResult result = rig().run(scene, options);
        EXPECT_EQ(result.found, result.listed.size());
        EXPECT_TRUE(std::is_sorted(result.listed.begin(), result.listed.end()));
        const int edges = compare(scene, options, result);
        EXPECT_GT(edges, kWidth * kHeight / 4) << seed;
        EXPECT_LT(edges, kWidth * kHeight * 9 / 10) << seed;
    }
}

// One plane, one light, a silhouette: exactly the mix that the samples' numbers say.
TEST_F(EdgeSamples, SilhouetteIsACoverageWeightedMix) {
    EdgeScene scene = plain();
    const StoredSurface sky{.albedo = {40, 60, 90, 0}, .z = 0, .object = 0};
    const StoredSurface wall = scene.centre.at(0, 0);
    const glm::vec4 sky_light(linear_of(40), linear_of(60), linear_of(90), 0);
    for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
            const auto covered = [&](double u, double v) {
                return std::hypot(u - 30, v - 21) < 16.2;
            };
            const bool centre = covered(x, y);
            scene.centre.at(x, y) = centre ? wall : sky;
            if (!centre) scene.linear.at(x, y) = glm::packHalf4x16(sky_light);
            for (std::size_t s = 0; s < 4; ++s) {
                scene.samples[s].at(x, y) =
                    covered(x + kSamplePlaces[s][0], y + kSamplePlaces[s][1]) ? wall : sky;
            }
        }
    }
    const EdgeResult result = rig().run(scene, edge_options());
    const glm::dvec3 lit = glm::unpackHalf4x16(glm::packHalf4x16(glm::vec4(0.3, 0.2, 0.1, 1)));
    std::map<int, int> seen;
    for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
            int count = 0;
            for (const auto& sample : scene.samples) count += sample.at(x, y) == wall;
            ++seen[count];
            const glm::dvec3 want =
                (double(count) * lit + double(4 - count) * glm::dvec3(sky_light)) / 4.0;
            const glm::dvec4 got = glm::unpackHalf4x16(result.linear.at(x, y));
            // A half's step.
            for (int k = 0; k < 3; ++k) EXPECT_NEAR(got[k], want[k], want[k] / 1024);
            EXPECT_EQ(got.a, count > 0 ? 1 : 0);
        }
    }
    for (const int count : {0, 1, 2, 3, 4}) EXPECT_GT(seen[count], 5) << count;
}

TEST_F(EdgeSamples, OneSurfaceListsNothing) {
    EdgeScene scene = plain();
    Random random(3);
    // Slanted, a little bent, textured.
    for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
            StoredSurface s = scene.centre.at(x, y);
            s.albedo.g = static_cast<std::uint8_t>(random.integer(0, 255));
            s.z += 0.01f * static_cast<float>(x);
            s.normal = stored_normal(glm::normalize(glm::dvec3(0.3 + 0.002 * y, 0, -1)));
            scene.centre.at(x, y) = s;
            for (auto& sample : scene.samples) {
                s.z += 0.002f;
                sample.at(x, y) = s;
            }
        }
    }
    const EdgeResult result = rig().run(scene, edge_options());
    EXPECT_EQ(result.found, 0u);
    EXPECT_TRUE(std::ranges::equal(result.linear.pixels(), scene.linear.pixels()));
}

// A list that is too short takes the edges that show most, and the others stay as they were.
TEST_F(EdgeSamples, OverflowIsBounded) {
    EdgeScene scene = plain();
    for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
            StoredSurface other = scene.centre.at(x, y);
            other.object += 1;
            if (x % 2 == 0) other.albedo = {0, 0, 0, 255};  // far from the wall's colour
            scene.samples[2].at(x, y) = other;
        }
    }
    StageOptions options = edge_options();
    for (const float share : {0.6f, 0.2f, 0.0001f}) {
        options.edge_share = share;
        const EdgeResult result = rig().run(scene, options);
        EXPECT_EQ(result.found, static_cast<unsigned>(kWidth * kHeight));
        EXPECT_LE(result.listed.size(), std::max(1.0, share * double(kWidth * kHeight)));
        EXPECT_GE(result.listed.size(), std::floor(0.9 * share * double(kWidth * kHeight)));
        EXPECT_TRUE(std::is_sorted(result.listed.begin(), result.listed.end()));
        int even = 0;
        for (const std::uint32_t word : result.listed) even += word % 2 == 0;
        if (share < 0.5f) {
            EXPECT_EQ(even, static_cast<int>(result.listed.size()));
        } else {
            EXPECT_EQ(even, (kWidth + 1) / 2 * kHeight);
        }
        int changed = 0;
        for (std::size_t i = 0; i < scene.linear.size(); ++i) {
            changed += result.linear.pixels()[i] != scene.linear.pixels()[i];
        }
        EXPECT_LE(changed, static_cast<int>(result.listed.size()));
    }
}

// Depths, normals and light that are no numbers, in samples and in what they look at.
TEST_F(EdgeSamples, BrokenGuidesStayFinite) {
    constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
    constexpr float kInf = std::numeric_limits<float>::infinity();
    const std::array<float, 8> depths = {kNan, kInf, -kInf, -1, 0, 1e-30f, 1e30f, 2};
    Random random(9);
    for (const bool plane : {true, false}) {
        EdgeScene scene = patched(11);
        const auto spoil = [&](StoredSurface& s) {
            if (random.chance(0.4)) {
                s.z = depths[static_cast<std::size_t>(random.integer(0, 7))];
            }
            if (random.chance(0.3)) s.normal = static_cast<std::uint32_t>(random.bits());
        };
        for (std::size_t i = 0; i < scene.linear.size(); ++i) {
            spoil(scene.centre.pixels()[i]);
            for (auto& sample : scene.samples) spoil(sample.pixels()[i]);
            if (random.chance(0.2)) {
                scene.linear.pixels()[i] =
                    glm::packHalf4x16(glm::vec4(kNan, random.chance(0.5) ? kInf : -kInf, 65504, 1));
            }
        }
        StageOptions options = edge_options();
        if (!plane) {
            // The program that the reference was compared with.
            options.lod->metric = RangeMetric::log_depth;
            options.lod->fine_grained = false;
            options.resolve = SampleResolve::linear;
        }
        const EdgeResult result = rig().run(scene, options);
        EXPECT_GT(result.listed.size(), 500u);
        for (const std::uint32_t word : result.listed) {
            const glm::vec4 c = glm::unpackHalf4x16(
                result.linear.at(static_cast<int>(word & 0xFFFF), static_cast<int>(word >> 16)));
            for (int k = 0; k < 4; ++k) {
                ASSERT_TRUE(std::isfinite(c[k]) && c[k] >= 0) << word << " " << c[k];
            }
        }
    }
}

}  // namespace
}  // namespace kino::test
