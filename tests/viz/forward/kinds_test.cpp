#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/packing.hpp>

#include "tests/reference/light_reference.h"
#include "tests/viz/forward/picture_test.h"

namespace kino::test {
namespace {

using ::testing::Contains;
using ::testing::Each;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr int kWidth = 80;
constexpr int kHeight = 56;

class KindsTest : public PictureTest {
  protected:
    static FrameResult draw(const Scene& scene, const FrameOptions& options = {}) {
        return PictureTest::draw(scene, solid_view(kWidth, kHeight), options);
    }
};

glm::vec3 unpacked(std::uint32_t normal) {
    const glm::vec2 o = glm::unpackSnorm2x16(normal);
    glm::vec3 n(o, 1 - std::abs(o.x) - std::abs(o.y));
    if (n.z < 0) {
        n.x = (1 - std::abs(o.y)) * (o.x >= 0 ? 1.0f : -1.0f);
        n.y = (1 - std::abs(o.x)) * (o.y >= 0 ? 1.0f : -1.0f);
    }
    return glm::normalize(n);
}

/// What the surface of a drawn picture receives, all lights one after the other, in double: the
/// light of a white matt surface in its place.
class Arriving {
  public:
    Arriving(Scene scene, const FrameResult& frame)
        : scene_(std::move(scene)), view_(solid_view(kWidth, kHeight)) {
        surface_.view_z_m = frame.surface.view_z_m;
        surface_.normal.resize(kWidth, kHeight);
        surface_.albedo.resize(kWidth, kHeight);
        for (std::size_t i = 0; i < surface_.normal.size(); ++i) {
            surface_.normal.pixels()[i] = unpacked(frame.surface.normal.pixels()[i]);
            surface_.albedo.pixels()[i] = {255, 255, 255, 255};
        }
    }
    [[nodiscard]] glm::dvec3 at(int x, int y) const {
        return reference::shaded(scene_, view_, surface_, x, y);
    }
    [[nodiscard]] double facing(int x, int y) const {
        const Projection& k = view_.projection;
        const glm::dvec3 way((x - k.cx) / k.fx, (y - k.cy) / k.fy, 1);
        return -glm::dot(glm::dvec3(surface_.normal.at(x, y)), glm::normalize(way));
    }

