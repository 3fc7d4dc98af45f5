#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/scenes/depth_scene.h"
#include "tests/scenes/raster_scenes.h"
#include "viz_fixture.h"

namespace kino::test {
namespace {

CameraModel small_camera() {
    return {.width = 160, .height = 120, .fx = 142.8, .fy = 142.8, .cx = 79.5, .cy = 59.5};
}

LiveDepth test_scene(DepthStyle style) {
    const CameraModel camera = small_camera();
    LiveDepth live;
    live.surface = make_surface(
        camera, [&](int x, int y) { return test_depth(camera, x, y); }, test_color);
    live.world_from_depth = world_from_camera_axes();
    live.style = style;
    live.fill_holes = false;
    return live;
}

class RasterTest : public VizTest {
  protected:
    RasterTest() : renderer(device()) {}

    /// `ids`: with ids and normals; else as for the screen, where keys carry colours.
    FrameResult draw(const LiveDepth& live, const View& view, RasterPath path, bool ids = true) {
        Scene scene;
        scene.live = live;
        FrameOptions options;
        options.raster = path;
        options.read_surface = ids;
        options.read_view_z = true;
        auto result = renderer.render_to_image(scene, view, options);
        EXPECT_TRUE(result) << (result ? "" : result.error().to_string());
        return result ? std::move(*result) : FrameResult{};
    }

