#include "viz/frame/stage.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "viz/light/blended_pass.h"
#include "viz/light/emission_pass.h"
#include "viz/surface/depth_passes.h"

namespace kino {
namespace {

using graph::FrameGraph;
using graph::PassBuilder;
using graph::PassContext;
using graph::TextureId;
using graph::Use;

/// Nothing has an object id before meshes are drawn.
TextureId add_no_objects(FrameGraph& graph, const View& view) {
    TextureId object =
        graph.create_texture("object", {static_cast<std::uint32_t>(view.width),
                                        static_cast<std::uint32_t>(view.height), kObjectFormat});
    graph.add_pass(
        "frame/no objects", "raster",
        [&](PassBuilder& b) { object = b.write(object, Use::color_attachment); },
        [id = object](PassContext& c) {
            const std::array<gpu::Target, 1> targets = {{{.view = c.view(id), .clear = true}}};
            c.commands().begin_rendering({c.desc(id).width, c.desc(id).height}, targets, nullptr);
            c.commands().end_rendering();
        });
    return object;
}

struct Drawn {
    SurfaceTargets surface;
    TextureId depth;  ///< invalid without meshes
};

/// Albedo, depth and normal of all that is opaque, and ids of what is wanted.
Drawn add_surface(FrameGraph& graph, const Scene& scene, const View& view, const StageParts& parts,
                  RasterPath raster, bool ids) {
    const auto width = static_cast<std::uint32_t>(view.width);
    const auto height = static_cast<std::uint32_t>(view.height);
    const std::uint32_t top = pack_srgb(scene.background_top);
    const std::uint32_t bottom = pack_srgb(scene.background_bottom);
    Drawn made;
    SurfaceTargets& surface = made.surface;
    surface.albedo = graph.create_texture("albedo", {width, height, VK_FORMAT_R8G8B8A8_UNORM});
    surface.view_z = graph.create_texture("view depth", {width, height, kViewZFormat});
    surface.normal = graph.create_texture("normal", {width, height, kNormalFormat});
    if (ids) surface.id = graph.create_texture("id", {width, height, kIdFormat});
    surface = scene.live && scene.live->surface
                  ? parts.live.add(graph, *scene.live, view, raster, surface, top, bottom)
                  : add_background(graph, surface, top, bottom);
    if (!scene.meshes.empty()) {
        surface.object = add_no_objects(graph, view);
        TextureId depth = graph.create_texture("depth", {width, height, kDepthFormat});
        depth = add_depth_seed(graph, view, surface.view_z, depth);
        const MeshDrawer::Drawn drawn = parts.meshes.add(graph, scene, view, surface, depth);
        surface = drawn.targets;
        made.depth = drawn.depth;
    }
    return made;
}

/// What the bouncing lights shine on, as lights.
SpawnedLights add_bounces(FrameGraph& graph, const Scene& scene, const View& view,
                          const StageParts& parts, const StageOptions& options) {
    std::vector<ReflectiveMap> maps;
    for (const std::size_t i : bouncing_lights(scene)) {
        const View seen = reflective_view(scene.lights[i], options.bounces);
        const Drawn drawn = add_surface(graph, scene, seen, parts, options.raster, false);
        maps.push_back({.light = i, .view = seen, .surface = drawn.surface});
    }
    if (maps.empty()) return {};
    return spawn_bounces(scene, view, std::move(maps), options.bounces);
}

}  // namespace

std::uint32_t pack_srgb(const glm::vec3& color) {
    const auto byte = [](float v) {
        return static_cast<std::uint32_t>(std::lround(std::clamp(v, 0.0f, 1.0f) * 255.0f));
    };
    return byte(color.r) | byte(color.g) << 8 | byte(color.b) << 16 | 0xFF000000u;
}

bool wants_stage(const Scene& scene) {
    if (!scene.meshes.empty()) return true;
    return scene.live.has_value() && scene.color_mode != ColorMode::captured &&
           (wants_light_lists(scene) || !bouncing_lights(scene).empty());
}

Stage add_stage(FrameGraph& graph, const Scene& scene, const View& view, const StageParts& parts,
                const StageOptions& options) {
    Stage stage;
    const Drawn drawn = add_surface(graph, scene, view, parts, options.raster, options.read_ids);
    stage.surface = drawn.surface;
    stage.depth = drawn.depth;
    const SurfaceTargets& surface = stage.surface;
    const SpawnedLights bounces = add_bounces(graph, scene, view, parts, options);
    stage.lists = add_light_lists(graph, scene, view, surface.view_z, options.lists, bounces);
    SceneBvhPasses bvh;
    if (wants_ray_shadows(scene)) bvh = parts.bvh.add(graph);
    // Fine-grained LOD knows light by what surfaces return of it; what they emit is added after it.
    const bool emits_apart =
        options.lod && options.lod->fine_grained && surface.object.valid() && wants_emission(scene);
    const auto shade = [&](const SurfaceTargets& at, const View& seen_from) {
        const RayShadows shadows =
            add_ray_shadows(graph, scene, seen_from, {.view_z = at.view_z, .normal = at.normal},
                            stage.lists, bvh, options.shadows);
        return add_shade_pass(graph, scene, seen_from,
                              {.surface = at,
                               .lists = stage.lists,
                               .shadow_masks = shadows.masks,
                               .emission = !emits_apart});
    };
    if (options.lod) {
        const CoarseSurface coarse = add_coarse_surface(graph, surface, view, *options.lod);
        stage.linear = add_reconstruction(graph, shade(coarse.surface, coarse.view), coarse,
                                          surface, view, *options.lod);
        if (emits_apart) {
            stage.linear = add_emission_pass(graph, scene, surface.object, stage.linear);
        }
    } else {
        stage.linear = shade(surface, view);
    }
    if (wants_blended(scene)) {
        LightListOptions lists = options.lists;
        lists.for_blended = true;
        stage.linear =
            add_blended_pass(graph, scene, view, parts.meshes,
                             add_light_lists(graph, scene, view, surface.view_z, lists, bounces),
                             stage.linear, stage.depth);
    }
    return stage;
}

}  // namespace kino
