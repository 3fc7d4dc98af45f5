#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/viz/forward/picture_test.h"

namespace kino::test {
namespace {

using ::testing::Contains;
using ::testing::Each;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr int kWide = 80;
constexpr int kHigh = 56;

using MultisampleTest = PictureTest;

// The law of the pass: a pixel is the mean of what its four samples see.
TEST_F(MultisampleTest, PictureIsTheMeanOfFourPictures) {
    const View view = solid_view(kWide, kHigh);
    for (const int lights : {0, 6, 24}) {
        const Scene scene = solid_scene(lights);
        const auto pictures = sample_pictures(scene, view);
        const auto outlines = sample_pictures(flat(scene), view);
        const auto wanted = mean_coded(pictures);
        const Image<Rgba8> once = draw(scene, view, {}).picture;
        const Image<Rgba8> got = draw(scene, view, {.samples = 4}).picture;
        int edges = 0, changed = 0, off = 0;
        double inside = 0;
        for (std::size_t i = 0; i < got.size(); ++i) {
            bool edge = false;
            for (std::size_t s = 1; s < 4; ++s) {
                for (const auto* seen : {&outlines, &pictures}) {
                    edge = edge || largest(numbers((*seen)[s].pixels()[i]) -
                                           numbers((*seen)[0].pixels()[i])) > 4;
                }
            }
            const glm::dvec3 p = numbers(got.pixels()[i]);
            if (edge) {
                ++edges;
                off += largest(p - wanted[i]) > 2;
                changed += largest(p - numbers(once.pixels()[i])) > 8;
            } else {
                inside = std::max(inside, largest(p - numbers(once.pixels()[i])));
            }
        }
        // The picture has edges, and they look different with one sample.
        EXPECT_GT(edges, 150) << lights;
        EXPECT_GT(changed, edges / 3) << lights;
        // Corners lie on a grid of 1/256 px; once in a while one falls to the other side of a
        // sample where the camera has moved by one.
        EXPECT_LE(off, edges / 100) << lights;
        EXPECT_LE(inside, 1) << lights;
    }
}

// A sample a thousand times as bright as white must not keep its edge white and stepped.
TEST_F(MultisampleTest, BrightEdgesAreSmoothWhereTheyAreShown) {
    const View view = solid_view(kWide, kHigh);
    Scene scene = flat(solid_scene(0));
    scene.materials[1].base_color = glm::vec3(60);
    const auto wanted = mean_coded(sample_pictures(scene, view));
    const Image<Rgba8> shown = draw(scene, view, {.samples = 4}).picture;
    const Image<Rgba8> linear =
        draw(scene, view, {.samples = 4, .resolve = SampleResolve::linear}).picture;
    double off_shown = 0, off_linear = 0;
    for (std::size_t i = 0; i < wanted.size(); ++i) {
        off_shown = std::max(off_shown, largest(numbers(shown.pixels()[i]) - wanted[i]));
        off_linear = std::max(off_linear, largest(numbers(linear.pixels()[i]) - wanted[i]));
    }
    EXPECT_LE(off_shown, 2);
    EXPECT_GT(off_linear, 40);
}

// Tiles whose pixel centres show the wall alone have lights in their lists that only a sample of
// the post needs: with lists (nine lights) the picture is that without (eight), bit by bit.
TEST_F(MultisampleTest, ListsCountEverySample) {
    const View view = solid_view(kWide, kHigh);
    Scene scene = solid_scene(0);
    scene.ambient = glm::vec3(0);
    for (int i = 0; i < 8; ++i) {
        scene.lights.push_back({.kind = LightKind::point,
                                .position = {0.15, -1.0 + 0.25 * i, -2.2},
                                .color = glm::vec3(0.02f),
                                .radius_m = 0.4f});
    }
    const Image<Rgba8> all = draw(scene, view, {.samples = 4}).picture;
    scene.lights.push_back({.kind = LightKind::point, .position = {0, 0, 40}, .radius_m = 0.1f});
    for (const std::uint32_t tile_px : {8u, 16u, 32u}) {
        FrameOptions options{.samples = 4};
        options.light_lists.tile_px = tile_px;
        const FrameResult lists = draw(scene, view, options);
        EXPECT_THAT(lists.report.passes, Contains("light/tile cull"));
        EXPECT_TRUE(std::ranges::equal(lists.picture.pixels(), all.pixels())) << tile_px;
    }
}

TEST_F(MultisampleTest, OneSampleCostsNothing) {
    const View view = solid_view(kWide, kHigh);
    Renderer own(device());
    auto frame = own.render_to_image(solid_scene(24), view, {});
    ASSERT_TRUE(frame);
    EXPECT_THAT(frame->report.passes, Each(Not(HasSubstr("sample"))));
    EXPECT_THAT(frame->report.passes, Not(Contains(HasSubstr("forward"))));
    EXPECT_THAT(own.pipelines().names(), Each(Not(HasSubstr("sample"))));
    EXPECT_THAT(own.pipelines().names(), Not(Contains(HasSubstr("forward"))));
    // Nor do four where there is no mesh.
    Scene empty = solid_scene(24);
    empty.meshes.clear();
    const auto before = own.render_to_image(empty, view, {});
    const auto after = own.render_to_image(empty, view, {.samples = 4});
    ASSERT_TRUE(before && after);
    EXPECT_EQ(after->report.passes, before->report.passes);
    EXPECT_EQ(after->report.transient_bytes, before->report.transient_bytes);
}

// Four samples of colour and depth, their depths once more, the ground's light and the depths it is
// drawn over.
TEST_F(MultisampleTest, MemoryIsThatOfItsTargets) {
    const View view = solid_view(kWide, kHigh);
    const FrameResult one = draw(solid_scene(0), view, {});
    const FrameResult four = draw(solid_scene(0), view, {.samples = 4});
    const std::uint64_t pixels = kWide * kHigh;
    EXPECT_GE(four.report.transient_bytes, pixels * 4 * (8 + 4));
    EXPECT_LE(four.report.transient_bytes,
              one.report.transient_bytes + pixels * (4 * (8 + 4 + 4) + 8 + 4));
}

TEST_F(MultisampleTest, GlassHasSmoothEdgesToo) {
    const View view = solid_view(kWide, kHigh);
    Scene scene = solid_scene(12);
    scene.materials[3].opacity = 0.4f;
    const auto wanted = mean_coded(sample_pictures(scene, view));
    const Image<Rgba8> got = draw(scene, view, {.samples = 4}).picture;
    int off = 0;
    for (std::size_t i = 0; i < wanted.size(); ++i) {
        off += largest(numbers(got.pixels()[i]) - wanted[i]) > 4;
    }
    EXPECT_LE(off, 3);
}

// Rays are cast from pixel centres: only the rims of shadows and of things may differ.
TEST_F(MultisampleTest, ShadowsAreThoseOfTheDirectPicture) {
    const View view = solid_view(kWide, kHigh);
    Scene scene = solid_scene(12);
    for (Light& light : scene.lights) light.shadow = LightShadow::raycast;
    FrameOptions options;
    options.ray_shadows.half_resolution = false;
    const Image<Rgba8> once = draw(scene, view, options).picture;
    const Image<Rgba8> unshadowed = draw(solid_scene(12), view, options).picture;
    const auto outlines = sample_pictures(flat(scene), view);
    options.samples = 4;
    const Image<Rgba8> four = draw(scene, view, options).picture;
    int shadowed = 0, off = 0, inside = 0;
    for (std::size_t i = 0; i < once.size(); ++i) {
        bool edge = false;
        for (std::size_t s = 1; s < 4; ++s) {
            edge = edge || outlines[s].pixels()[i] != outlines[0].pixels()[i];
        }
        shadowed += largest(numbers(once.pixels()[i]) - numbers(unshadowed.pixels()[i])) > 8;
        if (edge) continue;
        ++inside;
        off += largest(numbers(once.pixels()[i]) - numbers(four.pixels()[i])) > 2;
    }
    EXPECT_GT(shadowed, 100);
    EXPECT_LE(off, inside / 50);
}

}  // namespace
}  // namespace kino::test