    Renderer renderer;
};

// Agreement: of the union of covered pixels, those with the same id, or depth within 1 mm and
// colour within 2/255.
TEST_F(RasterTest, EveryPathAgreesWithTheDoubleReferenceInEveryView) {
    for (const DepthStyle style : {DepthStyle::cloud, DepthStyle::mesh}) {
        const LiveDepth live = test_scene(style);
        for (const NamedView& named : standard_views(live, small_camera(), 320, 180)) {
            const auto reference = reference_picture(live, named.view);
            for (const RasterPath path :
                 {RasterPath::compute, RasterPath::compute_32bit, RasterPath::hardware}) {
                SCOPED_TRACE(named.name + (style == DepthStyle::mesh ? " mesh" : " cloud") +
                             " path " + std::to_string(static_cast<int>(path)));
                const Agreement agreement =
                    compare_with_reference(draw(live, named.view, path), reference);
                EXPECT_GT(agreement.reference_px, 500);
                // Fixed-function rasterisers snap to 1/256 px, so up to one in 256 points an axis
                // lands in the neighbouring pixel: 0.8 %. The compute paths do not snap.
                EXPECT_GE(agreement.share(), path == RasterPath::hardware ? 0.99 : 0.995);
                EXPECT_GE(agreement.coverage(), 0.98);
            }
        }
    }
}

TEST_F(RasterTest, KeysThatCarryColoursAgreeToo) {
    for (const DepthStyle style : {DepthStyle::cloud, DepthStyle::mesh}) {
        const LiveDepth live = test_scene(style);
        for (const NamedView& named : standard_views(live, small_camera(), 320, 180)) {
            for (const RasterPath path : {RasterPath::compute, RasterPath::compute_32bit}) {
                const Agreement agreement = compare_with_reference(
                    draw(live, named.view, path, false), reference_picture(live, named.view));
                EXPECT_GE(agreement.share(), 0.995) << named.name;
                EXPECT_GE(agreement.coverage(), 0.98) << named.name;
            }
        }
    }
}

TEST_F(RasterTest, FixedEdgeRuleAgreesToo) {
    LiveDepth live = test_scene(DepthStyle::mesh);
    live.edge_rule = EdgeRule::fixed;
    const NamedView orbit = standard_views(live, small_camera(), 320, 180)[1];
    const auto reference = reference_picture(live, orbit.view);
    const Agreement agreement =
        compare_with_reference(draw(live, orbit.view, RasterPath::compute), reference);
    EXPECT_GE(agreement.share(), 0.995);
}

TEST_F(RasterTest, KeysOf32BitsGiveTheVerySamePicture) {
    for (const DepthStyle style : {DepthStyle::cloud, DepthStyle::mesh}) {
        LiveDepth live = test_scene(style);
        live.splat_cap_px = 3;
        for (const NamedView& named : standard_views(live, small_camera(), 320, 180)) {
            const FrameResult a = draw(live, named.view, RasterPath::compute);
            const FrameResult b = draw(live, named.view, RasterPath::compute_32bit);
            EXPECT_EQ(a.surface.id, b.surface.id) << named.name;
            EXPECT_EQ(a.surface.view_z_m, b.surface.view_z_m) << named.name;
            EXPECT_EQ(a.picture, b.picture) << named.name;
        }
    }
}

TEST_F(RasterTest, DrawingTwiceIsBitIdentical) {
    const LiveDepth live = test_scene(DepthStyle::mesh);
    const View view = standard_views(live, small_camera(), 320, 180)[1].view;
    const FrameResult a = draw(live, view, RasterPath::compute);
    const FrameResult b = draw(live, view, RasterPath::compute);
    EXPECT_EQ(a.picture, b.picture);
    EXPECT_EQ(a.surface.id, b.surface.id);
}

// No reading is no surface: pixels without depth are never the winner, and no triangle has one.
TEST_F(RasterTest, PixelsWithoutAReadingAreNeverDrawn) {
    for (const RasterPath path : {RasterPath::compute, RasterPath::hardware}) {
        LiveDepth live = test_scene(DepthStyle::cloud);
        const FrameResult cloud =
            draw(live, sensor_view(small_camera(), live.world_from_depth, 320, 240), path);
        for (const std::uint32_t id : cloud.surface.id.pixels()) {
            if (id == UINT32_MAX) continue;
            ASSERT_GT(live.surface->depth_m.pixels()[id], 0.0f);
        }
        live = test_scene(DepthStyle::mesh);
        const FrameResult mesh =
            draw(live, sensor_view(small_camera(), live.world_from_depth, 320, 240), path);
        for (const std::uint32_t id : mesh.surface.id.pixels()) {
            if (id == UINT32_MAX) continue;
            const std::uint32_t cell = id / 2;
            const std::uint32_t corner = cell / 159 * 160 + cell % 159;
            const std::uint32_t third = id % 2 == 0 ? corner : corner + 161;
            for (const std::uint32_t vertex : {corner + 1, corner + 160, third}) {
                ASSERT_GT(live.surface->depth_m.pixels()[vertex], 0.0f);
            }
        }
    }
}

TEST_F(RasterTest, NanAndInfiniteDepthDrawNothingAndHarmNothing) {
    const CameraModel camera = small_camera();
    LiveDepth live = test_scene(DepthStyle::mesh);
    auto broken = std::make_shared<DepthSurface>(*live.surface);
    for (std::size_t i = 0; i < broken->depth_m.size(); i += 7) {
        broken->depth_m.pixels()[i] = i % 2 == 0 ? std::numeric_limits<float>::quiet_NaN()
                                                 : std::numeric_limits<float>::infinity();
    }
    broken->version = next_version();
    live.surface = broken;
    for (const DepthStyle style : {DepthStyle::cloud, DepthStyle::mesh}) {
        live.style = style;
        const FrameResult frame =
            draw(live, sensor_view(camera, live.world_from_depth, 320, 240), RasterPath::compute);
        for (const float z : frame.surface.view_z_m.pixels()) ASSERT_TRUE(std::isfinite(z));
    }
}

/// `live` with readings within the rectangle alone.
LiveDepth cut_to(const LiveDepth& live, int x0, int y0, int x1, int y1) {
    LiveDepth cut = live;
    auto surface = std::make_shared<DepthSurface>(*live.surface);
    for (int y = 0; y < surface->depth_m.height(); ++y) {
        for (int x = 0; x < surface->depth_m.width(); ++x) {
            if (x < x0 || x >= x1 || y < y0 || y >= y1) surface->depth_m.at(x, y) = 0;
        }
    }
    surface->version = next_version();
    cut.surface = surface;
    return cut;
}

constexpr int kCutParts[][4] = {{70, 40, 101, 90},    {0, 0, 160, 1},     {63, 15, 65, 17},
                                {159, 119, 160, 120}, {1, 100, 140, 119}, {20, 20, 20, 20}};

// Of a frame that is mostly empty only the part with readings is walked and resolved. Two readings
// 1 mm before the sensor, in opposite corners, belong to no triangle and make it the whole frame.
TEST_F(RasterTest, MeshOfACutOutFrameIsDrawnAsInTheWholeOne) {
    const LiveDepth live = test_scene(DepthStyle::mesh);
    for (const auto& part : kCutParts) {
        const LiveDepth cut = cut_to(live, part[0], part[1], part[2], part[3]);
        LiveDepth whole = cut;
        auto surface = std::make_shared<DepthSurface>(*cut.surface);
        for (const std::size_t corner : {std::size_t{0}, surface->depth_m.size() - 1}) {
            float& z = surface->depth_m.pixels()[corner];
            if (z == 0) z = 1e-3f;
        }
        surface->version = next_version();
        whole.surface = surface;
        for (const NamedView& named : standard_views(live, small_camera(), 320, 180)) {
            for (const bool ids : {false, true}) {
                SCOPED_TRACE(named.name + " from column " + std::to_string(part[0]));
                const FrameResult a = draw(cut, named.view, RasterPath::compute, ids);
                const FrameResult b = draw(whole, named.view, RasterPath::compute, ids);
                EXPECT_EQ(a.picture, b.picture);
                EXPECT_EQ(a.surface.view_z_m, b.surface.view_z_m);
                EXPECT_EQ(a.surface.id, b.surface.id);
                EXPECT_EQ(a.surface.normal, b.surface.normal);
            }
        }
    }
}

TEST_F(RasterTest, CloudOfACutOutFrameAgreesWithTheReference) {
    LiveDepth live = test_scene(DepthStyle::cloud);
    for (const auto& part : kCutParts) {
        const LiveDepth cut = cut_to(live, part[0], part[1], part[2], part[3]);
        for (const NamedView& named : standard_views(live, small_camera(), 320, 180)) {
            SCOPED_TRACE(named.name + " from column " + std::to_string(part[0]));
            const Agreement agreement = compare_with_reference(
                draw(cut, named.view, RasterPath::compute), reference_picture(cut, named.view));
            if (agreement.reference_px == 0) continue;
            EXPECT_GE(agreement.share(), 0.995);
            EXPECT_GE(agreement.coverage(), 0.98);
        }
    }
}

// T(z) = 3 * 0.00307 z^2 + tan(80 deg) z / f: 29 mm at 1 m, 227 mm at 4 m with the Kinect's focal
// length. Two half walls, one a step behind the other: joined below T, torn above.
TEST_F(RasterTest, StepsAreBridgedBelowTheEdgeLimitAndTornAboveIt) {
    CameraModel camera = small_camera();
    camera.fx = camera.fy = 571.26;
    // The limits as numbers, so that a wrong constant in the shader cannot hide in the test.
    for (const auto& [range, limit] :
         {std::pair{0.8, 0.013837}, {1.0, 0.019138}, {2.0, 0.056695}, {4.0, 0.187070}}) {
        for (const double factor : {0.97, 1.03}) {
            LiveDepth live;
            live.surface = make_surface(
                camera,
                [&, r = range, t = limit](int x, int) { return x < 80 ? r : r + factor * t; },
                test_color);
            live.world_from_depth = world_from_camera_axes();
            live.style = DepthStyle::mesh;
            // From the side the riser would face the camera.
            const View view{
                .width = 320,
                .height = 240,
                .projection = perspective(0.25, 320, 240),
                .world_from_view = look_at({0.6 * range, 0, -0.2 * range}, {0, 0, -range})};
            const FrameResult frame = draw(live, view, RasterPath::compute);
            bool riser = false;
            for (const std::uint32_t id : frame.surface.id.pixels()) {
                riser = riser || (id != UINT32_MAX && (id / 2) % 159 == 79);
            }
            EXPECT_EQ(riser, factor < 1) << "range " << range << " step " << factor << " T";
        }
    }
}

TEST_F(RasterTest, RoomFarFromTheOriginDrawsTheSamePicture) {
    LiveDepth live = test_scene(DepthStyle::mesh);
    const View near_view = standard_views(live, small_camera(), 320, 180)[1].view;
    const FrameResult near_frame = draw(live, near_view, RasterPath::compute);
    const glm::dvec3 far(1e4, -2e3, 3e4);
    live.world_from_depth.translation += far;
    View far_view = near_view;
    far_view.world_from_view.translation += far;
    const FrameResult far_frame = draw(live, far_view, RasterPath::compute);
    std::int64_t different = 0;
    for (std::size_t i = 0; i < near_frame.picture.size(); ++i) {
        different += !(near_frame.picture.pixels()[i] == far_frame.picture.pixels()[i]);
    }
    // Double keeps 1e-11 m there; what is left is a last bit of float in the composed pose.
    EXPECT_LE(different, static_cast<std::int64_t>(near_frame.picture.size() / 1000));
}

TEST_F(RasterTest, SplatsAreSquaresOfTheFootprint) {
    // One point, 2 m ahead, seen from 1 m and from 0.25 m: 1 px at the sensor, so 2 and 8 px wide.
    CameraModel camera = small_camera();
    LiveDepth live;
    live.surface = make_surface(
        camera, [](int x, int y) { return x == 80 && y == 60 ? 2.0 : 0.0; }, test_color);
    live.world_from_depth = world_from_camera_axes();
    live.style = DepthStyle::cloud;
    live.fill_holes = false;
    for (const auto& [distance, cap, width] : {std::tuple{1.0, 8, 2}, std::tuple{0.25, 8, 8},
                                               std::tuple{0.25, 3, 3}, std::tuple{1.0, 1, 1}}) {
        live.splat_cap_px = cap;
        View view = sensor_view(camera, live.world_from_depth, 160, 120);
        view.world_from_view = live.world_from_depth * Pose{{1, 0, 0, 0}, {0, 0, 2.0 - distance}};
        const FrameResult frame = draw(live, view, RasterPath::compute);
        std::int64_t covered = 0;
        for (const float z : frame.surface.view_z_m.pixels()) {
            if (!(z > 0)) continue;
            ++covered;
            EXPECT_NEAR(z, distance, 1e-6);
        }
        EXPECT_EQ(covered, width * width) << distance << " m, cap " << cap;
    }
}

TEST_F(RasterTest, HolesInsideAreFilledAndTheOutlineStays) {
    CameraModel camera = small_camera();
    LiveDepth live;
    // A square of points with one missing in the middle.
    live.surface = make_surface(
        camera,
        [](int x, int y) {
            const bool square = x >= 40 && x < 80 && y >= 40 && y < 80;
            return square && !(x == 60 && y == 60) ? 1.5 : 0.0;
        },
        test_color);
    live.world_from_depth = world_from_camera_axes();
    live.style = DepthStyle::cloud;
    const View view = sensor_view(camera, live.world_from_depth, 160, 120);
    const auto count = [&](bool fill) {
        live.fill_holes = fill;
        const FrameResult frame = draw(live, view, RasterPath::compute);
        std::int64_t covered = 0;
        for (const float z : frame.surface.view_z_m.pixels()) covered += z > 0;
        return covered;
    };
    EXPECT_EQ(count(false), 40 * 40 - 1);
    EXPECT_EQ(count(true), 40 * 40);
}

// Normals of a 45-degree plane with the sensor's real quantisation: mean error below 3 degrees at
// 2 m and 8 degrees at 4 m.
TEST_F(RasterTest, NormalsOfAQuantisedPlane) {
    const CameraModel camera = {
        .width = 320, .height = 240, .fx = 571.26, .fy = 571.26, .cx = 159.5, .cy = 119.5};
    for (const auto& [range, bound_deg] : {std::pair{2.0, 3.0}, std::pair{4.0, 8.0}}) {
        LiveDepth live;
        live.surface = make_surface(
            camera,
            [&, r = range](int x, int) {
                // Plane Z = r + X: 1/z = (1 - rx) / r, quantised in steps of 0.00307 / m.
                const double rx = (x - camera.cx) / camera.fx;
                return 1.0 / (std::round((1 - rx) / r / 0.00307) * 0.00307);
            },
            test_color);
        live.world_from_depth = world_from_camera_axes();
        live.style = DepthStyle::cloud;
        const FrameResult frame =
            draw(live, sensor_view(camera, live.world_from_depth, 320, 240), RasterPath::compute);
        const glm::dvec3 truth = glm::normalize(glm::dvec3(1, 0, -1));
        double sum = 0;
        int count = 0;
        for (int y = 20; y < 220; ++y) {
            for (int x = 20; x < 300; ++x) {
                const std::uint32_t bits = frame.surface.normal.at(x, y);
                const double ox = static_cast<std::int16_t>(bits & 0xFFFF) / 32767.0;
                const double oy = static_cast<std::int16_t>(bits >> 16) / 32767.0;
                glm::dvec3 n(ox, oy, 1 - std::abs(ox) - std::abs(oy));
                const double fold = std::max(-n.z, 0.0);
                n.x += n.x >= 0 ? -fold : fold;
                n.y += n.y >= 0 ? -fold : fold;
                sum += glm::degrees(
                    std::acos(std::clamp(glm::dot(glm::normalize(n), truth), -1.0, 1.0)));
                ++count;
            }
        }
        EXPECT_LT(sum / count, bound_deg) << range << " m";
        RecordProperty("mean_error_deg_at_" + std::to_string(int(range)) + "m",
                       std::to_string(sum / count));
    }
}

}  // namespace
}  // namespace kino::test
