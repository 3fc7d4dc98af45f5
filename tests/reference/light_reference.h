#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "base/image.h"
#include "viz/scene/scene.h"
#include "viz/scene/view.h"

namespace kino::reference {

/// One picture's surface in double: what viz/light reads from textures.
struct LitSurface {
    Image<float> view_z_m;        ///< 0: nothing
    Image<glm::vec3> normal;      ///< view space, unit length
    Image<Rgba8> albedo;          ///< sRGB
    Image<std::uint32_t> object;  ///< material << 16; may be empty: material 0
};

/// Whether the light changes anything at a point of the world: nearer than its radius and, for a
/// spot, within its outer cone. Lights that are not finite or without a radius never do.
[[nodiscard]] bool light_reaches(const Light& light, const glm::dvec3& world);

/// The point of the world that a pixel shows.
[[nodiscard]] glm::dvec3 world_point(const View& view, int x, int y, double z_m);

/// For every tile of the picture the local lights that reach one of its pixels, ascending indices
/// into Scene::lights: the exact lists. Every `step`-th pixel of rows and columns is looked at.
struct ExactLists {
    int tiles_x = 0, tiles_y = 0;
    std::vector<std::vector<std::uint32_t>> needed;  ///< by tile, rows first
    double mean_per_pixel = 0;                       ///< over pixels where something is
    double mean_per_tile = 0;                        ///< over tiles where something is
};
[[nodiscard]] ExactLists exact_lists(const Scene& scene, const View& view,
                                     const Image<float>& view_z_m, int tile_px, int step = 1);

/// The colour of a pixel, linear, all lights of the scene summed one after the other. Layers are
/// walked as they are written, not flattened.
[[nodiscard]] glm::dvec3 shaded(const Scene& scene, const View& view, const LitSurface& surface,
                                int x, int y);

}  // namespace kino::reference
