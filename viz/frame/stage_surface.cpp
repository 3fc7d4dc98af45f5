#include "viz/frame/stage_surface.h"

#include <array>
#include <utility>
#include <vector>

#include "viz/surface/depth_passes.h"

namespace kino {

using graph::FrameGraph;
using graph::PassBuilder;
using graph::PassContext;
using graph::TextureId;
using graph::Use;

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

SurfaceTargets add_ground(FrameGraph& graph, const Scene& scene, const View& view,
                          const StageParts& parts, RasterPath raster, bool ids) {
    const auto width = static_cast<std::uint32_t>(view.width);
    const auto height = static_cast<std::uint32_t>(view.height);
    const std::uint32_t top = pack_srgb(scene.background_top);
    const std::uint32_t bottom = pack_srgb(scene.background_bottom);
    SurfaceTargets surface;
    surface.albedo = graph.create_texture("albedo", {width, height, VK_FORMAT_R8G8B8A8_UNORM});
    surface.view_z = graph.create_texture("view depth", {width, height, kViewZFormat});
    surface.normal = graph.create_texture("normal", {width, height, kNormalFormat});
    if (ids) surface.id = graph.create_texture("id", {width, height, kIdFormat});
    return scene.live && scene.live->surface
               ? parts.live.add(graph, *scene.live, view, raster, surface, top, bottom)
               : add_background(graph, surface, top, bottom);
}

DrawnSurface add_meshes(FrameGraph& graph, const View& view, const StageParts& parts,
                        const MeshList& list, SurfaceTargets surface) {
    const auto width = static_cast<std::uint32_t>(view.width);
    const auto height = static_cast<std::uint32_t>(view.height);
    if (!surface.object.valid()) surface.object = add_no_objects(graph, view);
    TextureId depth = graph.create_texture("depth", {width, height, kDepthFormat});
    depth = add_depth_seed(graph, view, surface.view_z, depth, surface.live);
    const MeshDrawer::Drawn drawn = parts.meshes.add(graph, list, surface, depth);
    return {drawn.targets, drawn.depth};
}

DrawnSurface add_surface(FrameGraph& graph, const Scene& scene, const View& view,
                         const StageParts& parts, RasterPath raster, bool ids) {
    const SurfaceTargets ground = add_ground(graph, scene, view, parts, raster, ids);
    if (scene.meshes.empty()) return {ground, {}};
    return add_meshes(graph, view, parts, parts.meshes.prepare(graph, scene, view, {}), ground);
}

SpawnedLights add_bounces(FrameGraph& graph, const Scene& scene, const View& view,
                          const StageParts& parts, const StageOptions& options) {
    std::vector<ReflectiveMap> maps;
    for (const std::size_t i : bouncing_lights(scene)) {
        const View seen = reflective_view(scene.lights[i], options.bounces);
        const DrawnSurface drawn = add_surface(graph, scene, seen, parts, options.raster, false);
        maps.push_back({.light = i, .view = seen, .surface = drawn.surface});
    }
    if (maps.empty()) return {};
    return spawn_bounces(scene, view, std::move(maps), options.bounces);
}

}  // namespace kino
