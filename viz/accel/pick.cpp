#include "viz/accel/pick.h"

#include <cmath>
#include <glm/geometric.hpp>

#include "base/check.h"
#include "viz/accel/traverse.h"

namespace kino {

WorldRay ray_through_pixel(const View& view, const glm::dvec2& pixel) {
    const Projection& k = view.projection;
    const glm::dvec3 in_view((pixel.x - k.cx) / k.fx, (pixel.y - k.cy) / k.fy, 1);
    return {view.world_from_view.translation, view.world_from_view.rotation * in_view};
}

std::optional<Pick> pick(const TriangleSoup& soup, const Bvh& tree, const WorldRay& ray,
                         double reach_m) {
    KINO_CHECK_EQ(tree.triangles.size(), soup.triangles.size());
    const double length = glm::length(ray.direction);
    if (!(length > 0) || !std::isfinite(length)) return std::nullopt;
    const glm::dvec3 direction = ray.direction / length;
    const RayHit hit = closest_hit(tree, {.origin = ray.origin - soup.center,
                                          .direction = direction,
                                          .t_max = static_cast<float>(reach_m)});
    if (!hit.hit()) return std::nullopt;
    // Weights of the corners are more exact than the ray's equation.
    const Triangle& t = soup.triangles[hit.triangle];
    const glm::dvec3 a = t.a;
    const glm::dvec3 ab = glm::dvec3(t.b) - a;
    const glm::dvec3 ac = glm::dvec3(t.c) - a;
    Pick found{.source = soup.sources[hit.triangle]};
    found.place = a + double{hit.v} * ab + double{hit.w} * ac + soup.center;
    found.normal = glm::normalize(glm::cross(ab, ac));
    if (glm::dot(found.normal, direction) > 0) found.normal = -found.normal;
    found.distance_m = glm::distance(found.place, ray.origin);
    return found;
}

}  // namespace kino
