#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <glm/geometric.hpp>
#include <string>
#include <utility>

#include "tests/viz/viz_fixture.h"
#include "viz/quality/image_metrics.h"
#include "viz/quality/zoom/zoom_copy.h"
#include "viz/quality/zoom/zoom_view.h"
#include "viz/surface/mesh_shapes.h"

namespace kino::test {
namespace {

using ::testing::Contains;
using ::testing::Each;
using ::testing::Not;
using ::testing::StartsWith;

constexpr int kWidth = 101;  // divided by none of the zooms
constexpr int kHeight = 67;

View front_view(int width = kWidth, int height = kHeight) {
    return {.width = width,
            .height = height,
            .projection = perspective(0.8, width, height),
            .world_from_view = look_at({0, 0, 0}, {0, 0, -1})};
}

MeshNode box_at(const glm::vec3& size, const glm::dvec3& place, std::uint32_t material,
                std::uint32_t id) {
    MeshNode made{.id = id, .mesh = make_box(size), .material = material};
    made.world_from_object[3] = glm::dvec4(place, 1);
    made.previous_world_from_object = made.world_from_object;
    return made;
}

Scene boxes() {
    Scene scene;
    scene.color_mode = ColorMode::relit;
    scene.ambient = glm::vec3(0.4f);
    scene.materials.push_back({.name = "wall", .base_color = glm::vec3(0.4f, 0.4f, 0.5f)});
    scene.materials.push_back({.name = "box", .base_color = glm::vec3(0.9f, 0.3f, 0.1f)});
    scene.meshes.push_back(box_at({8, 8, 0.2f}, {0, 0, -3.1}, 1, 1));
    scene.meshes.push_back(box_at({0.5f, 0.5f, 0.5f}, {0.3, 0.2, -2}, 2, 2));
    scene.lights.push_back(
        {.kind = LightKind::point, .position = {0.5, 0.8, -1.2}, .color = glm::vec3(2)});
    return scene;
}

FrameResult draw(Renderer& renderer, const Scene& scene, const View& view,
                 const FrameOptions& options = {}) {
    auto frame = renderer.render_to_image(scene, view, options);
    EXPECT_TRUE(frame) << (frame ? "" : frame.error().to_string());
    return frame ? std::move(*frame) : FrameResult{};
}

FrameOptions zoomed(int z, ZoomBlur blur = ZoomBlur::none, ZoomPath path = ZoomPath::automatic) {
    FrameOptions options;
    options.zoom = {.z = z, .blur = blur, .path = path};
    return options;
}

Image<std::uint32_t> words(const Image<Rgba8>& picture) {
    Image<std::uint32_t> out(picture.width(), picture.height());
    std::memcpy(out.data(), picture.data(), out.size() * 4);
    return out;
}

int largest_step(const Image<Rgba8>& a, const Image<Rgba8>& b) {
    int most = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        const Rgba8 p = a.pixels()[i];
        const Rgba8 q = b.pixels()[i];
        most = std::max({most, std::abs(p.r - q.r), std::abs(p.g - q.g), std::abs(p.b - q.b)});
    }
    return most;
}

double psnr(const Image<Rgba8>& a, const Image<Rgba8>& b) {
    const auto difference = compare_images(a, b);
    return difference ? difference->psnr_db : 0;
}

class ZoomFrame : public VizTest {};

TEST_F(ZoomFrame, CostsNothingAtOneAndGivesBackWhatItTook) {
    Renderer renderer(device());
    const Scene scene = boxes();
    const FrameResult before = draw(renderer, scene, front_view());
    const auto pipelines = renderer.pipelines().names();
    const auto bytes = before.report.transient_bytes;
    EXPECT_EQ(renderer.zoom_bytes(), 0u);
    EXPECT_THAT(before.report.passes, Each(Not(StartsWith("zoom/"))));
    EXPECT_THAT(pipelines, Each(Not(StartsWith("zoom/"))));

    const FrameResult coarse = draw(renderer, scene, front_view(), zoomed(3));
    EXPECT_THAT(coarse.report.passes, Contains(StartsWith("zoom/")));
    EXPECT_LT(coarse.report.transient_bytes, bytes);

    const FrameResult after = draw(renderer, scene, front_view());
    EXPECT_EQ(after.picture, before.picture);
    EXPECT_EQ(after.report.passes, before.report.passes);
    EXPECT_EQ(after.report.transient_bytes, bytes);
    EXPECT_EQ(renderer.zoom_bytes(), 0u);
}

// The frame is what the small view shows, copied: nothing else changes with the zoom.
TEST_F(ZoomFrame, IsTheSmallViewEnlarged) {
    Renderer renderer(device());
    const Scene scene = boxes();
    for (const int z : {2, 3, 8}) {
        const FrameResult small = draw(renderer, scene, zoomed_view(front_view(), z));
        EXPECT_EQ(small.picture.width(), (kWidth + z - 1) / z);
        for (const ZoomBlur blur : {ZoomBlur::none, ZoomBlur::box, ZoomBlur::spline}) {
            Image<std::uint32_t> expected(kWidth, kHeight);
            const Image<std::uint32_t> from = words(small.picture);
            enlarge(from.view(), z, blur, expected.view());
            const FrameResult host =
                draw(renderer, scene, front_view(), zoomed(z, blur, ZoomPath::host));
            EXPECT_EQ(words(host.picture), expected) << z;
            // A device's filters weigh in steps of 1/256.
            const FrameResult pass =
                draw(renderer, scene, front_view(), zoomed(z, blur, ZoomPath::fragment));
            EXPECT_LE(largest_step(pass.picture, host.picture), blur == ZoomBlur::none ? 0 : 2)
                << z;
        }
    }
}

TEST_F(ZoomFrame, PictureSmallerThanItsZoom) {
    Renderer renderer(device());
    const Scene scene = boxes();
    for (const glm::ivec2 size : {glm::ivec2(1, 1), glm::ivec2(3, 5), glm::ivec2(7, 2)}) {
        const FrameResult frame = draw(renderer, scene, front_view(size.x, size.y), zoomed(8));
        EXPECT_EQ(frame.picture.width(), size.x);
        EXPECT_EQ(frame.picture.height(), size.y);
    }
}

TEST_F(ZoomFrame, OverlayIsDrawnAtFullSizeAfterTheCopy) {
    Renderer renderer(device());
    FrameOptions options = zoomed(4);
    std::uint32_t width = 0;
    options.overlay = [&](graph::FrameGraph& graph, graph::TextureId target) {
        width = graph.resources()[target.index].texture.width;
        graph.add_pass(
            "test/overlay", "overlay",
            [&](graph::PassBuilder& b) { target = b.write(target, graph::Use::color_attachment); },
            [](graph::PassContext&) {});
        return target;
    };
    const FrameResult frame = draw(renderer, boxes(), front_view(), options);
    EXPECT_EQ(width, static_cast<std::uint32_t>(kWidth));
    const auto& passes = frame.report.passes;
    const auto copy = std::find_if(passes.rbegin(), passes.rend(),
                                   [](const std::string& p) { return p.starts_with("zoom/"); });
    ASSERT_NE(copy, passes.rend());
    EXPECT_NE(std::find(copy.base(), passes.end(), "test/overlay"), passes.end());
}

// A turned camera's picture is a homography of what it drew: deflected pictures against drawn ones.
TEST_F(ZoomFrame, DeflectedPictureIsTheOneDrawnThere) {
    Renderer renderer(device());
    const Scene scene = boxes();
    const View old = front_view(160, 96);
    View now = old;
    now.world_from_view = look_at({0, 0, 0}, {std::sin(0.05), 0.01, -std::cos(0.05)});
    const FrameResult truth = draw(renderer, scene, now);
    const FrameResult before = draw(renderer, scene, old);
    const double undeflected = psnr(before.picture, truth.picture);
    for (const DeflectForm form :
         {DeflectForm::pan, DeflectForm::homography, DeflectForm::depth_warp}) {
        FrameOptions options;
        options.deflect = {.form = form, .guard_px = 16, .newest = [&] { return now; }};
        const FrameResult frame = draw(renderer, scene, old, options);
        EXPECT_GT(psnr(frame.picture, truth.picture), undeflected + 3);
        if (form != DeflectForm::pan) {
            EXPECT_GT(psnr(frame.picture, truth.picture), 35);
        }
        EXPECT_EQ(renderer.zoom_report().shown, now);
        EXPECT_EQ(renderer.zoom_report().clamped_px, 0);
        EXPECT_GT(renderer.zoom_bytes(), 0u);
    }
    // A pose that is none leaves the picture where it is.
    View wrong = now;
    wrong.world_from_view.rotation.w = std::nan("");
    FrameOptions options;
    options.deflect = {.guard_px = 5, .newest = [&] { return wrong; }};
    EXPECT_LE(largest_step(draw(renderer, scene, old, options).picture, before.picture), 2);
    // Without deflection everything is given back.
    EXPECT_EQ(draw(renderer, scene, old).picture, before.picture);
    EXPECT_EQ(renderer.zoom_bytes(), 0u);
}

TEST_F(ZoomFrame, DeflectionBeyondTheGuardBandIsCounted) {
    Renderer renderer(device());
    View now = front_view();
    now.projection.cx += 10;
    FrameOptions options;
    options.deflect = {.guard_px = 4, .newest = [&] { return now; }};
    draw(renderer, boxes(), front_view(), options);
    EXPECT_EQ(renderer.zoom_report().clamped_px, (10 - 4) * kHeight);
}

TEST_F(ZoomFrame, ProbeAndSurfaceAreOfTheSmallPicture) {
    Renderer renderer(device());
    const Scene scene = boxes();
    const int z = 3;
    FrameOptions options = zoomed(z);
    options.read_view_z = true;
    for (const glm::ivec2 at : {glm::ivec2(0, 0), glm::ivec2(60, 25), glm::ivec2(100, 66)}) {
        options.probe_px = at;
        const FrameResult frame = draw(renderer, scene, front_view(), options);
        ASSERT_EQ(frame.surface.view_z_m.width(), (kWidth + z - 1) / z);
        ASSERT_EQ(frame.surface.view_z_m.height(), (kHeight + z - 1) / z);
        ASSERT_TRUE(frame.depth_at_m.has_value());
        EXPECT_EQ(*frame.depth_at_m, frame.surface.view_z_m.at(at.x / z, at.y / z));
    }
}

// Hard case "z changes between frames": the rays of pixels, and of the picture's centre, stay.
TEST(ZoomView, RaysStayWhereTheyAreAtEveryZoom) {
    const View view{.width = 1279,
                    .height = 717,
                    .projection = {.fx = 900, .fy = 910, .cx = 512.3, .cy = 401.7}};
    const auto ray = [](const View& v, double x, double y) {
        const Projection& k = v.projection;
        return glm::normalize(glm::dvec3((x - k.cx) / k.fx, (y - k.cy) / k.fy, 1));
    };
    EXPECT_EQ(zoomed_view(view, 1), view);
    for (int z = 1; z <= kMaxZoom; ++z) {
        for (const int guard : {0, 5}) {
            const View small = zoomed_view(view, z, guard);
            EXPECT_EQ(small.width, (view.width + z - 1) / z + 2 * guard);
            EXPECT_EQ(small.height, (view.height + z - 1) / z + 2 * guard);
            // Position p of the small picture's plane covers z p + (z - 1) / 2 of the large one's.
            const auto place = [&](double full) { return (full - (z - 1) / 2.0) / z + guard; };
            for (const double x : {0.0, (view.width - 1) / 2.0, 1000.25}) {
                for (const double y : {0.0, (view.height - 1) / 2.0, 700.5}) {
                    EXPECT_LT(glm::distance(ray(view, x, y), ray(small, place(x), place(y))), 1e-6);
                }
            }
        }
    }
}

TEST(ZoomView, ZoomIsClampedToThePicture) {
    EXPECT_EQ(usable_zoom(0, 640, 480), 1);
    EXPECT_EQ(usable_zoom(-3, 640, 480), 1);
    EXPECT_EQ(usable_zoom(100, 640, 480), kMaxZoom);
    EXPECT_EQ(usable_zoom(4, 3, 480), 3);
    EXPECT_EQ(usable_zoom(8, 1, 1), 1);
}

}  // namespace
}  // namespace kino::test
