#pragma once

#include <cstdint>
#include <vector>

#include "viz/light/light_lists.h"
#include "viz/light/light_parts.h"
#include "viz/light/light_shared.h"
#include "viz/scene/scene.h"
#include "viz/scene/view.h"

namespace kino {

/// A scene's lights as the device gets them: checked, in view space, ordered. Directional lights
/// come first, then local ones: those with shadows before the others. Where there are more local
/// lights than a list may hold, the brightest come first among their kind, so that what an
/// overflowing list loses is the dimmest. Lights of other parts than `parts` (light_parts.h) are
/// left out, uncounted.
struct PackedLights {
    std::vector<shared::LightRecord> records;
    std::vector<shared::LightVolume> volumes;  ///< of local lights only
    std::uint32_t global_count = 0;
    std::uint32_t local_count = 0;
    LightCheck check;
    bool has_spots = false;
    bool has_masks = false;  ///< some light skips some material
};
[[nodiscard]] PackedLights pack_lights(const Scene& scene, const View& view,
                                       std::uint32_t list_capacity,
                                       std::uint32_t parts = kAllLights);

/// The same in the scene's order, those without light for material 0 left out, for shaders that
/// walk all lights of a picture without meshes.
[[nodiscard]] std::vector<shared::LightRecord> lights_in_view(const Scene& scene, const View& view);

/// False where a light must not reach the device: a component not finite, a local light without a
/// radius, a direction without length.
[[nodiscard]] bool is_usable(const Light& light);

}  // namespace kino
