#include "apps/viewer/picture_work.h"

#include <algorithm>
#include <cmath>

namespace kino {
namespace {

/// Of a pixel's shading so much is done whatever lights there are, in lights.
constexpr double kUnlit = 0.5;

/// Share of [0, size) that [at - half, at + half] covers, pixel centres at integers.
double covered(double at, double half, int size) {
    const double first = std::clamp(at - half + 0.5, 0.0, static_cast<double>(size));
    const double last = std::clamp(at + half + 0.5, 0.0, static_cast<double>(size));
    return (last - first) / size;
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
    if (!(seen.z > -radius)) return 0;
    if (glm::dot(seen, seen) <= radius * radius || seen.z < 0.1 * radius) return 1;
    const Projection& p = view.projection;
    // Of a sphere the outline is seen a little larger than its middle plane.
    const double half = radius / std::sqrt(std::max(1e-6, glm::dot(seen, seen) - radius * radius));
    return covered(p.fx * seen.x / seen.z + p.cx, p.fx * half, view.width) *
           covered(p.fy * seen.y / seen.z + p.cy, p.fy * half, view.height);
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
