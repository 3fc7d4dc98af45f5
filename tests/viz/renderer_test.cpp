#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/scenes/depth_scene.h"
#include "tests/scenes/raster_scenes.h"
#include "tests/support/golden.h"
#include "viz_fixture.h"

namespace kino::test {
namespace {

using ::testing::AnyOf;
using ::testing::Each;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::StartsWith;

Scene recorded(const std::string& name, std::int64_t frame = 0) {
    auto loaded = load_recording("recordings/" + name, frame);
    EXPECT_TRUE(loaded) << (loaded ? "" : loaded.error().to_string());
    return loaded ? std::move(loaded->scene) : Scene{};
}

RigParameters rig_of(const std::string& name) {
    return load_recording("recordings/" + name).value().rig;
}

View orbit_view(const Scene& scene, int width, int height) {
    const Pose& wfd = scene.live->world_from_depth;
    return {
        .width = width,
        .height = height,
        .projection = perspective(0.9, width, height),
        .world_from_view = look_at(wfd * glm::dvec3(0.5, -0.3, 0.1), wfd * glm::dvec3(0, 0, 2.2),
                                   wfd.rotation * glm::dvec3(0, -1, 0))};
}

BodyNode standing_body() {
    BodyNode node{.id = 1, .world_from_depth = world_from_camera_axes()};
    for (std::size_t j = 0; j < kJointCount; ++j) {
        node.body.joints[j] = {.position_m = {0.1f * static_cast<float>(j % 5) - 0.2f,
                                              0.12f * static_cast<float>(j / 5) - 0.2f, 2.0f},
                               .state = JointState::tracked,
                               .confidence = 1};
    }
    return node;
}

FrameResult draw(Renderer& renderer, const Scene& scene, const View& view,
                 FrameOptions options = {}) {
    auto frame = renderer.render_to_image(scene, view, options);
    EXPECT_TRUE(frame) << (frame ? "" : frame.error().to_string());
    return frame ? std::move(*frame) : FrameResult{};
}

// With no virtual light the sensor's own view is the camera's picture: within 1/255 wherever there
// is depth and the colour camera saw it.
TEST_F(VizTest, SensorViewEqualsTheCapturedColour) {
    for (const std::string name : {"desk", "office"}) {
        Scene scene = recorded(name);
        const RigParameters rig = rig_of(name);
        for (const DepthStyle style : {DepthStyle::cloud, DepthStyle::mesh}) {
            scene.live->style = style;
            scene.live->fill_holes = false;
            Renderer renderer(device());
            const FrameResult frame = draw(renderer, scene,
                                           sensor_view(rig.depth, scene.live->world_from_depth,
                                                       rig.depth.width, rig.depth.height));
            const DepthSurface& surface = *scene.live->surface;
            std::int64_t checked = 0;
            int worst = 0;
            for (int y = 1; y + 1 < rig.depth.height; ++y) {
                for (int x = 1; x + 1 < rig.depth.width; ++x) {
                    const Rgba8 seen = surface.color.at(x, y);
                    if (!(surface.depth_m.at(x, y) > 0) || seen.a == 0) continue;
                    // A lone pixel on a silhouette is in no triangle.
                    const Rgba8 got = frame.picture.at(x, y);
                    if (style == DepthStyle::mesh) {
                        const float z = surface.depth_m.at(x, y);
                        bool inside = true;
                        for (int k = 0; k < 9; ++k) {
                            const float other = surface.depth_m.at(x + k % 3 - 1, y + k / 3 - 1);
                            inside = inside && other > 0 && std::abs(other - z) < 0.01f;
                        }
                        if (!inside) continue;
                    }
                    ++checked;
                    worst = std::max({worst, std::abs(got.r - seen.r), std::abs(got.g - seen.g),
                                      std::abs(got.b - seen.b)});
                }
            }
            EXPECT_LE(worst, 1) << name;
            EXPECT_GT(checked, 50'000) << name;
        }
    }
}

// What the scene does not call for costs nothing: no passes, no bytes, no pipelines.
TEST_F(VizTest, EmptySceneHasNoPassOfAnyRoomAboveTheFrame) {
    Renderer renderer(device());
    const Scene scene;
    const View view{.width = 64, .height = 48, .projection = perspective(1, 64, 48)};
    const FrameResult frame = draw(renderer, scene, view);
    EXPECT_THAT(frame.report.passes, Each(StartsWith("frame/")));
    EXPECT_EQ(frame.report.transient_bytes, 0u);
    EXPECT_THAT(renderer.pipelines().names(), IsEmpty());
    EXPECT_EQ(renderer.live_depth_bytes(), 0u);
}

TEST_F(VizTest, CapturedCloudCallsForNoLightNoMeshNoSkeleton) {
    Renderer renderer(device());
    Scene scene = recorded("office");
    scene.live->style = DepthStyle::cloud;
    const FrameResult frame = draw(renderer, scene, orbit_view(scene, 320, 180));
    const auto other_rooms = AnyOf(StartsWith("light/"), StartsWith("skeleton/"), HasSubstr("mesh"),
                                   HasSubstr("triangles"), HasSubstr("normals"));
    EXPECT_THAT(frame.report.passes, Each(Not(other_rooms)));
    EXPECT_THAT(renderer.pipelines().names(), Each(Not(other_rooms)));
    // Only the visibility buffer: eight bytes a pixel.
    EXPECT_EQ(frame.report.transient_bytes, 320u * 180u * 8u);
    EXPECT_EQ(frame.report.history_bytes, 0u);
}

TEST_F(VizTest, EachPartAppearsOnlyWhenAskedFor) {
    Scene scene = recorded("office");
    const View view = orbit_view(scene, 320, 180);
    const auto passes_with = [&](const std::string& room) {
        Renderer renderer(device());
        const FrameResult frame = draw(renderer, scene, view);
        std::int64_t count = 0;
        for (const std::string& pass : frame.report.passes) count += pass.starts_with(room);
        for (const std::string& name : renderer.pipelines().names()) {
            count += name.starts_with(room);
        }
        return count;
    };
    EXPECT_EQ(passes_with("light/"), 0);
    EXPECT_EQ(passes_with("skeleton/"), 0);
    scene.color_mode = ColorMode::relit;
    EXPECT_GT(passes_with("light/"), 0);
    scene.color_mode = ColorMode::mixed;  // and no light: nothing to add
    EXPECT_EQ(passes_with("light/"), 0);
    scene.color_mode = ColorMode::captured;
    scene.bodies.push_back(standing_body());
    EXPECT_GT(passes_with("skeleton/"), 0);
}

TEST_F(VizTest, MemoryOfWhatIsNoLongerDrawnIsGivenBack) {
    Renderer renderer(device());
    Scene scene = recorded("office");
    scene.color_mode = ColorMode::relit;
    const View view = orbit_view(scene, 320, 180);
    (void)draw(renderer, scene, view);
    const std::int64_t with = device().memory().current;
    scene.live.reset();
    for (int i = 0; i < 40; ++i) (void)draw(renderer, scene, view);
    EXPECT_EQ(renderer.live_depth_bytes(), 0u);
    EXPECT_LT(device().memory().current, with / 2);
}

// A NaN, lost or far-behind joint takes nothing else with it.
TEST_F(VizTest, BrokenJointsAreLeftOutAndTheRestIsDrawn) {
    Renderer renderer(device());
    Scene scene;
    scene.bodies.push_back(standing_body());
    const View view{.width = 320,
                    .height = 240,
                    .projection = perspective(0.9, 320, 240),
                    .world_from_view = world_from_camera_axes()};
    const Image<Rgba8> whole = draw(renderer, scene, view).picture;
    Body& body = scene.bodies[0].body;
    body.joints[19].position_m.x = std::numeric_limits<float>::quiet_NaN();
    body.joints[15].state = JointState::lost;
    body.joints[7].position_m = {0, 0, -3};
    body.joints[11].position_m.y = std::numeric_limits<float>::infinity();
    const FrameResult broken = draw(renderer, scene, view);
    EXPECT_THAT(broken.report.passes, testing::Contains("skeleton/draw"));
    EXPECT_NE(broken.picture, whole);
    const Rgba8 background = broken.picture.at(0, 0);
    std::int64_t drawn = 0;
    for (const Rgba8& pixel : broken.picture.pixels()) drawn += !(pixel == background);
    EXPECT_GT(drawn, 500);
    for (JointPosition& joint : body.joints) joint.state = JointState::lost;
    EXPECT_THAT(draw(renderer, scene, view).report.passes, Not(testing::Contains("skeleton/draw")));
}

TEST_F(VizTest, JointBehindASurfaceIsDimmedNotHidden) {
    CameraModel camera{.width = 160, .height = 120, .fx = 142, .fy = 142, .cx = 79.5, .cy = 59.5};
    Scene scene;
    const auto color_at_joint = [&](double wall_m) {
        scene.live = LiveDepth{.surface = make_surface(
                                   camera, [&](int, int) { return wall_m; },
                                   [](int, int) {
                                       return Rgba8{30, 30, 30, 255};
                                   }),
                               .world_from_depth = world_from_camera_axes()};
        scene.bodies = {BodyNode{.id = 1, .world_from_depth = world_from_camera_axes()}};
        scene.bodies[0].body.joints[0] = {.position_m = {0, 0, 2}, .state = JointState::tracked};
        Renderer renderer(device());
        return draw(renderer, scene, sensor_view(camera, world_from_camera_axes(), 320, 240))
            .picture.at(160, 120);
    };
    const Rgba8 before = color_at_joint(3.0);
    const Rgba8 behind = color_at_joint(1.5);
    EXPECT_GT(before.g, 90);
    EXPECT_LT(behind.g, before.g);
    EXPECT_GT(behind.g, 50) << "still to be seen through the surface";
}

// Shading against its formula in double: albedo * (ambient + sum of light * max(n.l, 0) * falloff),
// rolled off above 0.7, sRGB-encoded.
TEST_F(VizTest, RelitPlaneFollowsTheFormula) {
    const CameraModel camera{
        .width = 160, .height = 120, .fx = 142, .fy = 142, .cx = 79.5, .cy = 59.5};
    Scene scene;
    scene.live = LiveDepth{.surface = make_surface(
                               camera, [](int, int) { return 2.0; },
                               [](int, int) {
                                   return Rgba8{200, 120, 60, 255};
                               }),
                           .world_from_depth = world_from_camera_axes()};
    scene.color_mode = ColorMode::relit;
    scene.lights = {{.kind = LightKind::directional,
                     .direction = {0.3, -0.5, -1.0},
                     .color = {0.4f, 0.3f, 0.5f}},
                    {.kind = LightKind::point,
                     .position = {0.4, 0.2, -1.2},
                     .color = {0.6f, 0.9f, 0.3f},
                     .radius_m = 3}};
    Renderer renderer(device());
    const View view = sensor_view(camera, scene.live->world_from_depth, 160, 120);
    for (const LightRate rate : {LightRate::depth_pixel, LightRate::picture_pixel}) {
        const Image<Rgba8> picture = draw(renderer, scene, view, {.light_rate = rate}).picture;
        const auto linear = [](double c) {
            c /= 255;
            return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
        };
        const auto encoded = [](double c) {
            return 255 * (c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055);
        };
        const glm::dvec3 albedo(linear(200), linear(120), linear(60));
        double worst = 0;
        for (int y = 10; y < 110; y += 7) {
            for (int x = 10; x < 150; x += 7) {
                // World: y up, z towards the viewer; the wall faces the camera.
                const glm::dvec3 at(2.0 * (x - camera.cx) / camera.fx,
                                    -2.0 * (y - camera.cy) / camera.fy, -2.0);
                const glm::dvec3 n(0, 0, 1);
                glm::dvec3 irradiance(scene.ambient);
                irradiance +=
                    glm::dvec3(scene.lights[0].color) *
                    std::max(glm::dot(n, -glm::normalize(scene.lights[0].direction)), 0.0);
                const glm::dvec3 to_light = scene.lights[1].position - at;
                const double d2 = glm::dot(to_light, to_light);
                const double window = std::clamp(1.0 - std::pow(d2 / 9.0, 2.0), 0.0, 1.0);
                irradiance +=
                    glm::dvec3(scene.lights[1].color) *
                    (std::max(glm::dot(n, to_light) / std::sqrt(d2), 0.0) * window * window / d2);
                for (int channel = 0; channel < 3; ++channel) {
                    double c = albedo[channel] * irradiance[channel];
                    if (c > 0.7) c = 0.7 + 0.3 * (c - 0.7) / (c - 0.7 + 0.3);
                    const Rgba8 pixel = picture.at(x, y);
                    const int got = channel == 0 ? pixel.r : channel == 1 ? pixel.g : pixel.b;
                    worst = std::max(worst, std::abs(got - encoded(c)));
                }
            }
        }
        // Half a step of rounding, half a step of dither, half-float scene target, 16-bit normals.
        EXPECT_LE(worst, 2.0);
    }
}

// Light worked out once a depth pixel against light worked out once a picture pixel: the same to
// the eye on a real frame, seen from aside.
TEST_F(VizTest, LightAtDepthRateStaysCloseToLightAtPictureRate) {
    Scene scene = recorded("person", 120);
    scene.color_mode = ColorMode::relit;
    scene.lights = {{.kind = LightKind::directional,
                     .direction = {0.4, -0.6, -0.5},
                     .color = {0.8f, 0.8f, 0.75f}}};
    const View view = orbit_view(scene, 640, 360);
    Renderer renderer(device());
    const Image<Rgba8> fast = draw(renderer, scene, view).picture;
    const Image<Rgba8> slow =
        draw(renderer, scene, view, {.light_rate = LightRate::picture_pixel}).picture;
    double sum = 0;
    std::int64_t count = 0;
    for (std::size_t i = 0; i < fast.size(); ++i) {
        const int difference = std::abs(fast.pixels()[i].g - slow.pixels()[i].g);
        if (slow.pixels()[i].g < 60) continue;  // the background is the same in both
        sum += difference;
        ++count;
    }
    ASSERT_GT(count, 20'000);
    EXPECT_LT(sum / static_cast<double>(count), 3.0);
}

TEST_F(VizTest, MixedAddsToWhatTheCameraSaw) {
    Scene scene = recorded("desk");
    const View view = orbit_view(scene, 320, 180);
    Renderer renderer(device());
    const Image<Rgba8> captured = draw(renderer, scene, view).picture;
    scene.color_mode = ColorMode::mixed;
    scene.lights = {{.kind = LightKind::directional,
                     .direction = scene.live->world_from_depth.rotation * glm::dvec3(0.2, 0.3, 1),
                     .color = {0.2f, 0.2f, 0.2f}}};
    // Per picture pixel: interpolation between points would mix rolled-off highlights in.
    const Image<Rgba8> mixed =
        draw(renderer, scene, view, {.light_rate = LightRate::picture_pixel}).picture;
    std::int64_t brighter = 0;
    std::int64_t darker = 0;
    for (std::size_t i = 0; i < captured.size(); ++i) {
        // Highlights are rolled off, so only the range below the knee must not darken.
        if (captured.pixels()[i].g > 200) continue;
        brighter += mixed.pixels()[i].g > captured.pixels()[i].g + 1;
        darker += mixed.pixels()[i].g + 1 < captured.pixels()[i].g;
    }
    EXPECT_GT(brighter, 2000);
    EXPECT_EQ(darker, 0);
}

TEST_F(VizTest, ProbeGivesTheMetresUnderAPixel) {
    const CameraModel camera{
        .width = 160, .height = 120, .fx = 142, .fy = 142, .cx = 79.5, .cy = 59.5};
    Scene scene;
    scene.live = LiveDepth{.surface = make_surface(
                               camera, [](int x, int) { return x < 80 ? 1.25 : 0.0; }, test_color),
                           .world_from_depth = world_from_camera_axes()};
    Renderer renderer(device());
    const View view = sensor_view(camera, scene.live->world_from_depth, 160, 120);
    FrameOptions options;
    options.probe_px = glm::ivec2(30, 60);
    EXPECT_NEAR(draw(renderer, scene, view, options).depth_at_m.value_or(0), 1.25, 1e-5);
    options.probe_px = glm::ivec2(130, 60);
    EXPECT_FALSE(draw(renderer, scene, view, options).depth_at_m.has_value());
    options.probe_px = glm::ivec2(-5, 4000);
    EXPECT_FALSE(draw(renderer, scene, view, options).depth_at_m.has_value());
}

TEST_F(VizTest, ReportNamesPassesInOrderAndTimesEveryGroup) {
    Renderer renderer(device());
    Scene scene = recorded("office");
    FrameOptions options;
    options.timing = graph::Timing::every_group;
    const FrameResult frame = draw(renderer, scene, orbit_view(scene, 320, 180), options);
    ASSERT_FALSE(frame.report.passes.empty());
    EXPECT_EQ(frame.report.passes.front(), "surface/clear");
    double sum = 0;
    for (const graph::GroupTime& group : renderer.group_times()) {
        EXPECT_GT(group.ms, 0) << group.group;
        sum += group.ms;
    }
    EXPECT_NEAR(sum, frame.ms, 0.1 * frame.ms);
}

TEST_F(VizTest, GraphvizShowsTheFrame) {
    Renderer renderer(device());
    renderer.keep_graphviz(true);
    Scene scene = recorded("office");
    (void)draw(renderer, scene, orbit_view(scene, 320, 180));
    EXPECT_NE(renderer.graphviz().find("surface/small triangles"), std::string::npos);
}

TEST_F(VizTest, UnknownDeviceIsAClearError) {
    const auto missing = gpu::Device::create({.device = "no such device"});
    ASSERT_FALSE(missing);
    EXPECT_NE(missing.error().what.find("no such device"), std::string::npos);
    EXPECT_NE(missing.error().hint.find("devices here"), std::string::npos);
}

// Goldens: exact on the Mesa they were made with, the gate's tolerance elsewhere.
TEST_F(VizTest, Goldens) {
    Renderer renderer(device());
    Scene office = recorded("office");
    EXPECT_TRUE(matches_golden("office-mesh-orbit",
                               draw(renderer, office, orbit_view(office, 320, 180)).picture));
    office.live->style = DepthStyle::cloud;
    office.live->splat_cap_px = 3;
    EXPECT_TRUE(matches_golden("office-cloud-orbit",
                               draw(renderer, office, orbit_view(office, 320, 180)).picture));
    Scene person = recorded("person", 120);
    person.color_mode = ColorMode::relit;
    person.lights = {{.kind = LightKind::directional,
                      .direction = {0.4, -0.6, -0.5},
                      .color = {0.8f, 0.8f, 0.75f}}};
    person.bodies.push_back(standing_body());
    EXPECT_TRUE(matches_golden("person-relit-with-joints",
                               draw(renderer, person, orbit_view(person, 320, 180)).picture));
}

}  // namespace
}  // namespace kino::test
