#include "apps/viewer/picture_work.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace kino {
namespace {

/// Of a pixel's shading so much is done whatever lights there are, in lights.
constexpr double kUnlit = 0.5;

/// Share of [0, size) px in which a sphere is seen along one axis of the picture: between the two
/// tangents from the eye, `side` and `ahead` being its centre's place.
double seen_along(double side, double ahead, double radius, double f, double c, int size) {
    constexpr double kRight = std::numbers::pi / 2;
    const double away = std::hypot(side, ahead);
    if (away <= radius) return 1;
    const double middle = std::atan2(side, ahead);
    const double half = std::asin(radius / away);
    if (middle - half >= kRight || middle + half <= -kRight) return 0;
    const auto pixel = [&](double angle) {
        if (std::abs(angle) >= kRight) return angle > 0 ? static_cast<double>(size) : 0.0;
        return std::clamp(f * std::tan(angle) + c + 0.5, 0.0, static_cast<double>(size));
    };
    return (pixel(middle + half) - pixel(middle - half)) / size;
}

double share_lit(const Light& light, const View& view) {
    if (light.kind == LightKind::directional) return 1;
    glm::dvec3 center = light.position;
    double radius = light.radius_m;
    if (light.kind == LightKind::spot && light.outer_rad < 0.7f) {
        // Narrow cones fit into the sphere about the middle of their axis.
        center += 0.5 * radius * glm::normalize(light.direction);
        radius *= 0.5 / std::cos(light.outer_rad);
    }
    const Pose& pose = view.world_from_view;
    const glm::dvec3 seen = glm::conjugate(pose.rotation) * (center - pose.translation);
    if (!(radius > 0) || seen.z <= -radius) return 0;
    const Projection& p = view.projection;
    return seen_along(seen.x, seen.z, radius, p.fx, p.cx, view.width) *
           seen_along(seen.y, seen.z, radius, p.fy, p.cy, view.height);
}

}  // namespace

PictureWork count_work(const Scene& scene, const View& view) {
    PictureWork work{.lights = kUnlit, .triangles = 0};
    if (view.width > 0 && view.height > 0) {
        for (const Light& light : scene.lights) {
            const double share = share_lit(light, view);
            if (std::isfinite(share)) work.lights += share;
        }
    }
    for (const MeshNode& node : scene.meshes) {
        if (node.mesh) work.triangles += static_cast<double>(node.mesh->indices.size()) / 3;
    }
    return work;
}

}  // namespace kino
