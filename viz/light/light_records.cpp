#include "viz/light/light_records.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>

namespace kino {
namespace {

bool all_finite(const glm::dvec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

// Wider cones are told from spheres by nothing worth a test.
constexpr double kWidestCone = 1.5;

shared::LightRecord record_of(const Light& light, const Pose& view_from_world) {
    shared::LightRecord record{};
    record.kind = light.kind == LightKind::directional ? 0 : light.kind == LightKind::point ? 1 : 2;
    record.place = light.kind == LightKind::directional
                       ? view_from_world.rotation * -glm::normalize(light.direction)
                       : view_from_world * light.position;
    record.color = light.color;
    record.radius = light.radius_m;
    record.cone_cos = -2;  // everything is inside
    record.cone_scale = 1;
    if (light.kind == LightKind::spot) {
        record.axis = view_from_world.rotation * glm::normalize(light.direction);
        const double outer = std::clamp(double{light.outer_rad}, 1e-3, glm::pi<double>());
        const double inner = std::clamp(double{light.inner_rad}, 0.0, outer);
        record.cone_cos = static_cast<float>(std::cos(outer));
        record.cone_scale =
            static_cast<float>(1 / std::max(std::cos(inner) - std::cos(outer), 1e-4));
    }
    record.material_mask = light.material_mask;
    record.casts_shadow = light.shadow == LightShadow::raycast ? 1 : 0;
    return record;
}

/// Smallest sphere round all that the light can reach: for a spot, round its cone.
shared::LightVolume volume_of(const Light& light, const Pose& view_from_world) {
    glm::dvec3 center = view_from_world * light.position;
    double radius = light.radius_m;
    if (light.kind == LightKind::spot && light.outer_rad < glm::half_pi<float>()) {
        const double half = std::max(double{light.outer_rad}, 1e-3);
        const glm::dvec3 axis = view_from_world.rotation * glm::normalize(light.direction);
        if (half > glm::quarter_pi<double>()) {
            center += axis * (radius * std::cos(half));
            radius *= std::sin(half);
        } else {
            radius *= 0.5 / std::cos(half);
            center += axis * radius;
        }
    }
    // Positions are rounded to float here and pixels' positions in the shader: a few units in the
    // last place of the distance, ten times over.
    const double wider = radius + 1e-5 * light.radius_m + 2e-6 * glm::length(center);
    return {.center = center, .radius = std::nextafter(static_cast<float>(wider), HUGE_VALF)};
}

double power(const Light& light) {
    return double{std::max({light.color.r, light.color.g, light.color.b})} * light.radius_m;
}

}  // namespace

bool is_usable(const Light& light) {
    if (!all_finite(light.color)) return false;
    if (light.kind != LightKind::point &&
        !(all_finite(light.direction) && glm::length(light.direction) > 0)) {
        return false;
    }
    if (light.kind == LightKind::directional) return true;
    if (light.kind == LightKind::spot && !(std::isfinite(light.inner_rad) &&
                                           std::isfinite(light.outer_rad) && light.outer_rad > 0)) {
        return false;
    }
    return all_finite(light.position) && std::isfinite(light.radius_m) && light.radius_m > 0;
}

PackedLights pack_lights(const Scene& scene, const View& view, std::uint32_t list_capacity,
                         std::uint32_t parts) {
    const Pose view_from_world = inverse(view.world_from_view);
    PackedLights packed;
    std::vector<std::uint32_t> order;
    for (std::uint32_t i = 0; i < scene.lights.size(); ++i) {
        const Light& light = scene.lights[i];
        if ((part_of(light) & parts) == 0) continue;
        if (!is_usable(light)) {
            ++packed.check.dropped;
            continue;
        }
        order.push_back(i);
        ++(light.kind == LightKind::directional ? packed.global_count : packed.local_count);
        packed.has_spots |= light.kind == LightKind::spot;
        packed.has_masks |= light.material_mask != ~0u;
    }
    const bool by_power = packed.local_count > list_capacity;
    const auto rank = [&](std::uint32_t i) {
        const Light& light = scene.lights[i];
        return light.kind == LightKind::directional ? 0 : light.shadow != LightShadow::none ? 1 : 2;
    };
    std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
        if (rank(a) != rank(b)) return rank(a) < rank(b);
        return by_power && rank(a) != 0 && power(scene.lights[a]) > power(scene.lights[b]);
    });
    for (const std::uint32_t i : order) {
        const Light& light = scene.lights[i];
        packed.records.push_back(record_of(light, view_from_world));
        packed.records.back().scene_index = i;
        if (light.kind != LightKind::directional) {
            packed.volumes.push_back(volume_of(light, view_from_world));
        }
    }
    return packed;
}

std::vector<shared::LightRecord> lights_in_view(const Scene& scene, const View& view) {
    const Pose view_from_world = inverse(view.world_from_view);
    std::vector<shared::LightRecord> records;
    for (const Light& light : scene.lights) {
        if (!is_usable(light) || (light.material_mask & 1u) == 0) continue;
        records.push_back(record_of(light, view_from_world));
    }
    return records;
}

}  // namespace kino
