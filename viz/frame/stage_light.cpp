#include "viz/frame/stage_light.h"

#include "base/check.h"

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
        inputs.shadow_masks =
            add_ray_shadows(graph, scene, at.view,
                            {.view_z = at.surface.view_z, .normal = at.surface.normal},
                            inputs.lists, lighting.bvh, lighting.options.shadows)
                .masks;
    }
    return add_shade_pass(graph, scene, at.view, inputs);
}

}  // namespace

std::vector<LightLevel> stage_levels(const Scene& scene, const StageOptions& options) {
    return light_levels(options.rates, light_parts(scene), options.lod ? options.lod->r : 1.0);
}

graph::TextureId add_light_levels(graph::FrameGraph& graph, const StageLighting& lighting,
                                  const CoarseSurface& base, std::span<const LightLevel> levels,
                                  const FramebufferLodOptions& lod, bool emission) {
    KINO_CHECK(!levels.empty());
    const auto step_to = [&](std::size_t i) {
        FramebufferLodOptions step = lod;
        step.r = levels[i].r / levels[i - 1].r;
        step.fix_share = 0;
        return step;
    };
    std::vector<CoarseSurface> surfaces = {base};
    for (std::size_t i = 1; i < levels.size(); ++i) {
        const CoarseSurface& finer = surfaces.back();
        surfaces.push_back(add_coarse_surface(graph, finer.surface, finer.view, step_to(i)));
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

}  // namespace kino
