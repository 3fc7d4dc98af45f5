#pragma once

#include <cstdint>
#include <glm/vec3.hpp>

#include "viz/accel/bvh.h"

namespace kino {

/// A place on a surface, in the soup's space.
struct SurfacePlace {
    glm::vec3 place{0};
    glm::vec3 normal{0, 1, 0};  ///< unit length, to the side that is asked about
};

/// Share of the cosine-weighted hemisphere that sees nothing within `reach_m`: 1 in the open.
/// `rays` directions in a low-discrepancy pattern (Roberts's R2 sequence), turned by `seed`, so the
/// same question has the same answer. What effects on the device are measured by: the error falls
/// faster than 1 / sqrt(rays).
[[nodiscard]] double ambient_openness(const Bvh& bvh, const SurfacePlace& at, float reach_m,
                                      int rays, std::uint32_t seed = 0);

}  // namespace kino
