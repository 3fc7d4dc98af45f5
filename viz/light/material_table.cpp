#include "viz/light/material_table.h"

#include <algorithm>
#include <cmath>

namespace kino {
namespace {

float finite(float v) {
    return std::isfinite(v) ? v : 0.0f;
}
glm::vec3 finite(const glm::vec3& v) {
    return {finite(v.x), finite(v.y), finite(v.z)};
}

void flatten(const Material& material, MaterialTable& table) {
    shared::MaterialRecord record{};
    record.emission = finite(material.emission);
    record.opacity = std::clamp(finite(material.opacity), 0.0f, 1.0f);
    record.first_lobe = static_cast<std::uint32_t>(table.lobes.size());
    glm::vec3 reaching(1);
    for (std::size_t l = 0; l < std::min(material.layers.size(), kMaxLayers); ++l) {
        const MaterialLayer& layer = material.layers[l];
        for (std::size_t i = 0; i < std::min(layer.lobes.size(), kMaxLobes); ++i) {
            const Lobe& lobe = layer.lobes[i];
            const glm::vec3 tint = reaching * finite(lobe.weight);
            const glm::vec3 color = finite(lobe.color);
            if (lobe.kind == LobeKind::lambert) {
                record.diffuse += tint * color;
                record.ambient += tint * color;
                continue;
            }
            if (lobe.kind == LobeKind::oren_nayar) record.ambient += tint * color;
            table.lobes.push_back({.color = tint * color,
                                   .kind = static_cast<std::uint32_t>(lobe.kind),
                                   .grazing = tint * (glm::vec3(1) - color),
                                   .roughness = std::max(finite(lobe.roughness), 0.02f)});
            table.lobe_kinds |= 1u << static_cast<std::uint32_t>(lobe.kind);
            ++record.lobes;
        }
        reaching *= finite(layer.transmission);
    }
    if (material.kind == MaterialKind::toon) {
        // It has no lobes, and its record says so wherever else it is read.
        table.lobes.resize(record.first_lobe);
        record.first_lobe = std::max(material.steps, 1u);
        record.lobes = 0;
    }
    if (material.layers.empty()) record.diffuse = record.ambient = glm::vec3(1);
    table.materials.push_back(record);
}

}  // namespace

MaterialTable flatten_materials(const std::vector<Material>& materials) {
    MaterialTable table;
    flatten(Material{}, table);
    for (std::size_t i = 0; i < std::min(materials.size(), kMaxMaterials - 1); ++i) {
        flatten(materials[i], table);
    }
    return table;
}

}  // namespace kino
