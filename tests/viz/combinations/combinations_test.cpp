#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>

#include "tests/scenes/depth_scene.h"
#include "tests/support/random.h"
#include "viz/quality/image_metrics.h"
#include "viz/surface/mesh_shapes.h"
#include "viz_fixture.h"

namespace kino::test {
namespace {

constexpr int kWidth = 160;
constexpr int kHeight = 112;
constexpr int kCombinations = 28;
/// A picture that lost more than this lost a part of itself: zoom alone costs 31 dB here.
constexpr double kLeastDecibels = 28;

View view_of_all() {
    return {.width = kWidth,
            .height = kHeight,
            .projection = perspective(0.9, kWidth, kHeight),
            .world_from_view = look_at({0, 0.3, 0.4}, {0, 0, -2})};
}

void add(Scene& scene, std::shared_ptr<const MeshAsset> mesh, const glm::dvec3& at,
         Material material) {
    scene.materials.push_back(std::move(material));
    MeshNode node{.id = static_cast<std::uint32_t>(scene.meshes.size() + 1),
                  .mesh = std::move(mesh),
                  .material = static_cast<std::uint32_t>(scene.materials.size())};
    node.world_from_object[3] = glm::dvec4(at, 1);
    node.previous_world_from_object = node.world_from_object;
    scene.meshes.push_back(std::move(node));
}

/// A bit of everything that a frame can hold: a live surface, all kinds of materials, glowing and
/// blended ones, lights that cast shadows, bounce and neither.
Scene scene_of_all() {
    Scene scene;
    scene.color_mode = ColorMode::relit;
    scene.ambient = glm::vec3(0.15f);
    const CameraModel camera{.width = 80, .height = 60, .fx = 70, .fy = 70, .cx = 39.5, .cy = 29.5};
    scene.live = LiveDepth{.surface = make_surface(
                               camera,
                               [](int x, int y) {
                                   const double r = std::hypot(x - 30.0, y - 30.0);
                                   return r < 14 ? 1.7 + 0.01 * r : 0.0;
                               },
                               [](int x, int y) {
                                   return Rgba8{static_cast<std::uint8_t>(120 + x),
                                                static_cast<std::uint8_t>(90 + y), 140, 255};
                               })};
    scene.live->world_from_depth = look_at({0, 0, 0}, {0, 0, -1});
    scene.live->previous_world_from_depth = scene.live->world_from_depth;
    add(scene, make_box({6, 4, 0.2f}), {0, 0, -3.2},
        {.name = "wall", .base_color = {0.5f, 0.45f, 0.6f}});
    add(scene, make_box({6, 0.1f, 4}), {0, -1, -2},
        {.name = "floor", .base_color = glm::vec3(0.4f)});
    add(scene, make_sphere(0.35f), {0.7, -0.3, -2},
        {.name = "shiny",
         .base_color = {0.6f, 0.2f, 0.1f},
         .layers = {{.lobes = {{.kind = LobeKind::ggx, .color = glm::vec3(0.2f)}},
                     .transmission = glm::vec3(0.8f)},
                    {.lobes = {{}}}}});
    add(scene, make_box(glm::vec3(0.3f)), {-0.9, -0.6, -2.2},
        {.name = "lamp", .base_color = glm::vec3(0.2f), .emission = {0.6f, 0.5f, 0.1f}});
    add(scene, make_sphere(0.25f), {-0.2, 0.5, -2.3},
        {.name = "drawn", .base_color = {0.2f, 0.7f, 0.3f}, .kind = MaterialKind::toon});
    add(scene, make_box(glm::vec3(0.2f)), {1.1, 0.4, -2.4},
        {.name = "flat", .base_color = {0.1f, 0.4f, 0.8f}, .kind = MaterialKind::unlit});
    add(scene, make_sphere(0.3f), {0.2, -0.5, -1.5},
        {.name = "glass", .base_color = {0.3f, 0.8f, 0.9f}, .opacity = 0.4f});
    for (int i = 0; i < 14; ++i) {
        scene.lights.push_back(
            {.kind = LightKind::point,
             .position = {0.4 * (i % 5) - 0.8, 0.35 * (i % 4) - 0.4, -1.4 - 0.2 * (i % 6)},
             .color = {0.05f + 0.02f * static_cast<float>(i % 3), 0.06f, 0.08f},
             .radius_m = 1.6f,
             .shadow = i < 3 ? LightShadow::raycast : LightShadow::none});
    }
    scene.lights.push_back({.kind = LightKind::spot,
                            .position = {0, 1, -0.5},
                            .direction = glm::normalize(glm::dvec3(0.2, -0.4, -1)),
                            .color = glm::vec3(1.5f),
                            .radius_m = 6,
                            .indirect = true});
    scene.lights.push_back({.kind = LightKind::directional,
                            .direction = glm::normalize(glm::dvec3(0.3, -1, -0.6)),
                            .color = glm::vec3(0.2f)});
    return scene;
}

template <class T, std::size_t N>
T one_of(Random& random, const std::array<T, N>& choices) {
    return choices[static_cast<std::size_t>(random.integer(0, static_cast<int>(N) - 1))];
}

FramebufferLodOptions random_lod(Random& random) {
    FramebufferLodOptions lod;
    lod.r = one_of(random, std::array{1.0, 1.25, 1.6, 2.0, 2.3});
    lod.least_r = random.chance(0.3) ? 1.25 : 0;
    lod.reconstruction =
        random.chance(0.25) ? Reconstruction::bilinear : Reconstruction::geometry_aware;
    lod.metric =
        one_of(random, std::array{RangeMetric::depth, RangeMetric::log_depth, RangeMetric::plane});
    lod.fine_grained = random.chance(0.7);
    lod.format = random.chance(0.3) ? LodFormat::wide : LodFormat::packed;
    lod.kernel = random.chance(0.2) ? LodKernel::gauss : LodKernel::tent;
    lod.flat_tolerance = random.chance(0.3) ? 0.0f : 0.5f;
    lod.fix_share = random.chance(0.3) ? 0.05f : 0.0f;
    return lod;
}

FrameOptions random_options(Random& random) {
    FrameOptions options{.read_picture = true};
    options.raster = one_of(
        random, std::array{RasterPath::compute, RasterPath::compute_32bit, RasterPath::hardware});
    options.light_lists.tile_px = one_of(random, std::array{8u, 16u, 32u});
    options.light_lists.two_level = random.chance(0.5);
    options.light_lists.cells =
        one_of(random, std::array{DepthCells::none, DepthCells::linear, DepthCells::logarithmic});
    options.ray_shadows.half_resolution = random.chance(0.5);
    if (random.chance(0.8)) options.lod = random_lod(random);
    if (random.chance(0.4)) {
        const std::array rates = {0.0, 1.0, 2.0, 4.0};
        options.part_rates = {.shadowed = one_of(random, rates),
                              .plain = one_of(random, rates),
                              .bounced = one_of(random, rates)};
    }
    if (random.chance(0.3)) {
        options.regions = RegionLodOptions{
            .levels = random.integer(1, 3),
            .measure = random.chance(0.5) ? RegionMeasure::gradient : RegionMeasure::bend};
    }
    options.samples = random.chance(0.35) ? 4u : 1u;
    options.resolve = random.chance(0.5) ? SampleResolve::as_shown : SampleResolve::linear;
    options.zoom.z = random.chance(0.25) ? 2 : 1;
    options.read_surface = random.chance(0.2);
    options.read_view_z = random.chance(0.2);
    options.count_fixed = random.chance(0.3);
    if (random.chance(0.2)) options.probe_px = glm::ivec2(kWidth / 2, kHeight / 2);
    if (random.chance(0.2)) {
        const View view = view_of_all();
        options.deflect =
            DeflectOptions{.form = random.chance(0.5) ? DeflectForm::pan : DeflectForm::depth_warp,
                           .guard_px = 4,
                           .newest = [view] { return view; }};
    }
    return options;
}

/// For the reader of a failure.
std::string words_of(const FrameOptions& o) {
    std::string text = "raster " + std::to_string(static_cast<int>(o.raster)) + ", samples " +
                       std::to_string(o.samples) + ", zoom " + std::to_string(o.zoom.z);
    if (o.lod) {
        text += ", r " + std::to_string(o.lod->r) + " least " + std::to_string(o.lod->least_r) +
                (o.lod->reconstruction == Reconstruction::bilinear ? " bilinear" : "") +
                (o.lod->format == LodFormat::wide ? " wide" : "") +
                (o.lod->kernel == LodKernel::gauss ? " gauss" : "") +
                (o.lod->fine_grained ? " fine-grained" : "") + " fix " +
                std::to_string(o.lod->fix_share) + " flat " + std::to_string(o.lod->flat_tolerance);
    }
    text += ", rates " + std::to_string(o.part_rates.shadowed) + " " +
            std::to_string(o.part_rates.plain) + " " + std::to_string(o.part_rates.bounced);
    if (o.regions) text += ", regions of " + std::to_string(o.regions->levels);
    if (o.deflect) text += ", deflected";
    return text;
}

class CombinationsTest : public VizTest {};

// Whatever is asked for together: no message of the validation layer, the same bits twice, nothing
// of the picture missing, and nothing of it left when it is asked for no more.
TEST_F(CombinationsTest, AnyOptionsOfAFrameGoTogether) {
    const Scene scene = scene_of_all();
    const View view = view_of_all();
    Renderer renderer(device());
    const auto plain = renderer.render_to_image(scene, view, {.read_picture = true});
    ASSERT_TRUE(plain) << plain.error().to_string();
    Random random(20);
    for (int round = 0; round < kCombinations; ++round) {
        const FrameOptions options = random_options(random);
        SCOPED_TRACE(std::to_string(round) + ": " + words_of(options));
        const auto first = renderer.render_to_image(scene, view, options);
        ASSERT_TRUE(first) << first.error().to_string();
        const auto again = renderer.render_to_image(scene, view, options);
        ASSERT_TRUE(again) << again.error().to_string();
        EXPECT_TRUE(first->picture == again->picture);
        EXPECT_GT(compare_images(first->picture, plain->picture)->psnr_db, kLeastDecibels);
        EXPECT_EQ(device().validation_messages(), 0);
        if (HasFailure()) break;
    }
    const auto after = renderer.render_to_image(scene, view, {.read_picture = true});
    ASSERT_TRUE(after);
    EXPECT_TRUE(after->picture == plain->picture);
    EXPECT_EQ(after->report.passes, plain->report.passes);
}

}  // namespace
}  // namespace kino::test
