#pragma once

#include <span>
#include <vector>

#include "viz/accel/scene_bvh.h"
#include "viz/frame/stage.h"
#include "viz/light/light_lists.h"
#include "viz/light/light_parts.h"
#include "viz/quality/framebuffer_lod.h"
#include "viz/quality/lod_regions.h"

namespace kino {

/// What the surfaces of one stage are lit with.
struct StageLighting {
    const Scene& scene;
    const SpawnedLights& bounces;
    const SceneBvhPasses& bvh;
    const StageOptions& options;
};

/// Levels that the stage's light is worked out at.
[[nodiscard]] std::vector<LightLevel> stage_levels(const Scene& scene, const StageOptions& options);

/// The light of all levels, at the rate of the first, which is that of `base`. Each further level
/// has a surface picked from that of the level before, light lists and shadows of its own lights,
/// and is brought to the level before by reconstruction, where light is added to it. Ambient light,
/// emission (if asked for) and pixels that show nothing belong to the first level. `lod` without r.
[[nodiscard]] graph::TextureId add_light_levels(graph::FrameGraph& graph,
                                                const StageLighting& lighting,
                                                const CoarseSurface& base,
                                                std::span<const LightLevel> levels,
                                                const FramebufferLodOptions& lod, bool emission);

/// All light at the rate of `base`, or coarser by tiles (lod_regions.h): the coarsest surface is
/// shaded in whole, and at each finer level what a list of tiles holds. `lists` must be of the base
/// surface or a finer one. `chosen`, if not null: the lists of tiles, from coarse to fine.
[[nodiscard]] graph::TextureId add_region_light(graph::FrameGraph& graph,
                                                const StageLighting& lighting,
                                                const LightLists& lists, const CoarseSurface& base,
                                                const RegionLodOptions& regions,
                                                const FramebufferLodOptions& lod, bool emission,
                                                std::vector<LodRegionList>* chosen = nullptr);

}  // namespace kino
