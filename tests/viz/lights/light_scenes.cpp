#include "tests/viz/lights/light_scenes.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "tests/support/random.h"

namespace kino::test {
namespace {

using glm::dvec3;

struct Hit {
    double t = std::numeric_limits<double>::infinity();
    dvec3 normal{0};
    const Solid* solid = nullptr;
};

void cast(const Solid& solid, const dvec3& eye, const dvec3& way, Hit& best) {
    const dvec3 o = eye - solid.center;
    if (solid.kind == Solid::Kind::sphere) {
        const double a = glm::dot(way, way);
        const double b = glm::dot(o, way);
        const double c = glm::dot(o, o) - solid.half.x * solid.half.x;
        const double disc = b * b - a * c;
        if (disc < 0) return;
        const double t = (-b - std::sqrt(disc)) / a;
        if (t > 1e-6 && t < best.t) best = {t, glm::normalize(o + t * way), &solid};
        return;
    }
    double enter = -std::numeric_limits<double>::infinity();
    double leave = -enter;
    int enter_axis = 0;
    int leave_axis = 0;
    for (int k = 0; k < 3; ++k) {
        const double t0 = (-solid.half[k] - o[k]) / way[k];
        const double t1 = (solid.half[k] - o[k]) / way[k];
        if (std::min(t0, t1) > enter) enter = std::min(t0, t1), enter_axis = k;
        if (std::max(t0, t1) < leave) leave = std::max(t0, t1), leave_axis = k;
    }
    const bool room = solid.kind == Solid::Kind::room;
    const double t = room ? leave : enter;
    if (!(enter <= leave) || !(t > 1e-6) || t >= best.t) return;
    dvec3 normal(0);
    const int axis = room ? leave_axis : enter_axis;
    normal[axis] = way[axis] > 0 ? -1 : 1;
    best = {t, normal, &solid};
}

Rgba8 random_color(Random& random) {
    return {static_cast<std::uint8_t>(random.integer(60, 255)),
            static_cast<std::uint8_t>(random.integer(60, 255)),
            static_cast<std::uint8_t>(random.integer(60, 255)), 255};
}

dvec3 random_in(Random& random, const dvec3& half) {
    return {random.real(-half.x, half.x), random.real(-half.y, half.y),
            random.real(-half.z, half.z)};
}

View view_from(const dvec3& eye, const dvec3& target, int width, int height) {
    return {.width = width,
            .height = height,
            .projection = perspective(0.9, width, height),
            .world_from_view = look_at(eye, target)};
}

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

Light point_light(const dvec3& at, double radius, const glm::vec3& color = glm::vec3(0.5f)) {
    return {.kind = LightKind::point,
            .position = at,
            .color = color,
            .radius_m = static_cast<float>(radius)};
}

}  // namespace

reference::LitSurface surface_of(const std::vector<Solid>& solids, const View& view,
                                 bool with_objects) {
    reference::LitSurface surface;
    surface.view_z_m = Image<float>(view.width, view.height, 0.0f);
    surface.normal = Image<glm::vec3>(view.width, view.height, glm::vec3(0, 0, -1));
    surface.albedo = Image<Rgba8>(view.width, view.height, Rgba8{20, 22, 28, 0});
    if (with_objects) surface.object = Image<std::uint32_t>(view.width, view.height, 0u);
    const Pose& from_view = view.world_from_view;
    const glm::dquat to_view = glm::inverse(from_view.rotation);
    for (int y = 0; y < view.height; ++y) {
        for (int x = 0; x < view.width; ++x) {
            const Projection& k = view.projection;
            const dvec3 ray((x - k.cx) / k.fx, (y - k.cy) / k.fy, 1);
            Hit hit;
            for (const Solid& solid : solids) {
                cast(solid, from_view.translation, from_view.rotation * ray, hit);
            }
            if (hit.solid == nullptr) continue;
            surface.view_z_m.at(x, y) = static_cast<float>(hit.t);
            surface.normal.at(x, y) = to_view * hit.normal;
            surface.albedo.at(x, y) = hit.solid->color;
            if (with_objects) surface.object.at(x, y) = hit.solid->material << 16 | 1u;
        }
    }
    return surface;
}

LitScene random_lit_scene(std::uint64_t seed, int width, int height, int lights) {
    Random random(seed);
    LitScene lit;
    lit.name = "random";
    const dvec3 room(random.real(2, 6), random.real(1.5, 3), random.real(3, 8));
    if (random.chance(0.8)) {
        lit.solids.push_back({.kind = Solid::Kind::room, .half = room, .color = {190, 180, 170}});
    }
    for (int i = 0; i < 12; ++i) {
        lit.solids.push_back(
            {.kind = random.chance(0.5) ? Solid::Kind::sphere : Solid::Kind::box,
             .center = random_in(random, room),
             .half = dvec3(random.real(0.1, 0.8), random.real(0.1, 1.5), random.real(0.1, 0.8)),
             .color = random_color(random)});
    }
    const dvec3 eye = random_in(random, 0.7 * room);
    lit.view = view_from(eye, random_in(random, room), width, height);
    // An off-centre window now and then.
    if (random.chance(0.3)) lit.view.projection.cx += random.real(-0.7, 0.7) * width;
    for (int i = 0; i < lights; ++i) {
        Light light = point_light(random_in(random, 1.3 * room), random.real(0.05, 2.0));
        light.color = {random.real(0, 1), random.real(0, 1), random.real(0, 1)};
        if (random.chance(0.02)) light.radius_m = 30;
        if (random.chance(0.3)) {
            light.kind = LightKind::spot;
            light.direction = random_in(random, dvec3(1));
            light.outer_rad = static_cast<float>(random.real(0.05, 1.8));
            light.inner_rad = light.outer_rad * static_cast<float>(random.real(0.2, 1));
        }
        lit.scene.lights.push_back(light);
    }
    lit.scene.color_mode = ColorMode::relit;
    lit.surface = surface_of(lit.solids, lit.view);
    return lit;
}

std::vector<LitScene> adversarial_lit_scenes(int width, int height) {
    std::vector<LitScene> all;
    const auto add = [&](const char* name, auto&& change) {
        LitScene lit;
        lit.name = name;
        lit.scene.color_mode = ColorMode::relit;
        lit.solids = {{.kind = Solid::Kind::room, .half = {3, 2, 5}},
                      {.kind = Solid::Kind::sphere, .center = {0.5, -0.5, -1}, .half = dvec3(0.8)},
                      {.kind = Solid::Kind::box, .center = {-1, -1, 0}, .half = {0.3, 1, 0.3}}};
        lit.view = view_from({0.2, 0.1, 4}, {0, -0.2, -4}, width, height);
        Random random(77);
        for (int i = 0; i < 60; ++i) {
            lit.scene.lights.push_back(
                point_light(random_in(random, {3, 2, 5}), random.real(0.2, 1.2)));
        }
        change(lit, random);
        if (lit.surface.view_z_m.empty()) lit.surface = surface_of(lit.solids, lit.view);
        all.push_back(std::move(lit));
    };
    add("camera inside lights", [](LitScene& lit, Random& random) {
        for (int i = 0; i < 40; ++i) {
            lit.scene.lights.push_back(
                point_light(lit.view.world_from_view.translation + random_in(random, dvec3(0.3)),
                            random.real(0.4, 6)));
        }
    });
    add("one far pixel", [](LitScene& lit, Random&) {
        lit.surface = surface_of(lit.solids, lit.view);
        for (int y = 4; y < lit.view.height; y += 16) {
            for (int x = 5; x < lit.view.width; x += 16) lit.surface.view_z_m.at(x, y) = 900;
        }
        lit.scene.lights.push_back(point_light({0, 0, -895}, 20));
    });
    add("huge radii", [](LitScene& lit, Random& random) {
        for (const double radius : {1e2, 1e4, 1e10, 3e20, 3e38}) {
            lit.scene.lights.push_back(point_light(random_in(random, {3, 2, 5}), radius));
            lit.scene.lights.push_back(point_light({0.9 * std::min(radius, 1e15), 0, 0}, radius));
        }
    });
    add("tiny radii", [](LitScene& lit, Random& random) {
        lit.surface = surface_of(lit.solids, lit.view);
        for (int i = 0; i < 200; ++i) {
            const int x = random.integer(0, lit.view.width - 1);
            const int y = random.integer(0, lit.view.height - 1);
            const dvec3 at = reference::world_point(lit.view, x, y, lit.surface.view_z_m.at(x, y));
            lit.scene.lights.push_back(point_light(at + random_in(random, dvec3(1e-3)), 2e-3));
        }
    });
    add("thousands in one tile", [](LitScene& lit, Random& random) {
        lit.surface = surface_of(lit.solids, lit.view);
        const int x = lit.view.width / 2;
        const int y = lit.view.height / 2;
        const dvec3 at = reference::world_point(lit.view, x, y, lit.surface.view_z_m.at(x, y));
        for (int i = 0; i < 2000; ++i) {
            lit.scene.lights.push_back(point_light(at + random_in(random, dvec3(0.02)), 0.08));
        }
    });
    add("not a number", [](LitScene& lit, Random&) {
        lit.scene.lights.push_back(point_light({kNan, 0, 0}, 1));
        lit.scene.lights.push_back(point_light({0, kInf, 0}, 1));
        lit.scene.lights.push_back(point_light({0, 0, 0}, kNan));
        lit.scene.lights.push_back(point_light({0, 0, 0}, kInf));
        lit.scene.lights.push_back(point_light({0, 0, 0}, 0));
        lit.scene.lights.push_back(point_light({0, 0, 0}, -1));
        lit.scene.lights.push_back(
            point_light({0, 0, 0}, 1, glm::vec3(std::numeric_limits<float>::quiet_NaN())));
        lit.scene.lights.push_back({.kind = LightKind::spot, .direction = {0, 0, 0}});
    });
    add("empty tiles", [](LitScene& lit, Random&) {
        lit.solids.erase(lit.solids.begin());
        lit.surface = surface_of(lit.solids, lit.view);
    });
    add("nothing at all", [](LitScene& lit, Random&) {
        lit.solids.clear();
        lit.surface = surface_of(lit.solids, lit.view);
    });
    add("all at one depth", [](LitScene& lit, Random& random) {
        lit.surface = surface_of(lit.solids, lit.view);
        lit.surface.view_z_m.fill(3.0f);
        for (int i = 0; i < 100; ++i) {
            lit.scene.lights.push_back(point_light(
                lit.view.world_from_view * (random_in(random, {2, 1, 0.5}) + dvec3(0, 0, 3)), 0.5));
        }
    });
    add("lights that touch", [](LitScene& lit, Random& random) {
        // Spheres that end within a few units in the last place of a pixel's point.
        lit.surface = surface_of(lit.solids, lit.view);
        for (int i = 0; i < 300; ++i) {
            const int x = random.integer(0, lit.view.width - 1);
            const int y = random.integer(0, lit.view.height - 1);
            const dvec3 at = reference::world_point(lit.view, x, y, lit.surface.view_z_m.at(x, y));
            const dvec3 way = glm::normalize(random_in(random, dvec3(1)));
            const double radius = random.real(0.1, 3);
            lit.scene.lights.push_back(point_light(at + way * radius * (1 - 1e-7), radius));
        }
    });
    add("far from the origin", [](LitScene& lit, Random&) {
        const dvec3 away(1e5, -2e4, 3e5);
        lit.view.world_from_view.translation += away;
        for (Solid& solid : lit.solids) solid.center += away;
        for (Light& light : lit.scene.lights) light.position += away;
    });
    add("a world of a thousandth", [](LitScene& lit, Random&) {
        lit.surface = surface_of(lit.solids, lit.view);
        for (float& z : lit.surface.view_z_m.pixels()) z *= 1e-3f;
        for (Light& light : lit.scene.lights) {
            light.position = lit.view.world_from_view.translation +
                             1e-3 * (light.position - lit.view.world_from_view.translation);
            light.radius_m *= 1e-3f;
        }
    });
    return all;
}

LitScene source_scene(int width, int height, int lights, double wanted_mean) {
    LitScene lit;
    lit.name = "source scene";
    lit.scene.color_mode = ColorMode::relit;
    lit.scene.ambient = glm::vec3(0.02f);
    const dvec3 half(8, 3, 14);
    lit.solids.push_back({.kind = Solid::Kind::room, .half = half, .color = {200, 195, 185}});
    Random random(5);
    for (int i = 0; i < 40; ++i) {
        const bool ball = i % 2 == 0;
        lit.solids.push_back(
            {.kind = ball ? Solid::Kind::sphere : Solid::Kind::box,
             .center = {random.real(-7, 7), ball ? -2.2 : -1.5, random.real(-13, 10)},
             .half = ball ? dvec3(0.8) : dvec3(0.35, 1.5, 0.35),
             .color = random_color(random)});
    }
    lit.view = view_from({0, 0.6, 13}, {0, -1, -4}, width, height);
    for (int i = 0; i < lights; ++i) {
        lit.scene.lights.push_back(
            point_light(random_in(random, half), 1,
                        {random.real(0.1, 1), random.real(0.1, 1), random.real(0.1, 1)}));
    }
    lit.surface = surface_of(lit.solids, lit.view);
    double low = 0.05;
    double high = 8;
    for (int i = 0; i < 12; ++i) {
        const double radius = 0.5 * (low + high);
        for (Light& light : lit.scene.lights) light.radius_m = static_cast<float>(radius);
        const double mean =
            reference::exact_lists(lit.scene, lit.view, lit.surface.view_z_m, 64, 16)
                .mean_per_pixel;
        (mean < wanted_mean ? low : high) = radius;
    }
    // What is left at the radius without the smooth end is a 256th: I / r^2 = eps.
    for (Light& light : lit.scene.lights) {
        light.color *= light.radius_m * light.radius_m / 256.0f;
    }
    return lit;
}

LitScene colonnade(int width, int height, int lights) {
    LitScene lit;
    lit.name = "colonnade";
    lit.scene.color_mode = ColorMode::relit;
    lit.solids.push_back(
        {.kind = Solid::Kind::room, .half = {12, 4, 16}, .color = {200, 190, 180}});
    for (int i = 0; i < 24; ++i) {
        lit.solids.push_back({.kind = Solid::Kind::box,
                              .center = {-5.75 + 0.5 * i, 0, 12},
                              .half = {0.1, 4, 0.1},
                              .color = {180, 170, 150}});
    }
    lit.view = view_from({0, 0, 15}, {0, 0, -16}, width, height);
    Random random(9);
    for (int i = 0; i < lights; ++i) {
        lit.scene.lights.push_back(
            point_light({random.real(-9, 9), random.real(-3.5, 3.5), random.real(-13, 9.5)}, 1.2,
                        {random.real(0.1, 1), random.real(0.1, 1), random.real(0.1, 1)}));
    }
    lit.surface = surface_of(lit.solids, lit.view);
    return lit;
}

double radius_of(double intensity, double eps) {
    return std::sqrt(intensity / eps);
}

}  // namespace kino::test
