#include "viz/frame/stage.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "viz/frame/multisampled_stage.h"
#include "viz/frame/stage_light.h"
#include "viz/frame/stage_surface.h"
#include "viz/frame/supersampled_stage.h"
#include "viz/light/blended_pass.h"
#include "viz/light/emission_pass.h"
#include "viz/light/forward_pass.h"
#include "viz/light/shade_list.h"

namespace kino {

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

Stage add_stage(graph::FrameGraph& graph, const Scene& scene, const View& view,
                const StageParts& parts, const StageOptions& options) {
    if (wants_samples(scene, options)) {
        return add_multisampled_stage(graph, scene, view, parts, options);
    }
    Stage stage;
    SampleTargets samples;
    const DrawnSurface drawn =
        wants_edge_samples(scene, options)
            ? add_sampled_surface(graph, scene, view, parts, options, &samples)
            : add_surface(graph, scene, view, parts, options.raster, options.read_ids);
    stage.surface = drawn.surface;
    stage.depth = drawn.depth;
    const SurfaceTargets& surface = stage.surface;
    const SpawnedLights bounces = add_bounces(graph, scene, view, parts, options);
    const std::vector<LightLevel> levels = stage_levels(scene, options);
    std::optional<FramebufferLodOptions> lod = options.lod;
    if (levels.front().r > 1 && !lod) lod.emplace();
    if (lod) lod->r = levels.front().r;
    std::optional<CoarseSurface> coarse;
    if (lod) coarse = add_coarse_surface(graph, surface, view, *lod);
    // Fewer tiles where nobody walks the lists for finer pixels. Tiles know only the depths that
    // they were made from.
    const bool fixes = coarse && wants_fixes(*lod);
    const bool coarse_lists = coarse && !fixes && (opaque_kinds(scene) & kForwardKinds) == 0;
    stage.lists = coarse_lists
                      ? add_light_lists(graph, scene, coarse->view, coarse->surface.view_z,
                                        options.lists, bounces)
                      : add_light_lists(graph, scene, view, surface.view_z, options.lists, bounces);
    SceneBvhPasses bvh;
    const bool rays = wants_ray_shadows(scene) && (options.lists.parts & kShadowedLights) != 0;
    if (rays) bvh = parts.bvh.add(graph);
    const bool by_regions =
        options.regions && allows_regions(lod.value_or(FramebufferLodOptions{}));
    // Fine-grained LOD knows light by what surfaces return of it; what they emit is added after it.
    const bool resizes_all = lod || by_regions;
    const bool emits_apart = resizes_all && lod.value_or(FramebufferLodOptions{}).fine_grained &&
                             surface.object.valid() && wants_emission(scene);
    RayShadows shadows;
    const auto shade = [&](const SurfaceTargets& at, const View& seen_from) {
        const float off_surface = coarse ? coarse->off_surface : 0.0f;
        const CoarseSurface base{
            .surface = at, .view = seen_from, .guide = {}, .off_surface = off_surface};
        if (by_regions) {
            return add_region_light(graph, {scene, bounces, bvh, options}, stage.lists, base,
                                    *options.regions, lod.value_or(FramebufferLodOptions{.r = 1}),
                                    !emits_apart);
        }
        if (levels.size() > 1) {
            return add_light_levels(graph, {scene, bounces, bvh, options}, base, levels,
                                    lod.value_or(FramebufferLodOptions{}), !emits_apart);
        }
        shadows =
            add_ray_shadows(graph, scene, seen_from,
                            {.view_z = at.view_z, .normal = at.normal, .off_surface = off_surface},
                            stage.lists, bvh, options.shadows);
        return add_shade_pass(graph, scene, seen_from,
                              {.surface = at,
                               .lists = stage.lists,
                               .shadow_masks = shadows.masks,
                               .emission = !emits_apart});
    };
    const bool drawn_over =
        wants_blended(scene) || samples.valid() || (opaque_kinds(scene) & kForwardKinds) != 0;
    if (coarse) {
        const bool resized = coarse->view.width != view.width || coarse->view.height != view.height;
        const bool finishes = options.finish && resized && !fixes && !emits_apart && !drawn_over;
        (finishes ? stage.picture : stage.linear) =
            add_reconstruction(graph, shade(coarse->surface, coarse->view), *coarse, surface, view,
                               *lod, &stage.fixed, finishes ? &*options.finish : nullptr);
        if (stage.fixed.valid()) {
            const PixelList list{stage.fixed.pixels, stage.fixed.state, stage.fixed.cap};
            const graph::BufferId masks = add_listed_shadows(
                graph, scene, view, {.view_z = surface.view_z, .normal = surface.normal},
                stage.lists, bvh, list, options.shadows);
            stage.linear = add_shade_list(graph, scene, view,
                                          {.surface = surface,
                                           .lists = stage.lists,
                                           .shadow_masks = masks,
                                           .emission = !emits_apart},
                                          list, stage.linear);
        }
    } else {
        stage.linear = shade(surface, view);
    }
    // What is drawn over it needs it; else the last pass adds it on the way.
    if (emits_apart && !drawn_over) {
        stage.emitting = surface.object;
    } else if (emits_apart) {
        stage.linear = add_emission_pass(graph, scene, surface.object, stage.linear);
    }
    if ((opaque_kinds(scene) & kForwardKinds) != 0) {
        MeshLight light = make_mesh_light(graph, scene, view, stage.lists);
        // Masks of a coarse picture are of other pixels, those of one part of other lights.
        if (!lod && (by_regions || levels.size() > 1)) {
            shadows = add_ray_shadows(graph, scene, view,
                                      {.view_z = surface.view_z, .normal = surface.normal},
                                      stage.lists, bvh, options.shadows);
        }
        if (!lod) light.shadow_masks = shadows.masks;
        const ForwardTargets forward = add_forward_pass(graph, scene, view, parts.meshes, light,
                                                        kForwardKinds, {stage.linear, stage.depth});
        stage.linear = forward.linear;
        stage.depth = forward.depth;
    }
    if (samples.valid()) {
        stage.linear =
            add_edge_samples(graph, scene, view, samples, surface, stage.linear, options);
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
