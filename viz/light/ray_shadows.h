#pragma once

#include <cstdint>

#include "viz/accel/scene_bvh.h"
#include "viz/graph/graph.h"
#include "viz/light/light_lists.h"
#include "viz/light/pixel_list.h"
#include "viz/scene/scene.h"
#include "viz/scene/view.h"

namespace kino {

/// How rays become work for the device; every way makes the same masks.
enum class ShadowDispatch : std::uint8_t {
    per_pixel,  ///< a lane walks the lights of its texel
    jobs        ///< a list of rays first, then a lane each (GPU Pro 4, Forward+, 5.5)
};

struct RayShadowOptions {
    /// One mask for 2 x 2 pixels, traced from the first of them that shows something. Needs tiles
    /// of an even number of this view's pixels; else every pixel is traced.
    bool half_resolution = true;
    std::uint32_t rays_per_pixel = 32;  ///< 0 .. 128; further lights have no shadow there
    ShadowDispatch dispatch = ShadowDispatch::per_pixel;
    /// Rays start this share of the largest coordinate (from the tree's center, and along the view)
    /// off their surface, and end as much before the light.
    float offset = 5e-4f;
    /// Hits of the live frame's tree nearer than this to a ray's origin do not count: the tree is
    /// coarser than what is drawn, and its surface would shadow itself.
    float live_bias_m = 0.12f;
    int live_columns = 80;  ///< about as many vertices of the live frame across; SceneBvhOptions
    std::uint32_t job_room = 1u << 21;  ///< jobs of a band of rows; what does not fit is more bands
};

/// What rays start from, both of the view's size.
struct ShadowSurface {
    graph::TextureId view_z;  ///< metres, 0 = nothing
    graph::TextureId normal;  ///< octahedral, view space
    /// What its points may lie off the surface they show, as a share of their depth: rays start as
    /// much farther off.
    float off_surface = 0;
};

struct RayShadows {
    /// ShadeInputs::shadow_masks: four words a pixel of the view, by rows. Bit s is set where
    /// something stands between the pixel and the light in slot s: global lights are slots
    /// 0 .. global_count - 1, then come the entries of the tile's list, or all local lights where
    /// there are no lists. From slot 128 on there is no shadow. Invalid: no light has a shadow.
    graph::BufferId masks;
    graph::BufferId counters;  ///< shared::ShadowCounters
};

/// True where a light that reaches the device asks for ray-cast shadows.
[[nodiscard]] bool wants_ray_shadows(const Scene& scene);

/// Adds the passes that cast rays to the lights with shadows, from every pixel that faces such a
/// light and is within its reach. Adds none, and returns invalid ids, where no light wants them or
/// the tree is empty. `lists` may be of a larger view (framebuffer LOD).
[[nodiscard]] RayShadows add_ray_shadows(graph::FrameGraph& graph, const Scene& scene,
                                         const View& view, const ShadowSurface& surface,
                                         const LightLists& lists, const SceneBvhPasses& bvh,
                                         const RayShadowOptions& options = {});

/// The masks of single pixels of the view's surface, in the order of the list: what
/// add_shade_list() takes. Invalid where add_ray_shadows() makes none.
[[nodiscard]] graph::BufferId add_listed_shadows(graph::FrameGraph& graph, const Scene& scene,
                                                 const View& view, const ShadowSurface& surface,
                                                 const LightLists& lists, const SceneBvhPasses& bvh,
                                                 const PixelList& list,
                                                 const RayShadowOptions& options = {});

}  // namespace kino
