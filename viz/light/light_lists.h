#pragma once

#include <cstdint>
#include <functional>

#include "viz/graph/graph.h"
#include "viz/light/light_parts.h"
#include "viz/scene/scene.h"
#include "viz/scene/view.h"
#include "viz/surface/depth_rasterizer.h"

namespace kino {

/// Spacing of the 32 depth cells of 2.5D culling (GPU Pro 4, Forward+, 5.4.2).
enum class DepthCells : std::uint8_t { none, linear, logarithmic };

struct LightListOptions {
    std::uint32_t tile_px = 8;     ///< 8, 16 or 32
    std::uint32_t capacity = 512;  ///< lights a tile; what does not fit is dropped and counted
    DepthCells cells = DepthCells::linear;
    bool two_level = true;  ///< macro tiles first
    /// For blended surfaces: from the near plane to the farthest opaque depth, without cells.
    bool for_blended = false;
    std::uint32_t cell_count = 32;  ///< 1 .. 32
    /// Indices there is room for in the whole picture; 0: `capacity` for every tile. With a pool
    /// tiles are counted, summed and filled, which takes the tests twice.
    std::uint32_t pool = 0;
    std::uint32_t parts = kAllLights;  ///< only these of the scene's own lights (light_parts.h)
};

/// What was refused before it reached the device.
struct LightCheck {
    std::uint32_t dropped = 0;  ///< not finite, or without a radius
};

/// Which lights reach which tile. Lists are in ascending order of light, the same every run.
struct LightLists {
    graph::BufferId lights;    ///< shared::LightRecord, view space; global (directional) ones first
    graph::BufferId headers;   ///< uvec2 a tile: first index, count
    graph::BufferId indices;   ///< light indices
    graph::BufferId counters;  ///< shared::LightListCounters
    std::uint32_t tile_px = 0;
    std::uint32_t tiles_x = 0, tiles_y = 0;
    std::uint32_t global_count = 0;  ///< the first lights are in no list and light everything
    std::uint32_t local_count = 0;
    std::uint32_t width = 0, height = 0;  ///< of the view that they were made for, px
    bool has_spots = false;               ///< what the lights call for in shaders that walk them
    bool has_masks = false;
    LightCheck check;
};

/// Up to this many local lights the shader walks all of them, and there is no culling.
constexpr std::size_t kLightsWithoutLists = 8;

/// True where the scene's lights are worth lists.
[[nodiscard]] bool wants_light_lists(const Scene& scene);

/// Where lights that passes make are to go.
struct SpawnTargets {
    graph::BufferId records;  ///< shared::LightRecord, view space of the lists' view
    graph::BufferId volumes;  ///< shared::LightVolume
    std::uint32_t first_record = 0;
    std::uint32_t first_volume = 0;
};

/// Lights that passes make; they follow the scene's own local lights.
struct SpawnedLights {
    std::uint32_t count = 0;
    /// Adds the passes that write all of them; the targets' ids become the new ones.
    std::function<void(graph::FrameGraph&, SpawnTargets&)> add;
};

/// Adds the culling passes for the depths in `view_z` (R32F, 0 = nothing; size of the view). A
/// scene that does not want lists, and spawns no lights, gets one upload, and `tile_px` 0: all
/// lights are walked.
[[nodiscard]] LightLists add_light_lists(graph::FrameGraph& graph, const Scene& scene,
                                         const View& view, graph::TextureId view_z,
                                         const LightListOptions& options,
                                         const SpawnedLights& spawned = {});

/// Fills the counters that culling leaves alone: sum, longest, histogram. Returns the counters.
[[nodiscard]] graph::BufferId add_light_statistics(graph::FrameGraph& graph,
                                                   const LightLists& lists);

/// A picture of the lists' lengths, RGBA16F, of the lists' view: blue few, green half of `full`,
/// red `full` lights and more.
[[nodiscard]] graph::TextureId add_light_heat_map(graph::FrameGraph& graph, const LightLists& lists,
                                                  float full = 50);

/// Shades the surface with lists, materials and (if valid) shadow masks into a new linear RGBA16F
/// texture of the surface's size. `view` may be a smaller version of the lists' view (framebuffer
/// LOD): tiles are found by position. The surface must have albedo, view_z, normal; without
/// `object` everything has material 0.
struct ShadeInputs {
    SurfaceTargets surface;
    LightLists lists;
    /// Four words a pixel, by rows; invalid: no light has a shadow. Bit s: the light in slot s does
    /// not reach the pixel. Slots count global lights first, then the entries of the tile's list
    /// (all local lights, where there are no lists); lights from slot 128 on have no shadow.
    graph::BufferId shadow_masks;
    /// False: what materials emit is left out, for add_emission_pass() to add at full size.
    bool emission = true;
    /// What the lists' lights give and nothing else: no ambient light, no captured colours that
    /// stay beside virtual light, no emission.
    bool lights_only = false;
    /// Valid: a picture of the view's size, RGBA16F, that light is added to and that is returned.
    /// Its alpha, and its pixels that show nothing, stay as they are. Not for add_shade_list().
    graph::TextureId onto;
};
[[nodiscard]] graph::TextureId add_shade_pass(graph::FrameGraph& graph, const Scene& scene,
                                              const View& view, const ShadeInputs& inputs);

}  // namespace kino
