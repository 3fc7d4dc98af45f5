#pragma once

#include <cstdint>
#include <vector>

#include "viz/graph/graph.h"
#include "viz/light/light_lists.h"
#include "viz/scene/scene.h"
#include "viz/scene/view.h"
#include "viz/surface/depth_rasterizer.h"

namespace kino {

/// What a patch of lit surface becomes.
enum class BounceMode : std::uint8_t {
    diffuse,  ///< a light round the patch's normal that falls off with the cosine: one true bounce
    artist    ///< a spotlight of 60 degrees along the mirror direction, as the source has it
};

struct BounceOptions {
    std::uint32_t grid = 8;  ///< lights along a side; the map has eight times as many texels
    BounceMode mode = BounceMode::diffuse;
    float gain = 1;  ///< of artist mode
    /// Lights end where all of a map's together would give less than this irradiance (linear).
    float cutoff = 0.03f;
};

/// Spotlights that ask for one bounce, as indices into Scene::lights.
[[nodiscard]] std::vector<std::size_t> bouncing_lights(const Scene& scene);

/// What a spotlight sees, as a picture: its cone, square.
[[nodiscard]] View reflective_view(const Light& light, const BounceOptions& options);

/// What a light shines on (albedo, view_z and normal, of the size of `view`).
struct ReflectiveMap {
    std::size_t light = 0;  ///< index into Scene::lights
    View view;
    SurfaceTargets surface;
};

/// One bounce of light: each block of 8 x 8 texels of each map becomes one light that stands for
/// what the block returns: the sum over its texels of intensity, solid angle and albedo (GPU Pro 4,
/// Forward+, 5.5, whose flux, cone and falloff are not printed). It stands where the block's median
/// texel by flux is, never between two surfaces; a block that returns nothing is dark. To be handed
/// to add_light_lists(); `view` is the lists' view.
[[nodiscard]] SpawnedLights spawn_bounces(const Scene& scene, const View& view,
                                          std::vector<ReflectiveMap> maps,
                                          const BounceOptions& options);

}  // namespace kino