  private:
    Scene scene_;
    View view_;
    reference::LitSurface surface_;
};

double smooth(double from, double to, double x) {
    const double t = std::clamp((x - from) / (to - from), 0.0, 1.0);
    return t * t * (3 - 2 * t);
}

/// Share of the light that counts: to the nearest of `steps`, by definition of the material.
double stepped(double bright, int steps) {
    const double whole = std::floor(bright * steps);
    return (whole + smooth(0.45, 0.55, bright * steps - whole)) / steps / bright;
}

TEST_F(KindsTest, ToonFollowsTheDoubleReference) {
    for (const int lights : {6, 24}) {
        for (const std::uint32_t steps : {2u, 5u}) {
            Scene scene = solid_scene(lights);
            // Bright enough for several steps, and below where the tone curve bends.
            for (Light& light : scene.lights) light.color *= 1.5f;
            for (Material& material : scene.materials) {
                material.kind = MaterialKind::toon;
                material.steps = steps;
                material.base_color *= 0.4f;
            }
            const FrameResult frame = draw(scene, {.read_surface = true});
            const Arriving arriving(scene, frame);
            int looked_at = 0;
            std::vector<double> levels;
            for (int y = 0; y < kHeight; ++y) {
                for (int x = 0; x < kWidth; ++x) {
                    const glm::dvec3 light = arriving.at(x, y);
                    const double bright = glm::dot(light, glm::dvec3(0.2126, 0.7152, 0.0722));
                    const double step = stepped(bright, static_cast<int>(steps));
                    // Between steps a rounding of the light is a change of the picture.
                    if (std::abs(stepped(bright * 1.01, static_cast<int>(steps)) - step) > 0.02 ||
                        std::abs(arriving.facing(x, y) - 0.2) < 0.06) {
                        continue;
                    }
                    ++looked_at;
                    levels.push_back(bright * step);
                    const double outline = smooth(0.15, 0.25, arriving.facing(x, y));
                    // The material is not in the readback; its colour's ratios are in the picture.
                    const Rgba8 got = frame.picture.at(x, y);
                    double off = 1e9;
                    for (const Material& material : scene.materials) {
                        const glm::dvec3 wanted =
                            glm::dvec3(material.base_color) * light * step * outline;
                        off = std::min(off, std::max({std::abs(coded_of(wanted.r) - got.r),
                                                      std::abs(coded_of(wanted.g) - got.g),
                                                      std::abs(coded_of(wanted.b) - got.b)}));
                    }
                    ASSERT_LE(off, 2) << x << " " << y << " of " << lights << " lights";
                }
            }
            EXPECT_GT(looked_at, kWidth * kHeight / 2);
            EXPECT_GT(*std::max_element(levels.begin(), levels.end()) -
                          *std::min_element(levels.begin(), levels.end()),
                      0.15);
        }
    }
}

TEST_F(KindsTest, UnlitIsItsColorWhateverShines) {
    Scene scene = solid_scene(24);
    scene.exposure = 1;
    scene.materials[0].kind = MaterialKind::unlit;
    const Image<Rgba8> picture = draw(scene).picture;
    EXPECT_NEAR(picture.at(2, 2).r, 188, 1);
    EXPECT_NEAR(picture.at(2, 2).b, 196, 1);
    EXPECT_NEAR(picture.at(40, 2).g, 188, 1);
}

// One grid for all: the second and third shader cull nothing of their own, and what the first one
// shades stays the bits it is.
TEST_F(KindsTest, KindsShareOneGrid) {
    const Scene plain = solid_scene(24);
    Scene mixed = plain;
    mixed.materials[2].kind = MaterialKind::toon;
    mixed.materials[3].kind = MaterialKind::unlit;
    const FrameResult before = draw(plain);
    const FrameResult after = draw(mixed);
    const auto count = [](const FrameResult& frame, const char* pass) {
        return std::count(frame.report.passes.begin(), frame.report.passes.end(), pass);
    };
    EXPECT_EQ(count(after, "light/tile cull"), 1);
    EXPECT_EQ(count(after, "light/forward"), 1);
    EXPECT_EQ(count(before, "light/forward"), 0);
    int same = 0, different = 0;
    for (std::size_t i = 0; i < before.picture.size(); ++i) {
        (before.picture.pixels()[i] == after.picture.pixels()[i] ? same : different) += 1;
    }
    EXPECT_GT(different, 200);
    // Post and cube are small.
    EXPECT_GT(same, kWidth * kHeight / 2);
    EXPECT_EQ(after.picture.at(20, 30), before.picture.at(20, 30));
}

TEST_F(KindsTest, KindsThatNoMeshShowsHaveNoPipeline) {
    Renderer own(device());
    Scene scene = solid_scene(24);
    scene.materials.push_back({.name = "spare", .kind = MaterialKind::toon});
    for (const std::uint32_t samples : {1u, 4u}) {
        const auto frame =
            own.render_to_image(scene, solid_view(kWidth, kHeight), {.samples = samples});
        ASSERT_TRUE(frame);
        EXPECT_THAT(own.pipelines().names(), Each(Not(HasSubstr("toon"))));
        EXPECT_THAT(own.pipelines().names(), Each(Not(HasSubstr("unlit"))));
    }
    scene.meshes[1].material = 5;
    ASSERT_TRUE(own.render_to_image(scene, solid_view(kWidth, kHeight), {}));
    EXPECT_THAT(own.pipelines().names(), Contains("light/forward toon"));
    EXPECT_THAT(own.pipelines().names(), Each(Not(HasSubstr("unlit"))));
}

// Kinds have shadows, too: a lamp's light behind the box is missing on a toon wall as on any.
TEST_F(KindsTest, ToonHasShadows) {
    Scene scene = solid_scene(0);
    scene.ambient = glm::vec3(0.1f);
    for (Material& material : scene.materials) {
        material.kind = MaterialKind::toon;
        material.steps = 16;
    }
    scene.lights = {{.kind = LightKind::point,
                     .position = {-0.7, 0.2, -1.2},
                     .color = glm::vec3(2.5f),
                     .radius_m = 6}};
    FrameOptions options;
    options.ray_shadows.half_resolution = false;
    const Image<Rgba8> open = draw(scene, options).picture;
    scene.lights[0].shadow = LightShadow::raycast;
    for (const std::uint32_t samples : {1u, 4u}) {
        options.samples = samples;
        const Image<Rgba8> shadowed = draw(scene, options).picture;
        int darker = 0, brighter = 0;
        for (std::size_t i = 0; i < open.size(); ++i) {
            darker += shadowed.pixels()[i].g + 20 < open.pixels()[i].g;
            brighter += samples == 1 && shadowed.pixels()[i].g > open.pixels()[i].g + 1;
        }
        EXPECT_GT(darker, 60) << samples;
        EXPECT_EQ(brighter, 0) << samples;
    }
}

}  // namespace
}  // namespace kino::test
