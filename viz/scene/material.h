#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <string>
#include <vector>

#include "base/image.h"

namespace kino {

/// One way of scattering light, with its weight. Values beyond the physical range are allowed on
/// purpose (GPU Pro 4, Forward+, 5.5); only what is not finite is refused.
enum class LobeKind : std::uint8_t {
    lambert,     ///< color
    oren_nayar,  ///< color, roughness (standard deviation of facet slopes, rad)
    ggx,         ///< color: reflectance at normal incidence; roughness (alpha = roughness^2)
    rim          ///< color: light that grazes; roughness: exponent of 1 - n.v is 1 / roughness
};
struct Lobe {
    LobeKind kind = LobeKind::lambert;
    glm::vec3 color{1};  ///< linear; multiplied by the base colour for lambert and oren_nayar
    float weight = 1;
    float roughness = 0.5f;
};

/// What lies on top of what: a layer returns its lobes' light and lets `transmission` of what the
/// layers below return through.
struct MaterialLayer {
    std::vector<Lobe> lobes;  ///< at most kMaxLobes
    glm::vec3 transmission{0};
};

/// Which shader lights a material. Each kind is a pipeline of its own over the same light lists,
/// and exists only where a mesh shows it. Blended surfaces are always layered.
enum class MaterialKind : std::uint8_t {
    layered,  ///< the sum of its layers' lobes
    toon,     ///< light counts in `steps`, outlines are dark; layers do not count
    unlit     ///< base colour and emission, whatever shines on it
};

constexpr std::size_t kMaxLayers = 4;
constexpr std::size_t kMaxLobes = 4;
constexpr std::size_t kMaxMaterials = 32;  ///< one bit each in Light::material_mask

/// Looks of a mesh. Material 0 of every scene is the live picture's own: captured colour as a
/// Lambertian base colour; Scene::materials begin at index 1.
struct Material {
    std::string name;
    glm::vec3 base_color{0.8f};                   ///< linear
    std::shared_ptr<const Image<Rgba8>> texture;  ///< sRGB, multiplies base_color; may be null
    glm::vec3 emission{0};                        ///< linear
    float opacity = 1;                            ///< below 1: blended, drawn after everything
    std::vector<MaterialLayer> layers;            ///< top first; empty: one Lambertian lobe
    MaterialKind kind = MaterialKind::layered;
    std::uint32_t steps = 3;  ///< toon: between dark and white, at least 1
};

}  // namespace kino
