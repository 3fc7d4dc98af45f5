#include "apps/viewer/scene_place.h"

#include <algorithm>
#include <cmath>

namespace kino {
namespace {

/// The value that a share `q` of the values lie below; reorders them.
double quantile(std::vector<double>& values, double q) {
    const auto at =
        values.begin() + static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

}  // namespace

ScenePlace measure_place(const ProcessedFrame& frame) {
    constexpr int kStride = 8;
    ScenePlace place;
    place.world_from_depth = frame.set.world_from_depth;
    std::vector<double> rays_x, rays_y, depths;
    const DepthSurface& surface = *frame.surface;
    for (int y = kStride / 2; y < surface.depth_m.height(); y += kStride) {
        for (int x = kStride / 2; x < surface.depth_m.width(); x += kStride) {
            const double z = surface.depth_m.at(x, y);
            const RayXy ray = surface.rays->at(x, y);
            if (!(z > 0) || !std::isfinite(ray.x) || !std::isfinite(ray.y)) continue;
            rays_x.push_back(ray.x);
            rays_y.push_back(ray.y);
            depths.push_back(z);
        }
    }
    glm::dvec3 center(0, 0, 2);
    if (!depths.empty()) {
        const auto middle = [](std::vector<double>& values) {
            return 0.5 * (quantile(values, 0.02) + quantile(values, 0.98));
        };
        center = quantile(depths, 0.5) * glm::dvec3(middle(rays_x), middle(rays_y), 1);
    }
    place.distance_m = glm::length(center);
    place.center = place.world_from_depth * center;
    return place;
}

std::vector<Light> studio_lights(const ScenePlace& place) {
    const glm::dvec3 right = place.world_from_depth.rotation * glm::dvec3(1, 0, 0);
    const glm::dvec3 up = place.world_from_depth.rotation * glm::dvec3(0, -1, 0);
    const glm::dvec3 back = place.world_from_depth.rotation * glm::dvec3(0, 0, -1);
    const double d = place.distance_m;
    const auto lamp = [&](double x, double y, double z, glm::vec3 color) {
        // Intensity grows with the square of the distance, so rooms of all sizes look alike.
        const auto strength = static_cast<float>(d * d);
        return Light{.kind = LightKind::point,
                     .position = place.center + d * (x * right + y * up + z * back),
                     .color = color * strength,
                     .radius_m = static_cast<float>(2.5 * d)};
    };
    return {{.kind = LightKind::directional,
             .direction = 0.55 * right - 0.75 * up - 0.8 * back,
             .color = {0.85f, 0.82f, 0.78f}},
            lamp(-0.65, 0.25, 0.45, {0.62f, 0.26f, 0.08f}),
            lamp(0.65, 0.15, 0.40, {0.08f, 0.26f, 0.66f})};
}

}  // namespace kino
