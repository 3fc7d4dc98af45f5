#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "tests/scenes/depth_scene.h"
#include "viz/surface/mesh_shapes.h"
#include "viz_fixture.h"

namespace kino::test {
namespace {

using ::testing::Contains;
using ::testing::Each;
using ::testing::Not;
using ::testing::StartsWith;

constexpr int kWidth = 96;
constexpr int kHeight = 64;

/// At the origin, looking along the world's -z, x right and y up.
View front_view() {
    return {.width = kWidth,
            .height = kHeight,
            .projection = perspective(0.8, kWidth, kHeight),
            .world_from_view = look_at({0, 0, 0}, {0, 0, -1})};
}

MeshNode node(std::shared_ptr<const MeshAsset> mesh, const glm::dvec3& place,
              std::uint32_t material, std::uint32_t id) {
    MeshNode made{.id = id, .mesh = std::move(mesh), .material = material};
    made.world_from_object[3] = glm::dvec4(place, 1);
    made.previous_world_from_object = made.world_from_object;
    return made;
}

/// A wall that fills the picture, 3 m away, grey under ambient light alone.
Scene wall_scene() {
    Scene scene;
    scene.color_mode = ColorMode::relit;
    scene.ambient = glm::vec3(0.5f);
    scene.materials.push_back({.name = "wall", .base_color = glm::vec3(0.4f, 0.4f, 0.5f)});
    scene.meshes.push_back(node(make_box({8, 8, 0.2f}), {0, 0, -3.1}, 1, 1));
    return scene;
}

Material glass() {
    return {.name = "glass", .base_color = glm::vec3(0.2f, 0.8f, 0.2f), .opacity = 0.4f};
}

FrameResult draw(Renderer& renderer, const Scene& scene, const FrameOptions& options = {}) {
    auto frame = renderer.render_to_image(scene, front_view(), options);
    EXPECT_TRUE(frame) << (frame ? "" : frame.error().to_string());
    return frame ? std::move(*frame) : FrameResult{};
}

double to_linear(std::uint8_t coded) {
    const double c = coded / 255.0;
    return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

int largest_difference(const Image<Rgba8>& a, const Image<Rgba8>& b) {
    int most = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        const Rgba8 p = a.pixels()[i];
        const Rgba8 q = b.pixels()[i];
        most = std::max({most, std::abs(p.r - q.r), std::abs(p.g - q.g), std::abs(p.b - q.b)});
    }
    return most;
}

std::vector<Light> small_lights(int count) {
    std::vector<Light> lights;
    for (int i = 0; i < count; ++i) {
        lights.push_back(
            {.kind = LightKind::point,
             .position = {0.3 * (i % 5) - 0.6, 0.25 * (i / 5 % 5) - 0.5, -1.6 - 0.05 * (i % 7)},
             .color = {0.02f * static_cast<float>(1 + i % 3), 0.03f,
                       0.02f * static_cast<float>(3 - i % 3)},
             .radius_m = 1.2f});
    }
    return lights;
}

TEST_F(VizTest, StageShowsWhatIsNearest) {
    Renderer renderer(device());
    Scene scene = wall_scene();
    scene.materials.push_back({.name = "ball", .base_color = glm::vec3(0.6f, 0.1f, 0.1f)});
    scene.meshes.push_back(node(make_sphere(0.4f), {0, 0, -2}, 2, 2));
    const FrameResult frame = draw(renderer, scene, {.read_surface = true});
    EXPECT_NEAR(frame.surface.view_z_m.at(kWidth / 2, kHeight / 2), 1.6, 0.01);
    EXPECT_NEAR(frame.surface.view_z_m.at(2, 2), 3.0, 0.01);
    const Rgba8 ball = frame.picture.at(kWidth / 2, kHeight / 2);
    EXPECT_NEAR(to_linear(ball.r), 0.6 * 0.5, 0.01);
    EXPECT_NEAR(to_linear(ball.g), 0.1 * 0.5, 0.01);
    EXPECT_NEAR(to_linear(frame.picture.at(2, 2).b), 0.5 * 0.5, 0.01);
}

// A live frame and meshes hide each other by depth alone.
TEST_F(VizTest, StageMixesLiveDepthAndMeshes) {
    auto loaded = load_recording("recordings/desk");
    ASSERT_TRUE(loaded);
    Scene scene = std::move(loaded->scene);
    const View view = sensor_view(loaded->rig.depth, scene.live->world_from_depth, kWidth, kHeight);
    Renderer renderer(device());
    auto before = renderer.render_to_image(scene, view, {.read_surface = true});
    ASSERT_TRUE(before);
    // A plate right across the view, 1 m before the sensor.
    scene.materials.push_back({.name = "plate", .base_color = glm::vec3(0.5f)});
    MeshNode plate = node(make_box({6, 6, 0.001f}), {0, 0, 0}, 1, 1);
    const Pose world_from_plate =
        scene.live->world_from_depth * Pose{.rotation = {1, 0, 0, 0}, .translation = {0, 0, 1}};
    plate.world_from_object = world_from_plate.matrix();
    scene.meshes.push_back(plate);
    auto after = renderer.render_to_image(scene, view, {.read_surface = true});
    ASSERT_TRUE(after);
    int near = 0;
    int far = 0;
    for (std::size_t i = 0; i < before->surface.view_z_m.size(); ++i) {
        const float live = before->surface.view_z_m.pixels()[i];
        const float both = after->surface.view_z_m.pixels()[i];
        if (live > 0 && live < 0.999f) {
            EXPECT_EQ(both, live);
            ++near;
        } else {
            EXPECT_NEAR(both, 1, 2e-3);
            ++far;
        }
    }
    EXPECT_GT(near, 100);
    EXPECT_GT(far, 100);
}

// One pane of glass before a wall: the pane's light and the wall's, mixed by the pane's cover.
TEST_F(VizTest, BlendedSurfacesCoverByTheirOpacity) {
    Renderer renderer(device());
    Scene scene = wall_scene();
    const Image<Rgba8> bare = draw(renderer, scene).picture;
    scene.materials.push_back(glass());
    scene.meshes.push_back(node(make_box({0.8f, 0.8f, 0.01f}), {0, 0, -2}, 2, 2));
    scene.meshes.back().mesh = make_grid(0.8f, 0.8f);
    // The grid lies in y = 0: stand it up, facing the camera.
    scene.meshes.back().world_from_object =
        glm::dmat4{{1, 0, 0, 0}, {0, 0, 1, 0}, {0, -1, 0, 0}, {0, 0, -2, 1}};
    const FrameResult frame = draw(renderer, scene);
    const int x = kWidth / 2;
    const int y = kHeight / 2;
    const double cover = 0.4;  // seen from straight ahead
    const double expected_r = cover * 0.2 * 0.5 + (1 - cover) * 0.4 * 0.5;
    const double expected_g = cover * 0.8 * 0.5 + (1 - cover) * 0.4 * 0.5;
    EXPECT_NEAR(to_linear(frame.picture.at(x, y).r), expected_r, 0.005);
    EXPECT_NEAR(to_linear(frame.picture.at(x, y).g), expected_g, 0.005);
    EXPECT_EQ(frame.picture.at(2, 2).g, bare.at(2, 2).g);
    // Behind the wall it is not seen.
    scene.meshes.back().world_from_object[3].z = -5;
    EXPECT_EQ(largest_difference(draw(renderer, scene).picture, bare), 0);
}

// Two panes: the order is by distance, not by the order in the scene.
TEST_F(VizTest, BlendedSurfacesAreDrawnFarthestFirst) {
    Renderer renderer(device());
    Scene scene = wall_scene();
    scene.materials.push_back(glass());
    scene.materials.push_back({.name = "red", .base_color = {0.9f, 0, 0}, .opacity = 0.7f});
    const glm::dmat4 standing{{1, 0, 0, 0}, {0, 0, 1, 0}, {0, -1, 0, 0}, {0, 0, -2, 1}};
    for (const std::uint32_t material : {2u, 3u}) {
        scene.meshes.push_back(node(make_grid(0.8f, 0.8f), {0, 0, 0}, material, material));
        scene.meshes.back().world_from_object = standing;
        scene.meshes.back().world_from_object[3].z = material == 2 ? -1.5 : -2.5;
    }
    const Image<Rgba8> one = draw(renderer, scene).picture;
    std::swap(scene.meshes[1], scene.meshes[2]);
    EXPECT_EQ(largest_difference(one, draw(renderer, scene).picture), 0);
    const double behind = 0.7 * 0.9 * 0.5 + 0.3 * 0.4 * 0.5;
    EXPECT_NEAR(to_linear(one.at(kWidth / 2, kHeight / 2).r), 0.4 * 0.2 * 0.5 + 0.6 * behind,
                0.006);
}

// Lists for blended surfaces hold the lights before the opaque ones, too: the picture is that of a
// shader that walks all lights.
TEST_F(VizTest, BlendedSurfacesAreLitBySurroundingLights) {
    Renderer renderer(device());
    Scene scene = wall_scene();
    scene.ambient = glm::vec3(0.02f);
    scene.materials.push_back(glass());
    scene.meshes.push_back(node(make_sphere(0.45f), {0.1, 0, -1.6}, 2, 2));
    // Too far from the wall to be in any opaque tile's list.
    scene.lights = small_lights(7);
    for (Light& light : scene.lights) light.radius_m = 0.5f;
    ASSERT_FALSE(wants_light_lists(scene));
    const FrameResult walked = draw(renderer, scene);
    for (int i = 0; i < 3; ++i) {
        // Adds nothing but the need for lists.
        scene.lights.push_back({.kind = LightKind::point,
                                .position = {100, 100, 100},
                                .color = glm::vec3(1),
                                .radius_m = 0.1f});
    }
    ASSERT_TRUE(wants_light_lists(scene));
    const FrameResult listed = draw(renderer, scene);
    EXPECT_LE(largest_difference(walked.picture, listed.picture), 1);
    Scene dark = scene;
    dark.lights.clear();
    EXPECT_GT(largest_difference(draw(renderer, dark).picture, listed.picture), 20);
}

TEST_F(VizTest, ABoxCastsItsShadowByRays) {
    Renderer renderer(device());
    Scene scene = wall_scene();
    scene.ambient = glm::vec3(0);
    scene.lights = {{.kind = LightKind::point,
                     .position = {0, 0, -0.5},
                     .color = glm::vec3(2),
                     .radius_m = 10}};
    scene.materials.push_back({.name = "box", .base_color = glm::vec3(0.5f)});
    scene.meshes.push_back(node(make_box(glm::vec3(0.3f)), {0.35, 0, -1.5}, 2, 2));
    const Image<Rgba8> bright = draw(renderer, scene).picture;
    EXPECT_EQ(renderer.bvh_bytes(), 0u);
    scene.lights[0].shadow = LightShadow::raycast;
    const FrameResult frame = draw(renderer, scene);
    EXPECT_GT(renderer.bvh_bytes(), 0u);
    // The light is half a metre before the camera, so the shadow on the wall is wider than the box
    // hides: from x = 1.11 to 1.47 m it is seen.
    const Projection k = front_view().projection;
    const int shadowed = static_cast<int>(std::lround(k.cx + k.fx * 1.3 / 3));
    const int y = kHeight / 2;
    EXPECT_GT(bright.at(shadowed, y).g, 60);
    EXPECT_LT(frame.picture.at(shadowed, y).g, 8);
    EXPECT_EQ(frame.picture.at(5, y).g, bright.at(5, y).g);
    // Without the light nothing of it is left.
    scene.lights[0].shadow = LightShadow::none;
    EXPECT_EQ(largest_difference(draw(renderer, scene).picture, bright), 0);
    EXPECT_EQ(renderer.bvh_bytes(), 0u);
}

/// A torch that shines on a red wall at the left; the grey wall ahead sees the red one alone.
Scene bounce_scene() {
    Scene scene = wall_scene();
    scene.ambient = glm::vec3(0);
    scene.materials.push_back({.name = "red", .base_color = {0.8f, 0.1f, 0.1f}});
    scene.meshes.push_back(node(make_box({0.2f, 6, 6}), {-1.6, 0, -2}, 2, 2));
    scene.lights = {{.kind = LightKind::spot,
                     .position = {-0.6, 0, -2},
                     .direction = {-1, 0, 0},
                     .color = glm::vec3(20),
                     .radius_m = 8,
                     .inner_rad = 0.5f,
                     .outer_rad = 0.7f,
                     .indirect = true}};
    return scene;
}

/// What the wall ahead returns at (x, y, -3): the integral over the red wall, in double.
double bounced_red(const Scene& scene, double x, double y) {
    const Light& torch = scene.lights[0];
    const glm::dvec3 at(x, y, -3);
    double sum = 0;
    constexpr int kSteps = 400;
    constexpr double kReach = 1.0;  // beyond the cone's rim on the wall
    const double step = 2 * kReach / kSteps;
    for (int i = 0; i < kSteps; ++i) {
        for (int j = 0; j < kSteps; ++j) {
            const glm::dvec3 patch(-1.5, (i + 0.5) * step - kReach, -2 + (j + 0.5) * step - kReach);
            const glm::dvec3 from_torch = patch - torch.position;
            const double d = glm::length(from_torch);
            const double cosine = -from_torch.x / d;
            const double outer = std::cos(double{torch.outer_rad});
            const double inner = std::cos(double{torch.inner_rad});
            const double bright = std::clamp((cosine - outer) / (inner - outer), 0.0, 1.0);
            const double ratio = d * d / (double{torch.radius_m} * torch.radius_m);
            const double inside = std::clamp(1 - ratio * ratio, 0.0, 1.0);
            const double lit = torch.color.r * bright * bright * inside * inside * cosine / (d * d);
            const glm::dvec3 way = at - patch;
            const double squared = glm::dot(way, way);
            // The red wall looks along x, the grey one along z.
            const double angles = std::max(way.x, 0.0) * std::max(-way.z, 0.0) / squared;
            sum += 0.8 * lit * step * step / std::numbers::pi * angles / squared;
        }
    }
    return 0.4 * sum;
}

double bounce_error(Renderer& renderer, const Scene& scene, std::uint32_t grid) {
    FrameOptions options;
    options.bounces.grid = grid;
    const Image<Rgba8> picture = draw(renderer, scene, options).picture;
    const Projection k = front_view().projection;
    double worst = 0;
    for (const double x : {-0.6, -0.2, 0.3}) {
        for (const double y : {-0.5, 0.1}) {
            const int px = static_cast<int>(std::lround(k.cx + k.fx * x / 3));
            const int py = static_cast<int>(std::lround(k.cy - k.fy * y / 3));
            const double expected =
                bounced_red(scene, (px - k.cx) * 3 / k.fx, -(py - k.cy) * 3 / k.fy);
            EXPECT_GT(expected, 0.02);
            worst =
                std::max(worst, std::abs(to_linear(picture.at(px, py).r) - expected) / expected);
        }
    }
    return worst;
}

TEST_F(VizTest, OneBounceIsTheIntegralOverWhatIsLit) {
    Renderer renderer(device());
    const Scene scene = bounce_scene();
    const double fine = bounce_error(renderer, scene, 16);
    const double usual = bounce_error(renderer, scene, 8);
    EXPECT_LT(usual, 0.06);
    EXPECT_LT(fine, 0.04);
    // One light for all of it is in the wrong place.
    EXPECT_GT(bounce_error(renderer, scene, 1), 1.5 * usual);
    Scene plain = scene;
    plain.lights[0].indirect = false;
    const FrameResult dark = draw(renderer, plain);
    EXPECT_THAT(dark.report.passes, Each(Not(StartsWith("light/spawn"))));
    EXPECT_LT(dark.picture.at(kWidth / 2, kHeight / 2).r, 3);
}

// What a scene does not call for has no pass, no byte and no pipeline.
TEST_F(VizTest, StagePartsCostNothingUnlessCalledFor) {
    auto loaded = load_recording("recordings/desk");
    ASSERT_TRUE(loaded);
    Renderer renderer(device());
    const View view =
        sensor_view(loaded->rig.depth, loaded->scene.live->world_from_depth, kWidth, kHeight);
    auto live = renderer.render_to_image(loaded->scene, view, {});
    ASSERT_TRUE(live);
    for (const char* part : {"light/", "frame/", "mesh", "quality/", "accel/"}) {
        EXPECT_THAT(renderer.pipelines().names(), Each(Not(StartsWith(part)))) << part;
    }
    EXPECT_EQ(renderer.mesh_bytes() + renderer.bvh_bytes(), 0u);

    Scene scene = wall_scene();
    const FrameResult plain = draw(renderer, scene);
    EXPECT_THAT(plain.report.passes, Contains(StartsWith("light/shade")));
    for (const char* part : {"light/blended", "light/tile", "light/shadow", "accel/"}) {
        EXPECT_THAT(plain.report.passes, Each(Not(StartsWith(part)))) << part;
    }
    scene.materials.push_back(glass());
    scene.meshes.push_back(node(make_sphere(0.3f), {0, 0, -2}, 2, 2));
    const FrameResult blended = draw(renderer, scene);
    std::set<std::string> added;
    for (const std::string& pass : blended.report.passes) {
        if (std::count(plain.report.passes.begin(), plain.report.passes.end(), pass) <
            std::count(blended.report.passes.begin(), blended.report.passes.end(), pass)) {
            added.insert(pass);
        }
    }
    // A second upload of lights and materials, and the pass itself.
    EXPECT_THAT(added, Contains("light/blended"));
    EXPECT_LE(added.size(), 3u) << ::testing::PrintToString(added);
    // And all of it goes again.
    auto after = renderer.render_to_image(loaded->scene, view, {});
    ASSERT_TRUE(after);
    EXPECT_EQ(after->report.passes, live->report.passes);
    EXPECT_EQ(renderer.mesh_bytes() + renderer.bvh_bytes(), 0u);
}

// Framebuffer LOD at r = 1 is the full picture; at 2 it is close to it.
TEST_F(VizTest, StageAtACoarserRateIsCloseToTheFullOne) {
    Renderer renderer(device());
    Scene scene = wall_scene();
    scene.materials.push_back({.name = "ball", .base_color = glm::vec3(0.6f, 0.1f, 0.1f)});
    scene.meshes.push_back(node(make_sphere(0.5f), {0, 0, -2}, 2, 2));
    scene.lights = small_lights(30);
    const Image<Rgba8> full = draw(renderer, scene).picture;
    FrameOptions options;
    options.lod = FramebufferLodOptions{.r = 2};
    const FrameResult coarse = draw(renderer, scene, options);
    double squares = 0;
    for (std::size_t i = 0; i < full.size(); ++i) {
        const double d = full.pixels()[i].g - coarse.picture.pixels()[i].g;
        squares += d * d;
    }
    const double psnr = 10 * std::log10(255 * 255 * static_cast<double>(full.size()) / squares);
    EXPECT_GT(psnr, 30);
    EXPECT_GT(squares, 0) << "r = 2 must not be full shading";
}

// What shines by itself and returns nothing has no albedo that light could be multiplied by.
TEST_F(VizTest, StageAtACoarserRateStillShines) {
    Renderer renderer(device());
    Scene scene = wall_scene();
    scene.materials.push_back(
        {.name = "lamp", .base_color = glm::vec3(0), .emission = {0.6f, 0.3f, 0.1f}});
    scene.meshes.push_back(node(make_sphere(0.4f), {0, 0, -2}, 2, 2));
    const FrameResult full = draw(renderer, scene);
    EXPECT_THAT(full.report.passes, Each(Not(StartsWith("light/emission"))));
    FrameOptions options;
    options.lod = FramebufferLodOptions{.r = 2};
    const FrameResult coarse = draw(renderer, scene, options);
    EXPECT_NEAR(to_linear(coarse.picture.at(kWidth / 2, kHeight / 2).r), 0.6, 0.01);
    for (int x = kWidth / 2 - 8; x <= kWidth / 2 + 8; ++x) {
        EXPECT_NEAR(coarse.picture.at(x, kHeight / 2).g, full.picture.at(x, kHeight / 2).g, 2);
    }
    EXPECT_NEAR(coarse.picture.at(3, 3).g, full.picture.at(3, 3).g, 2);
}

TEST_F(VizTest, StageIsTheSameEveryTime) {
    Scene scene = wall_scene();
    scene.lights = small_lights(40);
    scene.lights[3].shadow = LightShadow::raycast;
    scene.materials.push_back(glass());
    scene.meshes.push_back(node(make_sphere(0.4f), {0, 0, -2}, 2, 2));
    Renderer first(device());
    Renderer second(device());
    const Image<Rgba8> one = draw(first, scene).picture;
    EXPECT_EQ(largest_difference(one, draw(first, scene).picture), 0);
    EXPECT_EQ(largest_difference(one, draw(second, scene).picture), 0);
}

}  // namespace
}  // namespace kino::test
