#include "apps/viewer/scene_place.h"

#include <algorithm>
#include <array>

namespace kino {
namespace {

double median(std::vector<double>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

}  // namespace

ScenePlace measure_place(const ProcessedFrame& frame) {
    constexpr int kStride = 8;
    ScenePlace place;
    place.world_from_depth = frame.set.world_from_depth;
    std::array<std::vector<double>, 3> axes;
    const DepthSurface& surface = *frame.surface;
    for (int y = kStride / 2; y < surface.depth_m.height(); y += kStride) {
        for (int x = kStride / 2; x < surface.depth_m.width(); x += kStride) {
            const double z = surface.depth_m.at(x, y);
            const RayXy ray = surface.rays->at(x, y);
            if (!(z > 0) || !(ray.x == ray.x) || !(ray.y == ray.y)) continue;
            axes[0].push_back(ray.x * z);
            axes[1].push_back(ray.y * z);
            axes[2].push_back(z);
        }
    }
    glm::dvec3 center(0, 0, 2);
    if (!axes[2].empty()) center = {median(axes[0]), median(axes[1]), median(axes[2])};
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
