#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "skeleton/synthetic/primitive.h"

namespace kino {

/// The room is a box seen from inside, world space: the origin is on the floor below the camera,
/// which looks towards -z.
struct RoomBox {
    glm::dvec3 min_m{-2.1, 0.0, -4.4};
    glm::dvec3 max_m{2.1, 2.7, 0.7};
};

/// Furniture and what stands on it, world space; always the same.
[[nodiscard]] std::vector<Primitive> make_furniture();

}  // namespace kino
