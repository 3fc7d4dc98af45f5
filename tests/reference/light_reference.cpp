#include "tests/reference/light_reference.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>

namespace kino::reference {
namespace {

using glm::dvec3;

bool finite3(const dvec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

bool valid(const Light& light) {
    if (!finite3(light.color)) return false;
    const bool aims = light.kind != LightKind::point;
    if (aims && !(finite3(light.direction) && glm::dot(light.direction, light.direction) > 0)) {
        return false;
    }
    if (light.kind == LightKind::spot && !(std::isfinite(light.inner_rad) &&
                                           std::isfinite(light.outer_rad) && light.outer_rad > 0)) {
        return false;
    }
    return light.kind == LightKind::directional ||
           (finite3(light.position) && std::isfinite(light.radius_m) && light.radius_m > 0);
}

double linear_of(std::uint8_t srgb) {
    const double c = srgb / 255.0;
    return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

/// Light a lobe returns towards v for a unit of light along l; n.l included, pi taken out.
dvec3 returned(const Lobe& lobe, const dvec3& base, const dvec3& n, const dvec3& v,
               const dvec3& l) {
    const double nl = std::max(glm::dot(n, l), 0.0);
    const double nv = glm::dot(n, v);
    const dvec3 color(lobe.color);
    const double rough = std::max(double{lobe.roughness}, 0.02);
    switch (lobe.kind) {
        case LobeKind::lambert:
            return base * color * nl;
        case LobeKind::oren_nayar: {
            const double s2 = rough * rough;
            const double a = 1 - 0.5 * s2 / (s2 + 0.33);
            const double b = 0.45 * s2 / (s2 + 0.09);
            const double facing = std::max(nv, 0.0);
            const double s = glm::dot(l, v) - nl * facing;
            const double t = s > 0 ? std::max({nl, facing, 1e-4}) : 1.0;
            return base * color * (nl * std::max(a + b * s / t, 0.0));
        }
        case LobeKind::ggx: {
            if (!(nl > 0)) return dvec3(0);
            const double a2 = std::pow(rough, 4);
            const dvec3 h = glm::normalize(v + l);
            const double nh = std::clamp(glm::dot(n, h), 0.0, 1.0);
            const double facing = std::max(nv, 1e-4);
            const double d = a2 / (glm::pi<double>() * std::pow(nh * nh * (a2 - 1) + 1, 2));
            const auto lambda = [&](double c) {
                return (std::sqrt(1 + a2 * (1 - c * c) / (c * c)) - 1) / 2;
            };
            const double g = 1 / (1 + lambda(nl) + lambda(facing));
            const double f = std::pow(1 - std::clamp(glm::dot(v, h), 0.0, 1.0), 5);
            const dvec3 fresnel = color + (dvec3(1) - color) * f;
            return fresnel * (d * g / (4 * nl * facing) * nl * glm::pi<double>());
        }
        case LobeKind::rim:
            return color * (nl * std::pow(std::clamp(1 - nv, 0.0, 1.0), 1 / rough));
    }
    return dvec3(0);
}

std::vector<MaterialLayer> layers_of(const Scene& scene, std::uint32_t material) {
    if (material > 0 && !scene.materials[material - 1].layers.empty()) {
        return scene.materials[material - 1].layers;
    }
    return {MaterialLayer{.lobes = {Lobe{}}}};
}

/// The layer and all below it.
template <class LobeLight>
dvec3 through(const std::vector<MaterialLayer>& layers, std::size_t i, const LobeLight& light) {
    if (i >= layers.size()) return dvec3(0);
    dvec3 sum(0);
    for (const Lobe& lobe : layers[i].lobes) sum += double{lobe.weight} * light(lobe);
    return sum + dvec3(layers[i].transmission) * through(layers, i + 1, light);
}

}  // namespace

bool light_reaches(const Light& light, const dvec3& world) {
    if (!valid(light)) return false;
    if (light.kind == LightKind::directional) return true;
    const dvec3 way = world - light.position;
    const double distance = glm::length(way);
    if (!(distance < light.radius_m)) return false;
    if (light.kind == LightKind::point || distance == 0) return true;
    return glm::dot(way, glm::normalize(light.direction)) >
           distance * std::cos(double{light.outer_rad});
}

dvec3 world_point(const View& view, int x, int y, double z_m) {
    const Projection& k = view.projection;
    return view.world_from_view * dvec3((x - k.cx) / k.fx * z_m, (y - k.cy) / k.fy * z_m, z_m);
}

ExactLists exact_lists(const Scene& scene, const View& view, const Image<float>& view_z_m,
                       int tile_px, int step) {
    ExactLists lists;
    lists.tiles_x = (view_z_m.width() + tile_px - 1) / tile_px;
    lists.tiles_y = (view_z_m.height() + tile_px - 1) / tile_px;
    lists.needed.resize(static_cast<std::size_t>(lists.tiles_x * lists.tiles_y));
    std::vector<dvec3> points;
    double pixels = 0;
    double reaching = 0;
    double lit_tiles = 0;
    double listed = 0;
    for (int ty = 0; ty < lists.tiles_y; ++ty) {
        for (int tx = 0; tx < lists.tiles_x; ++tx) {
            points.clear();
            for (int y = ty * tile_px; y < std::min((ty + 1) * tile_px, view_z_m.height());
                 y += step) {
                for (int x = tx * tile_px; x < std::min((tx + 1) * tile_px, view_z_m.width());
                     x += step) {
                    const float z = view_z_m.at(x, y);
                    if (z > 0) points.push_back(world_point(view, x, y, z));
                }
            }
            if (points.empty()) continue;
            auto& needed = lists.needed[static_cast<std::size_t>(ty * lists.tiles_x + tx)];
            for (std::uint32_t i = 0; i < scene.lights.size(); ++i) {
                const Light& light = scene.lights[i];
                if (light.kind == LightKind::directional) continue;
                const auto count = std::count_if(points.begin(), points.end(), [&](const dvec3& p) {
                    return light_reaches(light, p);
                });
                if (count > 0) needed.push_back(i);
                reaching += static_cast<double>(count);
            }
            pixels += static_cast<double>(points.size());
            lit_tiles += 1;
            listed += static_cast<double>(needed.size());
        }
    }
    lists.mean_per_pixel = pixels > 0 ? reaching / pixels : 0;
    lists.mean_per_tile = lit_tiles > 0 ? listed / lit_tiles : 0;
    return lists;
}

dvec3 shaded(const Scene& scene, const View& view, const LitSurface& surface, int x, int y) {
    const Rgba8 seen = surface.albedo.at(x, y);
    const dvec3 base(linear_of(seen.r), linear_of(seen.g), linear_of(seen.b));
    if (seen.a == 0) return base;
    const std::uint32_t material = surface.object.empty() ? 0 : surface.object.at(x, y) >> 16;
    const dvec3 at = world_point(view, x, y, surface.view_z_m.at(x, y));
    const dvec3 n = view.world_from_view.rotation * glm::normalize(dvec3(surface.normal.at(x, y)));
    const dvec3 v = glm::normalize(view.world_from_view.translation - at);
    const std::vector<MaterialLayer> layers = layers_of(scene, material);
    dvec3 color(0);
    if (material == 0 && scene.color_mode != ColorMode::relit) {
        color += base;
        if (scene.color_mode == ColorMode::captured) return color;
    } else {
        color += dvec3(scene.ambient) * base * through(layers, 0, [](const Lobe& lobe) {
                     const bool diffuse =
                         lobe.kind == LobeKind::lambert || lobe.kind == LobeKind::oren_nayar;
                     return diffuse ? dvec3(lobe.color) : dvec3(0);
                 });
    }
    if (material > 0) color += dvec3(scene.materials[material - 1].emission);
    for (const Light& light : scene.lights) {
        if (!light_reaches(light, at) || (light.material_mask >> material & 1u) == 0) continue;
        dvec3 arriving(light.color);
        dvec3 l = light.direction;
        if (light.kind == LightKind::directional) {
            l = -glm::normalize(light.direction);
        } else {
            const double d2 = std::max(glm::dot(light.position - at, light.position - at), 1e-6);
            l = (light.position - at) / std::sqrt(d2);
            const double r = light.radius_m;
            const double inside = std::max(1 - std::pow(d2 / (r * r), 2), 0.0);
            arriving *= inside * inside / std::max(d2, 0.01);
        }
        if (light.kind == LightKind::spot) {
            const double outer = std::cos(double{light.outer_rad});
            const double inner =
                std::cos(std::min(double{light.inner_rad}, double{light.outer_rad}));
            const double along = -glm::dot(l, glm::normalize(light.direction));
            const double t = std::clamp((along - outer) / std::max(inner - outer, 1e-4), 0.0, 1.0);
            arriving *= t * t;
        }
        color += arriving * through(layers, 0, [&](const Lobe& lobe) {
                     return returned(lobe, base, n, v, l);
                 });
    }
    return color;
}

}  // namespace kino::reference
