#include "tests/skeleton/actors/mesh_reference.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

namespace kino::test {

using glm::dvec3;

MeshHit hit_mesh(const ActorBody& body, const std::vector<glm::vec3>& view_m, double x, double y) {
    MeshHit nearest;
    const dvec3 ray(x, y, 1);
    for (std::size_t i = 0; i < body.triangles.size(); ++i) {
        const auto& t = body.triangles[i];
        const dvec3 a(view_m[t[0]]), b(view_m[t[1]]), c(view_m[t[2]]);
        const dvec3 e1 = b - a, e2 = c - a;
        const bool faces = glm::dot(glm::cross(e1, e2), a) < 0;
        if (!faces && i < body.first_two_sided) continue;
        const dvec3 p = glm::cross(ray, e2);
        const double det = glm::dot(e1, p);
        if (det == 0) continue;
        const double u = glm::dot(-a, p) / det;
        const dvec3 q = glm::cross(-a, e1);
        const double v = glm::dot(ray, q) / det;
        if (u < 0 || v < 0 || u + v > 1) continue;
        const double z = glm::dot(e2, q) / det;
        if (z > 0 && (nearest.part < 0 || z < nearest.z_m)) {
            nearest = {z, static_cast<int>(body.part[i])};
        }
    }
    return nearest;
}

double winding_number(const ActorBody& body, const std::vector<glm::vec3>& points_m,
                      const dvec3& at_m) {
    double sum = 0;
    for (std::size_t i = 0; i < body.first_two_sided; ++i) {
        const auto& t = body.triangles[i];
        const dvec3 a = dvec3(points_m[t[0]]) - at_m, b = dvec3(points_m[t[1]]) - at_m,
                    c = dvec3(points_m[t[2]]) - at_m;
        const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
        const double numerator = glm::dot(a, glm::cross(b, c));
        const double denominator =
            la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb;
        sum += 2 * std::atan2(numerator, denominator);
    }
    return sum / (4 * std::numbers::pi);
}

double distance_to_mesh(const std::vector<glm::vec3>& points_m, const dvec3& at_m) {
    double nearest = 1e9;
    for (const glm::vec3& p : points_m) nearest = std::min(nearest, glm::distance(dvec3(p), at_m));
    return nearest;
}

}  // namespace kino::test
