#pragma once

#include <vector>

#include "viz/light/light_shared.h"
#include "viz/scene/scene.h"

namespace kino {

/// Materials as shaders read them. A layer passes on a constant share of what the layers below
/// return, so a stack is a sum of lobes, and all its Lambertian lobes are one.
struct MaterialTable {
    std::vector<shared::MaterialRecord> materials;  ///< 0: captured colour as Lambert
    std::vector<shared::LobeRecord> lobes;          ///< other than Lambertian ones
    std::uint32_t lobe_kinds = 0;                   ///< bit of each LobeKind in `lobes`
};
/// What is not finite counts as 0.
[[nodiscard]] MaterialTable flatten_materials(const std::vector<Material>& materials);

}  // namespace kino
