#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include "tests/scenes/depth_scene.h"
#include "tests/viz/forward/picture_test.h"
#include "viz/surface/mesh_shapes.h"

namespace kino::test {
namespace {

using ::testing::Each;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr int kWide = 256;
constexpr int kHigh = 192;
constexpr int kFiner = 8;  // along each side of the reference

using SupersamplingTest = PictureTest;

View enlarged(View view, int times) {
    view.width *= times;
    view.height *= times;
    Projection& k = view.projection;
    k.fx *= times;
    k.fy *= times;
    k.cx = (k.cx + 0.5f) * times - 0.5f;
    k.cy = (k.cy + 0.5f) * times - 0.5f;
    return view;
}

/// The mean of what is shown in each pixel's kFiner x kFiner ones, coded, 0 .. 255.
Image<glm::dvec3> averaged(const Image<Rgba8>& large) {
    Image<glm::dvec3> mean(large.width() / kFiner, large.height() / kFiner);
    for (int y = 0; y < mean.height(); ++y) {
        for (int x = 0; x < mean.width(); ++x) {
            glm::dvec3 sum(0);
            for (int k = 0; k < kFiner * kFiner; ++k) {
                const Rgba8 p = large.at(x * kFiner + k % kFiner, y * kFiner + k / kFiner);
                sum += glm::dvec3(linear_of(p.r), linear_of(p.g), linear_of(p.b));
            }
            for (int k = 0; k < 3; ++k) mean.at(x, y)[k] = coded_of(sum[k] / (kFiner * kFiner));
        }
    }
    return mean;
}

/// 1 where the pixels of `large` that make up one of the picture are not of one colour.
Image<std::uint8_t> mixed_pixels(const Image<Rgba8>& large) {
    Image<std::uint8_t> mixed(large.width() / kFiner, large.height() / kFiner);
    for (int y = 0; y < large.height(); ++y) {
        for (int x = 0; x < large.width(); ++x) {
            const int u = x / kFiner, v = y / kFiner;
            const glm::dvec3 first = numbers(large.at(u * kFiner, v * kFiner));
            if (largest(numbers(large.at(x, y)) - first) > 4) mixed.at(u, v) = 1;
        }
    }
    return mixed;
}

double mse(const Image<Rgba8>& got, const Image<glm::dvec3>& wanted,
           const Image<std::uint8_t>& counts) {
    double sum = 0, n = 0;
    for (std::size_t i = 0; i < got.size(); ++i) {
        if (counts.pixels()[i] == 0) continue;
        const glm::dvec3 d = numbers(got.pixels()[i]) - wanted.pixels()[i];
        sum += glm::dot(d, d) / 3;
        n += 1;
    }
    return sum / n;
}

FrameOptions edges_at(double r) {
    FrameOptions options{.lod = FramebufferLodOptions{.r = r}, .samples = 4};
    // What no coarse pixel saw is the third pass's business, with and without edges.
    if (r > 1) options.lod->fix_share = 0.05f;
    return options;
}

// The proof: nearly as near to 64 samples as shading four of them is, at every coarseness.
TEST_F(SupersamplingTest, EdgesAreNearlyThoseOfFourShadedSamples) {
    const View view = solid_view(kWide, kHigh);
    const Scene scene = solid_scene(12);
    const auto wanted = averaged(draw(scene, enlarged(view, kFiner), {}).picture);
    const auto edges = mixed_pixels(draw(flat(scene), enlarged(view, kFiner), {}).picture);
    const double four = mse(draw(scene, view, {.samples = 4}).picture, wanted, edges);
    const double one = mse(draw(scene, view, {}).picture, wanted, edges);
    EXPECT_GT(one, 5 * four);
    for (const double r : {1.0, 2.0, 4.0}) {
        const double got = mse(draw(scene, view, edges_at(r)).picture, wanted, edges);
        EXPECT_LE(got, 1.3 * four) << "r " << r;
        RecordProperty("r" + std::to_string(static_cast<int>(r)), std::to_string(got / four));
    }
}

// A pixel without an edge is the one-sample path's to the bit, coarse or not.
TEST_F(SupersamplingTest, OnlyEdgesChange) {
    const View view = solid_view(kWide, kHigh);
    for (const double r : {1.0, 3.0}) {
        const Scene scene = solid_scene(12);
        FrameOptions options = edges_at(r);
        const Image<Rgba8> four = draw(scene, view, options).picture;
        options.samples = 1;
        options.read_surface = true;
        const FrameResult one = draw(scene, view, options);
        // An edge: some sample's colour is not the centre's, or faces part nearby.
        const auto outlines = sample_pictures(flat(scene), view);
        const Image<Rgba8> centre = draw(flat(scene), view, {}).picture;
        int changed = 0, changed_inside = 0;
        for (int y = 0; y < kHigh; ++y) {
            for (int x = 0; x < kWide; ++x) {
                if (one.picture.at(x, y) == four.at(x, y)) continue;
                ++changed;
                bool edge = false;
                for (const auto& seen : outlines) edge = edge || seen.at(x, y) != centre.at(x, y);
                for (int k = 0; k < 9; ++k) {
                    const int u = std::clamp(x + k % 3 - 1, 0, kWide - 1);
                    const int v = std::clamp(y + k / 3 - 1, 0, kHigh - 1);
                    edge = edge || one.surface.normal.at(u, v) != one.surface.normal.at(x, y);
                }
                changed_inside += !edge;
            }
        }
        EXPECT_GT(changed, 500);
        EXPECT_EQ(changed_inside, 0);
    }
}

TEST_F(SupersamplingTest, OneSampleCostsNothing) {
    const View view = solid_view(80, 56);
    Renderer own(device());
    const Scene scene = solid_scene(12);
    auto frame = own.render_to_image(scene, view, {.lod = FramebufferLodOptions{.r = 1}});
    ASSERT_TRUE(frame);
    for (const char* word : {"sample", "edges"}) {
        EXPECT_THAT(frame->report.passes, Each(Not(HasSubstr(word))));
        EXPECT_THAT(own.pipelines().names(), Each(Not(HasSubstr(word))));
    }
    // Nor do four where there is no mesh, or none in sight.
    Scene empty = scene;
    for (const bool away : {false, true}) {
        if (away) {
            empty.meshes.resize(1);
            empty.meshes[0] = scene.meshes[1];
            empty.meshes[0].world_from_object[3] = {0, 0, 9, 1};
        } else {
            empty.meshes.clear();
        }
        const auto before = own.render_to_image(empty, view, {.lod = FramebufferLodOptions{}});
        const auto after =
            own.render_to_image(empty, view, {.lod = FramebufferLodOptions{}, .samples = 4});
        ASSERT_TRUE(before && after);
        EXPECT_EQ(after->report.passes, before->report.passes);
        EXPECT_EQ(after->report.transient_bytes, before->report.transient_bytes);
    }
}

// Whatever shades a pixel, its edge is the mean of what the samples see; glass is drawn over it.
TEST_F(SupersamplingTest, EveryKindHasSmoothEdges) {
    const View view = solid_view(kWide, kHigh);
    Scene scene = solid_scene(12);
    scene.exposure = 1;
    scene.materials[1].kind = MaterialKind::unlit;
    scene.materials[2].kind = MaterialKind::toon;
    scene.materials[3].emission = {0.1f, 0.5f, 4.0f};
    const auto wanted = mean_coded(sample_pictures(scene, view));
    const auto outlines = sample_pictures(flat(scene), view);
    for (const double r : {1.0, 2.0}) {
        const Image<Rgba8> one = draw(scene, view, {.lod = edges_at(r).lod}).picture;
        const Image<Rgba8> four = draw(scene, view, edges_at(r)).picture;
        double off_one = 0, off_four = 0;
        for (std::size_t i = 0; i < wanted.size(); ++i) {
            bool edge = false;
            for (const auto& seen : outlines) {
                edge = edge || seen.pixels()[i] != outlines[0].pixels()[i];
            }
            if (!edge) continue;
            const glm::dvec3 a = numbers(one.pixels()[i]) - wanted[i];
            const glm::dvec3 b = numbers(four.pixels()[i]) - wanted[i];
            off_one += glm::dot(a, a);
            off_four += glm::dot(b, b);
        }
        EXPECT_LT(off_four, 0.05 * off_one) << r;
    }
    scene.materials[3].opacity = 0.4f;
    const Image<Rgba8> glass = draw(scene, view, edges_at(1)).picture;
    const Image<Rgba8> plain = draw(scene, view, {.lod = FramebufferLodOptions{.r = 1}}).picture;
    int changed = 0;
    for (std::size_t i = 0; i < glass.size(); ++i) {
        changed += glass.pixels()[i] != plain.pixels()[i];
    }
    EXPECT_GT(changed, 200);
    EXPECT_LT(changed, kWide * kHigh / 20);
}

// A gradient behind a mesh: not stored for every sample, made again where an edge shows it.
TEST_F(SupersamplingTest, EdgesAgainstTheSky) {
    const View view = solid_view(96, 72);
    Scene scene = flat(solid_scene(0));
    scene.meshes.erase(scene.meshes.begin());
    scene.background_top = {0.1f, 0.3f, 0.9f};
    scene.background_bottom = {0.9f, 0.8f, 0.2f};
    const auto wanted = mean_coded(sample_pictures(scene, view));
    const Image<Rgba8> got = draw(scene, view, edges_at(1)).picture;
    const Image<Rgba8> one = draw(scene, view, {}).picture;
    int off = 0, changed = 0;
    for (std::size_t i = 0; i < wanted.size(); ++i) {
        off += largest(numbers(got.pixels()[i]) - wanted[i]) > 3;
        changed += largest(numbers(got.pixels()[i]) - numbers(one.pixels()[i])) > 8;
    }
    EXPECT_GT(changed, 150);
    EXPECT_LE(off, 6);
}

// Between a mesh and the live frame: the mesh's share of samples of its colour, and of the live
// frame's the rest.
TEST_F(SupersamplingTest, EdgesBeforeTheLiveFrame) {
    auto loaded = load_recording("recordings/desk");
    ASSERT_TRUE(loaded);
    Scene scene = std::move(loaded->scene);
    scene.color_mode = ColorMode::captured;
    const View view = sensor_view(loaded->rig.depth, scene.live->world_from_depth, 120, 90);
    scene.materials = {
        {.name = "plate", .base_color = {0.05f, 0.8f, 0.1f}, .kind = MaterialKind::unlit},
        {.name = "behind", .base_color = {0.9f, 0.1f, 0.1f}, .kind = MaterialKind::unlit}};
    // Behind all that is live: seen through its holes alone.
    MeshNode behind{.id = 2, .mesh = make_box({90, 90, 0.1f}), .material = 2};
    behind.world_from_object =
        (scene.live->world_from_depth * Pose{.rotation = {1, 0, 0, 0}, .translation = {0, 0, 20}})
            .matrix();
    behind.previous_world_from_object = behind.world_from_object;
    scene.meshes = {behind};
    const Image<Rgba8> live = draw(scene, view, {}).picture;
    MeshNode plate{.id = 1, .mesh = make_box({0.16f, 0.11f, 0.001f}), .material = 1};
    plate.world_from_object = glm::rotate(
        (scene.live->world_from_depth * Pose{.rotation = {1, 0, 0, 0}, .translation = {0, 0, 0.3}})
            .matrix(),
        0.4, glm::dvec3(0, 0, 1));
    plate.previous_world_from_object = plate.world_from_object;
    scene.meshes = {plate, behind};
    Scene alone = scene;
    alone.meshes = {plate};
    alone.live.reset();
    const auto outlines = sample_pictures(alone, view);
    const Image<Rgba8> got = draw(scene, view, edges_at(1)).picture;
    const Rgba8 green = draw(alone, view, {}).picture.at(60, 45);
    int mixed = 0, off = 0;
    for (std::size_t i = 0; i < got.size(); ++i) {
        glm::dvec3 sum(0);
        int covered = 0;
        for (const auto& seen : outlines) {
            const bool in = largest(numbers(seen.pixels()[i]) - numbers(green)) < 4;
            covered += in;
            const Rgba8 c = in ? green : live.pixels()[i];
            sum += glm::dvec3(linear_of(c.r), linear_of(c.g), linear_of(c.b)) / 4.0;
        }
        mixed += covered % 4 != 0;
        const glm::dvec3 want(coded_of(sum.r), coded_of(sum.g), coded_of(sum.b));
        off += largest(numbers(got.pixels()[i]) - want) > 3;
    }
    EXPECT_GT(mixed, 80);
    EXPECT_LE(off, mixed / 20);
}

}  // namespace
}  // namespace kino::test
