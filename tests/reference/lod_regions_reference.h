#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "base/image.h"

namespace kino::reference {

/// Which tiles of a level are shaded finer, a tile at a time in double precision. Written from the
/// contract of viz/quality/lod_regions.h.

/// A texel of the coarse level.
struct RegionCoarse {
    double luminance = 0;  ///< of light as shown, over the texel's own
    double color = 0;      ///< luminance of its colour
    double z = 0;          ///< metres; 0: nothing there
    glm::dvec2 slope{0};   ///< normal's x and y over its part towards the viewer
};
/// And of the fine one.
struct RegionFine {
    double z = 0;
    glm::dvec3 normal{0, 0, -1};
    glm::dvec2 slope{0};
};

struct RegionRules {
    double sigma_z = 0.02, sigma_n = 0.25;
    double confidence = 0.05;
    double fx = 1, fy = 1, cx = 0, cy = 0;  ///< of the fine view
    bool bend = false;
};

struct RegionFinding {
    double change = 0;  ///< largest of light between neighbours of one surface
    int doubtful = 0;   ///< fine texels that no coarse one resembles
    int area = 0;
};

/// The tile of `side` fine texels at `tile`. Coarse texel j stands at fine lod_place(j)
/// (lod_reference.h).
[[nodiscard]] RegionFinding find_region(const Image<RegionCoarse>& coarse,
                                        const Image<RegionFine>& fine, const glm::ivec2& tile,
                                        int side, const RegionRules& rules);

}  // namespace kino::reference
