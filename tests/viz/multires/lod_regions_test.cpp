#include "viz/quality/lod_regions.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/gtc/packing.hpp>
#include <limits>

#include "tests/reference/lod_regions_reference.h"
#include "tests/viz/host_copies.h"
#include "tests/viz/multires/stage_rig.h"
#include "tests/viz/viz_fixture.h"
#include "viz/frame/stage_light.h"
#include "viz/frame/stage_surface.h"
#include "viz/quality/lod_regions_shared.h"
#include "viz/surface/mesh_shapes.h"

namespace kino::test {
namespace {

using testing::Contains;
using testing::Each;
using testing::Not;
using testing::StartsWith;

constexpr float kNever = std::numeric_limits<float>::infinity();

StageOptions region_options() {
    StageOptions options;
    options.shadows.half_resolution = false;
    return options;
}

gpu::Buffer host_buffer(gpu::Device& device, std::uint64_t bytes) {
    auto made = gpu::Buffer::create(device, "rig", bytes, gpu::MemoryUse::readback);
    EXPECT_TRUE(made);
    return std::move(*made);
}

/// One level of a chain over the scene, everything of it read back.
struct OneLevel {
    View fine_view, coarse_view;
    Image<glm::vec4> light;  ///< of the coarse surface
    Image<Rgba8> albedo;
    Image<std::uint32_t> guide;
    Image<float> z;  ///< of the fine one
    Image<std::uint32_t> normal;
    glm::uvec2 tiles{0};
    std::uint32_t side = 0;
    std::vector<std::uint32_t> texels;  ///< a tile's
    std::vector<std::uint32_t> listed;
    shared::LodRegionState state{};
};

template <class T>
Image<T> image_of(const gpu::Buffer& buffer, int width, int height) {
    Image<T> image(width, height);
    std::memcpy(image.data(), buffer.mapped(), image.size() * sizeof(T));
    return image;
}

OneLevel one_level(gpu::Device& device, const RegionLodOptions& regions, double r) {
    StageRig& rig = shared_rig(device);
    Scene scene = parts_scene();
    // Wires of about a pixel, which no coarse texel or every fourth one sees.
    for (int i = 0; i < 5; ++i) {
        MeshNode wire = scene.meshes.back();
        wire.id = static_cast<std::uint32_t>(scene.meshes.size() + 1);
        wire.mesh = make_box({0.005f, 1.6f, 0.005f});
        wire.world_from_object[3] = {-0.2 + 0.153 * i, 0.1, -1.6, 1};
        wire.previous_world_from_object = wire.world_from_object;
        scene.meshes.push_back(std::move(wire));
    }
    const View view = parts_view(320, 240);
    const FramebufferLodOptions lod{.r = r};
    OneLevel found{.fine_view = view};
    std::vector<gpu::Buffer> read;
    for (int i = 0; i < 8; ++i) read.push_back(host_buffer(device, 320 * 240 * 8));
    const RigDrawn drawn =
        rig.draw(scene, view, [&](graph::FrameGraph& graph, const StageParts& parts) {
            const StageOptions options = region_options();
            const SurfaceTargets surface =
                add_surface(graph, scene, view, parts, options.raster, false).surface;
            const CoarseSurface fine{.surface = surface, .view = view, .guide = {}};
            const CoarseSurface coarse = add_coarse_surface(graph, surface, view, lod);
            const LightLists lists =
                add_light_lists(graph, scene, coarse.view, coarse.surface.view_z, options.lists);
            const graph::TextureId light = add_shade_pass(
                graph, scene, coarse.view, {.surface = coarse.surface, .lists = lists});
            found.coarse_view = coarse.view;
            found.side = 16;
            const LodRegionList list = add_region_list(graph, light, coarse, fine, found.side,
                                                       scene.exposure, nullptr, regions, lod);
            found.tiles = list.tiles;
            const graph::TextureId textures[] = {light, coarse.surface.albedo, coarse.guide,
                                                 surface.view_z, surface.normal};
            for (int i = 0; i < 5; ++i) read_back(graph, textures[i], read[i]);
            read_back(graph, list.texels, read[5], list.tiles.x * list.tiles.y * 4);
            read_back(graph, list.pixels, read[6], 320 * 240 * 4);
            read_back(graph, list.dispatch, read[7], sizeof(shared::LodRegionState));
            return add_reconstruction(graph, light, coarse, surface, view, lod);
        });
    const int width = found.coarse_view.width;
    const int height = found.coarse_view.height;
    const auto halves = image_of<std::uint64_t>(read[0], width, height);
    found.light.resize(width, height);
    std::transform(halves.pixels().begin(), halves.pixels().end(), found.light.pixels().begin(),
                   [](std::uint64_t bits) { return glm::unpackHalf4x16(bits); });
    found.albedo = image_of<Rgba8>(read[1], width, height);
    found.guide = image_of<std::uint32_t>(read[2], width, height);
    found.z = image_of<float>(read[3], 320, 240);
    found.normal = image_of<std::uint32_t>(read[4], 320, 240);
    const auto words = read[5].read<std::uint32_t>();
    found.texels.assign(words.begin(), words.begin() + found.tiles.x * found.tiles.y);
    found.state = read[7].read<shared::LodRegionState>()[0];
    const auto listed = read[6].read<std::uint32_t>();
    found.listed.assign(listed.begin(), listed.begin() + found.state.count);
    return found;
}

double luminance(const glm::dvec3& c) {
    return glm::dot(c, glm::dvec3(0.2126, 0.7152, 0.0722));
}

double region_srgb(std::uint8_t coded) {
    const double c = coded / 255.0;
    return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

glm::dvec3 region_normal(std::uint32_t bits) {
    const auto part = [](std::uint32_t v) {
        return std::max(static_cast<std::int16_t>(v & 0xFFFFu) / 32767.0, -1.0);
    };
    glm::dvec3 n(part(bits), part(bits >> 16), 0);
    n.z = 1 - std::abs(n.x) - std::abs(n.y);
    if (n.z < 0) {
        const glm::dvec2 folded((1 - std::abs(n.y)) * (n.x < 0 ? -1 : 1),
                                (1 - std::abs(n.x)) * (n.y < 0 ? -1 : 1));
        n.x = folded.x;
        n.y = folded.y;
    }
    return glm::normalize(n);
}

/// What the reference compares.
struct HostLevel {
    Image<reference::RegionCoarse> coarse;
    Image<reference::RegionFine> fine;
};

HostLevel host_level(const OneLevel& level) {
    HostLevel host;
    host.coarse.resize(level.light.width(), level.light.height());
    for (std::size_t i = 0; i < host.coarse.size(); ++i) {
        const Rgba8 c = level.albedo.pixels()[i];
        const std::uint32_t word = level.guide.pixels()[i];
        reference::RegionCoarse& texel = host.coarse.pixels()[i];
        texel.color =
            std::max(1e-3, luminance({region_srgb(c.r), region_srgb(c.g), region_srgb(c.b)}));
        if (c.a > 0) {
            texel.luminance = luminance(glm::dvec3(level.light.pixels()[i])) / texel.color;
        }
        const double steps = (word >> 16) - 1.0;
        if (word >> 16 != 0) texel.z = 0.05 * std::exp2(steps / 4586);
        texel.slope = (glm::dvec2(word & 255u, word >> 8 & 255u) - 128.0) / 44.0;
    }
    host.fine.resize(level.z.width(), level.z.height());
    for (std::size_t i = 0; i < host.fine.size(); ++i) {
        reference::RegionFine& texel = host.fine.pixels()[i];
        texel.z = level.z.pixels()[i];
        texel.normal = region_normal(level.normal.pixels()[i]);
        texel.slope = glm::dvec2(texel.normal) / std::max(-texel.normal.z, 0.35);
    }
    return host;
}

// Every tile against the double reference, except where it stands on the limit itself.
TEST_F(VizTest, TilesAreChosenAsTheReferenceDoes) {
    struct Case {
        RegionLodOptions regions;
        double r;
    };
    const Case cases[] = {
        {{.limit = 0.05f, .doubt_share = kNever}, 4},
        {{.limit = kNever, .doubt_share = 0.02f}, 4},
        {{.measure = RegionMeasure::bend, .limit = 0.02f, .doubt_share = kNever}, 4},
        {{.limit = 0.05f, .doubt_share = 0.05f}, 3.3}};
    for (const Case& one : cases) {
        const RegionLodOptions& regions = one.regions;
        const OneLevel level = one_level(device(), regions, one.r);
        const HostLevel host = host_level(level);
        const Projection& k = level.fine_view.projection;
        const reference::RegionRules rules{.fx = k.fx,
                                           .fy = k.fy,
                                           .cx = k.cx,
                                           .cy = k.cy,
                                           .bend = regions.measure == RegionMeasure::bend};
        int finer = 0;
        int coarser = 0;
        int close = 0;
        std::vector<std::uint32_t> expected;
        for (std::uint32_t tile = 0; tile < level.texels.size(); ++tile) {
            const glm::ivec2 at(tile % level.tiles.x, tile / level.tiles.x);
            const auto found = reference::find_region(host.coarse, host.fine, at,
                                                      static_cast<int>(level.side), rules);
            const double share = static_cast<double>(found.doubtful) / found.area;
            const bool wanted = found.change >= regions.limit || share > regions.doubt_share;
            const bool near_limit = std::abs(found.change - regions.limit) < 2e-3 ||
                                    std::abs(share - regions.doubt_share) < 0.012;
            const std::uint32_t texels = level.texels[tile];
            EXPECT_TRUE(texels == 0 || texels == static_cast<std::uint32_t>(found.area));
            ++(texels != 0 ? finer : coarser);
            close += near_limit;
            if (!near_limit) {
                EXPECT_EQ(texels != 0, wanted)
                    << tile << ": " << found.change << ", " << found.doubtful;
            }
            for (int row = 0; texels != 0 && row < static_cast<int>(level.side); ++row) {
                for (int column = 0; column < static_cast<int>(level.side); ++column) {
                    const int x = at.x * static_cast<int>(level.side) + column;
                    const int y = at.y * static_cast<int>(level.side) + row;
                    if (x < 320 && y < 240) expected.push_back(y << 16 | x);
                }
            }
        }
        // All kinds of tiles are among them, few on the limit.
        EXPECT_GT(finer, 10);
        EXPECT_GT(coarser, 10);
        EXPECT_LT(close, static_cast<int>(level.texels.size()) / 5);
        EXPECT_EQ(level.listed, expected);
        EXPECT_EQ(level.state.tiles, static_cast<std::uint32_t>(finer));
        EXPECT_EQ(level.state.groups_x, (level.state.count + 63) / 64);
    }
}

// A limit of 0 is shading everything at r0: the same bits, by other shaders.
TEST_F(VizTest, NoLimitIsTheFinestLevelEverywhere) {
    StageRig& rig = shared_rig(device());
    const Scene scene = parts_scene();
    for (const double r : {1.0, 2.0}) {
        const View view = parts_view(192, 144);
        StageOptions options = region_options();
        if (r > 1) options.lod = FramebufferLodOptions{.r = r};
        const RigDrawn whole = rig.draw(scene, view, options);
        options.regions = RegionLodOptions{.limit = 0, .doubt_share = kNever};
        const RigDrawn tiles = rig.draw(scene, view, options);
        EXPECT_THAT(tiles.passes, Contains("light/shade listed"));
        EXPECT_THAT(tiles.passes, Contains("light/shadow listed"));
        EXPECT_EQ(whole.linear, tiles.linear) << r;
    }
}

// And an infinite one shades the coarsest level alone, brought up step by step.
TEST_F(VizTest, AnInfiniteLimitIsTheCoarsestLevel) {
    StageRig& rig = shared_rig(device());
    const Scene scene = parts_scene();
    const View view = parts_view(256, 192);
    StageOptions options = region_options();
    options.regions = RegionLodOptions{.limit = kNever, .doubt_share = kNever};
    const RigDrawn tiles = rig.draw(scene, view, options);
    const FramebufferLodOptions step{.r = 2};
    const RigDrawn chain =
        rig.draw(scene, view, [&](graph::FrameGraph& graph, const StageParts& parts) {
            const SurfaceTargets surface =
                add_surface(graph, scene, view, parts, options.raster, false).surface;
            const CoarseSurface half = add_coarse_surface(graph, surface, view, step);
            const CoarseSurface quarter = add_coarse_surface(graph, half.surface, half.view, step);
            const LightLists lists =
                add_light_lists(graph, scene, view, surface.view_z, options.lists,
                                add_bounces(graph, scene, view, parts, options));
            const RayShadows shadows = add_ray_shadows(
                graph, scene, quarter.view,
                {.view_z = quarter.surface.view_z, .normal = quarter.surface.normal}, lists,
                parts.bvh.add(graph), options.shadows);
            const graph::TextureId light = add_shade_pass(
                graph, scene, quarter.view,
                {.surface = quarter.surface, .lists = lists, .shadow_masks = shadows.masks});
            return add_reconstruction(
                graph, add_reconstruction(graph, light, quarter, half.surface, half.view, step),
                half, surface, view, step);
        });
    EXPECT_EQ(tiles.linear, chain.linear);
    // Near what r = 4 makes at once.
    StageOptions at_once = region_options();
    const RigDrawn full = rig.draw(scene, view, at_once);
    at_once.lod = FramebufferLodOptions{.r = 4};
    const double direct = light_error(rig.draw(scene, view, at_once).linear, full.linear).mse;
    EXPECT_LT(light_error(tiles.linear, full.linear).mse, 1.5 * direct);
}

// Less limit, less error; tiles that were shaded at full rate are those of the full picture.
TEST_F(VizTest, TheLimitTradesErrorForWork) {
    StageRig& rig = shared_rig(device());
    const Scene scene = parts_scene();
    const View view = parts_view(256, 192);
    StageOptions options = region_options();
    const RigDrawn full = rig.draw(scene, view, options);
    double before = 0;
    std::size_t same_before = full.linear.size() + 1;
    for (const float limit : {0.02f, 0.06f, 0.2f}) {
        options.regions = RegionLodOptions{.limit = limit};
        const RigDrawn tiles = rig.draw(scene, view, options);
        EXPECT_EQ(tiles.linear, rig.draw(scene, view, options).linear) << "not the same twice";
        const double error = light_error(tiles.linear, full.linear).mse;
        std::size_t same = 0;
        for (std::size_t i = 0; i < full.linear.size(); ++i) {
            same += tiles.linear.pixels()[i] == full.linear.pixels()[i];
        }
        EXPECT_GT(error, before) << limit;
        EXPECT_LT(same, same_before) << limit;
        before = error;
        same_before = same;
    }
    EXPECT_LT(before, 1e-3);
    EXPECT_GT(same_before, full.linear.size() / 500);
}

// What materials emit is no light that could be coarse: beside a colour so dark that light could
// not be told from it, it would be lost.
TEST_F(VizTest, EmissionIsNotResizedWithTiles) {
    Renderer renderer(device());
    Scene scene = parts_scene();
    scene.lights.resize(1);
    for (Material& material : scene.materials) material.base_color = glm::vec3(0.001f);
    scene.materials[1].emission = {0.5f, 0.2f, 0.1f};
    scene.materials[2].emission = {0.1f, 0.3f, 0.6f};
    FrameOptions options;
    const auto full = renderer.render_to_image(scene, parts_view(), options);
    options.regions = RegionLodOptions{.limit = kNever, .doubt_share = kNever};
    const auto tiles = renderer.render_to_image(scene, parts_view(), options);
    ASSERT_TRUE(full && tiles);
    int most = 0;
    int brightest = 0;
    for (std::size_t i = 0; i < full->picture.size(); ++i) {
        const Rgba8 a = full->picture.pixels()[i];
        const Rgba8 b = tiles->picture.pixels()[i];
        most = std::max({most, std::abs(a.r - b.r), std::abs(a.g - b.g), std::abs(a.b - b.b)});
        brightest = std::max<int>(brightest, a.r);
    }
    EXPECT_GT(brightest, 150);
    EXPECT_LE(most, 3);
}

// What stayed coarse at one level is not looked at in the next.
TEST_F(VizTest, TilesLieInTilesOfTheLevelBefore) {
    StageRig& rig = shared_rig(device());
    const Scene scene = parts_scene();
    const View view = parts_view(512, 384);
    const RegionLodOptions regions{.limit = 0.04f};
    std::vector<LodRegionList> lists;
    std::vector<gpu::Buffer> read;
    for (int i = 0; i < 2; ++i) read.push_back(host_buffer(device(), 4096));
    (void)rig.draw(scene, view, [&](graph::FrameGraph& graph, const StageParts& parts) {
        const StageOptions options = region_options();
        const SurfaceTargets surface =
            add_surface(graph, scene, view, parts, options.raster, false).surface;
        const LightLists lights =
            add_light_lists(graph, scene, view, surface.view_z, options.lists);
        const graph::TextureId light = add_region_light(
            graph, {scene, {}, parts.bvh.add(graph), options}, lights,
            {.surface = surface, .view = view, .guide = {}}, regions, {.r = 1}, true, &lists);
        for (std::size_t i = 0; i < lists.size(); ++i) {
            read_back(graph, lists[i].texels, read[i], lists[i].tiles.x * lists[i].tiles.y * 4);
        }
        return light;
    });
    ASSERT_EQ(lists.size(), 2u);
    EXPECT_EQ(lists[0].tiles, lists[1].tiles);
    EXPECT_EQ(lists[0].side, 32u);
    EXPECT_EQ(lists[1].side, 64u);
    const auto before = read[0].read<std::uint32_t>();
    const auto after = read[1].read<std::uint32_t>();
    int finest = 0;
    int stopped = 0;
    for (std::size_t tile = 0; tile < lists[0].tiles.x * lists[0].tiles.y; ++tile) {
        finest += after[tile] != 0;
        stopped += before[tile] == 0;
        EXPECT_TRUE(after[tile] == 0 || before[tile] != 0) << tile;
    }
    EXPECT_GT(finest, 2);
    EXPECT_GT(stopped, 2);
}

TEST_F(VizTest, RegionsThatNobodyAskedForCostNothing) {
    StageRig rig(device());
    StageOptions options = region_options();
    options.lod = FramebufferLodOptions{.r = 2};
    const RigDrawn plain = rig.draw(parts_scene(), parts_view(), options);
    EXPECT_THAT(plain.passes, Each(Not(StartsWith("lod/region"))));
    EXPECT_THAT(rig.pipelines().names(), Each(Not(StartsWith("lod/region"))));
    // Without guides there are no regions.
    options.lod->format = LodFormat::wide;
    const RigDrawn wide = rig.draw(parts_scene(), parts_view(), options);
    options.regions = RegionLodOptions{};
    EXPECT_EQ(rig.draw(parts_scene(), parts_view(), options).passes, wide.passes);
}

}  // namespace
}  // namespace kino::test
