#pragma once

#include <cstdint>

#include "viz/graph/graph.h"
#include "viz/scene/scene.h"

namespace kino {

/// The scene's materials on the device, as viz/light/shade_surface.glsl reads them.
struct MaterialBuffers {
    graph::BufferId materials;     ///< shared::MaterialRecord
    graph::BufferId lobes;         ///< shared::LobeRecord
    std::uint32_t lobe_kinds = 0;  ///< bit of each LobeKind that is not Lambertian
};
[[nodiscard]] MaterialBuffers add_material_upload(graph::FrameGraph& graph, const Scene& scene);

}  // namespace kino
