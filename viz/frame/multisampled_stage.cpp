#include "viz/frame/multisampled_stage.h"

#include "base/check.h"
#include "viz/frame/stage_surface.h"
#include "viz/light/blended_pass.h"
#include "viz/light/forward_pass.h"
#include "viz/light/multisample.h"

namespace kino {

bool wants_samples(const Scene& scene, const StageOptions& options) {
    KINO_CHECK(options.samples == 1 || options.samples == kMostSamples);
    return options.samples > 1 && !scene.meshes.empty() && !options.lod;
}

Stage add_multisampled_stage(graph::FrameGraph& graph, const Scene& scene, const View& view,
                             const StageParts& parts, const StageOptions& options) {
    Stage stage;
    SurfaceTargets ground = add_ground(graph, scene, view, parts, options.raster, options.read_ids);
    const MeshList meshes = parts.meshes.prepare(graph, scene, view, {});
    graph::TextureId depth = graph.create_texture(
        "depth, samples", {static_cast<std::uint32_t>(view.width),
                           static_cast<std::uint32_t>(view.height), kDepthFormat, kMostSamples});
    depth = add_mesh_depths(graph, meshes, add_depth_seed(graph, view, ground.view_z, depth));
    const View fine = sample_view(view);
    const graph::TextureId sample_z = add_sample_depths(graph, view, depth);
    const SpawnedLights bounces = add_bounces(graph, scene, view, parts, options);
    stage.lists =
        add_light_lists(graph, scene, fine, sample_z, sample_lists(options.lists), bounces);
    SceneBvhPasses bvh;
    const bool shadows = wants_ray_shadows(scene);
    if (shadows) bvh = parts.bvh.add(graph);

    const auto masks_of = [&](const SurfaceTargets& surface) {
        return add_ray_shadows(graph, scene, view,
                               {.view_z = surface.view_z, .normal = surface.normal}, stage.lists,
                               bvh, options.shadows)
            .masks;
    };
    const auto shade = [&](const SurfaceTargets& surface, graph::BufferId masks) {
        return add_shade_pass(graph, scene, view,
                              {.surface = surface, .lists = stage.lists, .shadow_masks = masks});
    };
    // Captured pictures stay what they are beside meshes that are lit; only the shader of materials
    // knows that.
    if (scene.color_mode == ColorMode::captured) ground.object = add_no_objects(graph, view);
    const graph::TextureId ground_light =
        shade(ground, shadows && scene.live ? masks_of(ground) : graph::BufferId{});
    const DrawnSurface drawn = add_meshes(graph, view, parts, meshes, ground);
    stage.surface = drawn.surface;
    stage.depth = drawn.depth;
    MeshLight light = make_mesh_light(graph, scene, view, stage.lists);
    if (shadows) light.shadow_masks = masks_of(drawn.surface);
    light.sample_z = sample_z;
    light.pixel_z = drawn.surface.view_z;
    light.pixel_light = shade(drawn.surface, light.shadow_masks);
    const ForwardTargets lit = add_forward_pass(graph, scene, view, parts.meshes, light, kAllKinds,
                                                {add_spread(graph, ground_light), depth});
    stage.linear = lit.linear;
    if (wants_blended(scene)) {
        LightListOptions lists = sample_lists(options.lists);
        lists.for_blended = true;
        stage.linear = add_blended_pass(
            graph, scene, view, parts.meshes,
            add_light_lists(graph, scene, fine, sample_z, lists, bounces), lit.linear, lit.depth);
    }
    stage.linear = add_resolve(graph, scene, stage.linear, options.resolve);
    return stage;
}

}  // namespace kino
