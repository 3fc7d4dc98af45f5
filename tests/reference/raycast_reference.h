#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "base/image.h"
#include "skeleton/synthetic/scene.h"

namespace kino::reference {

/// First surface on a ray. Ids as in skeleton/synthetic/visibility.h; -1 is nothing.
struct RayHit {
    double t = 0;
    std::int32_t id = -1;
};

/// Every solid of the scene at one moment: furniture, then (after six numbers for the room) person.
struct RaycastWorld {
    const SyntheticScene* scene = nullptr;
    std::vector<Primitive> solids;
    std::vector<glm::dmat3> to_local;  ///< inverses of the solids' axes
    std::vector<std::int32_t> ids;
};
[[nodiscard]] RaycastWorld raycast_world(const SyntheticScene& scene, double t_s);

/// Where origin + t direction, t > `from`, first enters the solid; infinity if it does not. A round
/// cone is taken as what it is, a union of balls: the entry is the least of theirs, found by golden
/// section along the axis. World space, any length of direction.
[[nodiscard]] double enter_solid(const Primitive& solid, const glm::dmat3& to_local,
                                 const glm::dvec3& origin, const glm::dvec3& direction,
                                 double from);

[[nodiscard]] RayHit cast_ray(const RaycastWorld& world, const glm::dvec3& origin,
                              const glm::dvec3& direction);

struct RaycastPicture {
    Image<double> depth_m;  ///< along the axis; 0 = nothing
    Image<std::int32_t> id;
    Image<std::uint8_t> lit;   ///< 1 where the projector reaches the surface
    Image<std::uint16_t> raw;  ///< noiseless reading
};

/// The depth camera's picture, pixel by pixel, every solid tried for every ray, in double.
[[nodiscard]] RaycastPicture raycast_depth(const SyntheticScene& scene, double t_s);

}  // namespace kino::reference
