#include "viz/frame/stage_light.h"

#include <utility>

#include "base/check.h"
#include "viz/light/shade_list.h"

namespace kino {
namespace {

/// The lights of one level on one surface.
graph::TextureId add_level(graph::FrameGraph& graph, const StageLighting& lighting,
                           const CoarseSurface& at, std::uint32_t parts, ShadeInputs inputs) {
    const Scene& scene = lighting.scene;
    LightListOptions options = lighting.options.lists;
    options.parts &= parts;
    inputs.surface = at.surface;
    inputs.lists =
        add_light_lists(graph, scene, at.view, at.surface.view_z, options,
                        (parts & kBouncedLights) != 0 ? lighting.bounces : SpawnedLights{});
    if ((parts & kShadowedLights) != 0 && wants_ray_shadows(scene)) {
        inputs.shadow_masks = add_ray_shadows(graph, scene, at.view,
                                              {.view_z = at.surface.view_z,
                                               .normal = at.surface.normal,
                                               .off_surface = at.off_surface},
                                              inputs.lists, lighting.bvh, lighting.options.shadows)
                                  .masks;
    }
    return add_shade_pass(graph, scene, at.view, inputs);
}

/// From one level to the next: memory follows that of the finer one.
FramebufferLodOptions step_by(FramebufferLodOptions lod, double r) {
    lod.r = r;
    lod.least_r = 0;
    lod.fix_share = 0;
    return lod;
}

}  // namespace

std::vector<LightLevel> stage_levels(const Scene& scene, const StageOptions& options) {
    const PartRates rates = options.regions ? PartRates{} : options.rates;
    return light_levels(rates, light_parts(scene), options.lod ? options.lod->r : 1.0);
}

graph::TextureId add_light_levels(graph::FrameGraph& graph, const StageLighting& lighting,
                                  const CoarseSurface& base, std::span<const LightLevel> levels,
                                  const FramebufferLodOptions& lod, bool emission) {
    KINO_CHECK(!levels.empty());
    const auto step_to = [&](std::size_t i) { return step_by(lod, levels[i].r / levels[i - 1].r); };
    std::vector<CoarseSurface> surfaces = {base};
    for (std::size_t i = 1; i < levels.size(); ++i) {
        const CoarseSurface& finer = surfaces.back();
        CoarseSurface next = add_coarse_surface(graph, finer.surface, finer.view, step_to(i));
        next.off_surface += finer.off_surface;
        surfaces.push_back(std::move(next));
    }
    graph::TextureId sum;
    for (std::size_t i = levels.size(); i-- > 0;) {
        const bool first = i == 0;
        sum = add_level(graph, lighting, surfaces[i], levels[i].parts,
                        {.emission = first && emission, .lights_only = !first, .onto = sum});
        if (first) break;
        const CoarseSurface& finer = surfaces[i - 1];
        sum = add_reconstruction(graph, sum, surfaces[i], finer.surface, finer.view, step_to(i));
    }
    return sum;
}

graph::TextureId add_region_light(graph::FrameGraph& graph, const StageLighting& lighting,
                                  const LightLists& lists, const CoarseSurface& base,
                                  const RegionLodOptions& regions, const FramebufferLodOptions& lod,
                                  bool emission, std::vector<LodRegionList>* chosen) {
    const Scene& scene = lighting.scene;
    const FramebufferLodOptions step = step_by(lod, 2);
    std::vector<CoarseSurface> surfaces = {base};
    for (int k = 0; k < regions.levels; ++k) {
        const CoarseSurface& finer = surfaces.back();
        CoarseSurface next = add_coarse_surface(graph, finer.surface, finer.view, step);
        // As small as pictures get.
        if (next.view.width == finer.view.width && next.view.height == finer.view.height) break;
        next.off_surface += finer.off_surface;
        surfaces.push_back(std::move(next));
    }
    const auto shadow_surface = [](const CoarseSurface& at) {
        return ShadowSurface{.view_z = at.surface.view_z,
                             .normal = at.surface.normal,
                             .off_surface = at.off_surface};
    };
    const bool shadows = wants_ray_shadows(scene);
    ShadeInputs inputs{.surface = surfaces.back().surface, .lists = lists, .emission = emission};
    if (shadows) {
        const CoarseSurface& at = surfaces.back();
        inputs.shadow_masks = add_ray_shadows(graph, scene, at.view, shadow_surface(at), lists,
                                              lighting.bvh, lighting.options.shadows)
                                  .masks;
    }
    graph::TextureId light = add_shade_pass(graph, scene, surfaces.back().view, inputs);
    std::vector<LodRegionList> tiles;
    for (std::size_t k = surfaces.size() - 1; k-- > 0;) {
        const CoarseSurface& coarse = surfaces[k + 1];
        const CoarseSurface& fine = surfaces[k];
        tiles.push_back(add_region_list(
            graph, light, coarse, fine, region_side(lod.r, regions, static_cast<int>(k)),
            scene.exposure, tiles.empty() ? nullptr : &tiles.back(), regions, lod));
        light = add_reconstruction(graph, light, coarse, fine.surface, fine.view, step);
        graph.allow_storage(light);
        const LodRegionList& list = tiles.back();
        const PixelList pixels{list.pixels, list.dispatch, list.most};
        inputs.surface = fine.surface;
        inputs.shadow_masks = {};
        if (shadows) {
            inputs.shadow_masks =
                add_listed_shadows(graph, scene, fine.view, shadow_surface(fine), lists,
                                   lighting.bvh, pixels, lighting.options.shadows);
        }
        light = add_shade_list(graph, scene, fine.view, inputs, pixels, light);
    }
    if (chosen != nullptr) *chosen = std::move(tiles);
    return light;
}

}  // namespace kino
