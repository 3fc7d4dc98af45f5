#include "tests/reference/registration_scene.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "tests/reference/camera_reference.h"

namespace kino::reference {
namespace {

glm::dvec3 from_depth(const Pose& color_from_depth, const glm::dvec3& p) {
    return color_from_depth.rotation * p + color_from_depth.translation;
}

glm::dvec3 to_depth(const Pose& color_from_depth, const glm::dvec3& p) {
    return glm::conjugate(color_from_depth.rotation) * (p - color_from_depth.translation);
}

bool inside(const CameraModel& camera, const glm::dvec2& p) {
    return p.x >= -0.5 && p.y >= -0.5 && p.x < camera.width - 0.5 && p.y < camera.height - 0.5;
}

// Whether the way from `eye` to `point` is free up to a micrometre before it.
bool free_way(const RegistrationScene& scene, const glm::dvec3& eye, const glm::dvec3& point) {
    const auto hit = scene.cast(eye, point - eye);
    return hit.object < 0 || hit.t > 1 - 1e-6;
}

// Whether every pixel up to `reach` from a place, and the four around it, shows that object.
bool all_around(const Image<int>& objects, const glm::dvec2& place, double reach, int object) {
    const auto whole = [](double x) { return static_cast<int>(x); };
    for (int y = whole(std::floor(place.y - reach)); y <= std::ceil(place.y + reach); ++y) {
        for (int x = whole(std::floor(place.x - reach)); x <= std::ceil(place.x + reach); ++x) {
            if (!objects.contains(x, y) || objects.at(x, y) != object) return false;
        }
    }
    return true;
}

}  // namespace

RegistrationScene::Hit RegistrationScene::cast(const glm::dvec3& origin,
                                               const glm::dvec3& direction) const {
    Hit best;
    const auto keep = [&](double t, int object) {
        if (t > 1e-9 && (best.object < 0 || t < best.t)) best = {t, object};
    };
    int object = 0;
    for (const Rectangle& r : rectangles) {
        const glm::dvec3 normal = glm::cross(r.half_x, r.half_y);
        const double t = glm::dot(r.centre - origin, normal) / glm::dot(direction, normal);
        const glm::dvec3 at = origin + t * direction - r.centre;
        if (std::abs(glm::dot(at, r.half_x)) <= glm::dot(r.half_x, r.half_x) &&
            std::abs(glm::dot(at, r.half_y)) <= glm::dot(r.half_y, r.half_y)) {
            keep(t, object);
        }
        ++object;
    }
    for (const Ball& b : balls) {
        const glm::dvec3 o = origin - b.centre;
        const double dd = glm::dot(direction, direction);
        const double half = glm::dot(o, direction) / dd;
        const double root = half * half - (glm::dot(o, o) - b.radius * b.radius) / dd;
        if (root >= 0) {
            keep(-half - std::sqrt(root), object);
            keep(-half + std::sqrt(root), object);
        }
        ++object;
    }
    return best;
}

RegistrationScene registration_room() {
    RegistrationScene s;
    const auto upright = [&](double x, double z, double half_width, double turned_deg) {
        const double a = turned_deg * 3.14159265358979 / 180;
        s.rectangles.push_back(
            {{x, 0, z}, half_width * glm::dvec3(std::cos(a), 0, std::sin(a)), {0, 3, 0}});
    };
    upright(0, 3.6, 4, 8);        // back wall
    upright(-1.7, 2.4, 1.6, 78);  // side walls, seen steeply
    upright(1.9, 2.4, 1.8, -70);
    s.rectangles.push_back({{0, 1.1, 2.4}, {3, 0, 0}, {0, 0, 2}});  // floor
    s.rectangles.push_back({{-0.5, 0.3, 1.7}, {0.25, 0, 0.1}, {0, 0.35, 0}});
    s.rectangles.push_back({{0.45, 0.1, 1.2}, {0.12, 0.02, 0}, {-0.02, 0.12, 0.1}});
    s.rectangles.push_back({{0.1, -0.55, 2.6}, {0.4, 0, -0.3}, {0, 0.15, 0}});
    // Rods: the thinner ones are less than a pixel wide.
    const double half_mm[] = {0.5, 2, 5, 20};
    for (int i = 0; i < 4; ++i) {
        s.rectangles.push_back(
            {{-0.3 + 0.18 * i, -0.2, 1.0 + 0.1 * i}, {half_mm[i] / 1000, 0, 0}, {0, 0.4, 0}});
    }
    s.balls.push_back({{-0.15, 0.45, 1.4}, 0.22});
    s.balls.push_back({{0.8, -0.3, 2.2}, 0.3});
    return s;
}

DepthFrame depth_frame(const RegistrationScene& scene, const RigParameters& rig,
                       const Image<glm::dvec2>& depth_rays, double metres_per_unit) {
    DepthFrame frame;
    frame.metres_per_unit = metres_per_unit;
    frame.raw = Image<std::uint16_t>(rig.depth.width, rig.depth.height);
    for (std::size_t i = 0; i < frame.raw.size(); ++i) {
        const glm::dvec2 ray = depth_rays.pixels()[i];
        if (std::isnan(ray.x)) continue;
        // The ray has z = 1, so t is the depth along the axis.
        const auto hit = scene.cast({0, 0, 0}, {ray, 1});
        const double units = std::nearbyint(hit.t / metres_per_unit);
        frame.raw.pixels()[i] =
            hit.object >= 0 && units < 65535 ? static_cast<std::uint16_t>(units) : std::uint16_t{0};
    }
    return frame;
}

RegistrationTruth registration_truth(const RegistrationScene& scene, const RigParameters& rig,
                                     const Image<glm::dvec2>& depth_rays,
                                     const Image<glm::dvec2>& color_rays, double clear_px) {
    const CameraModel& color = *rig.color;
    const Pose& pose = rig.color_from_depth;
    const double depth_fold = fold_radius(rig.depth);
    const double color_fold = fold_radius(color);
    const glm::dvec3 color_eye = to_depth(pose, {0, 0, 0});
    RegistrationTruth out{Image<double>(color.width, color.height, 0),
                          Image<int>(color.width, color.height, -1),
                          Image<std::uint8_t>(color.width, color.height, 0),
                          Image<std::uint8_t>(rig.depth.width, rig.depth.height, 0),
                          Image<int>(rig.depth.width, rig.depth.height, -1)};
    for (std::size_t i = 0; i < out.seen_by_color.size(); ++i) {
        const glm::dvec2 ray = depth_rays.pixels()[i];
        if (std::isnan(ray.x)) continue;
        const auto hit = scene.cast({0, 0, 0}, {ray, 1});
        if (hit.object < 0) continue;
        out.object_in_depth.pixels()[i] = hit.object;
        const glm::dvec3 point = hit.t * glm::dvec3(ray, 1);
        const auto pixel = project(color, color_fold, from_depth(pose, point));
        const bool seen = pixel && inside(color, *pixel) && free_way(scene, color_eye, point);
        out.seen_by_color.pixels()[i] = seen ? 1 : 0;
    }
    for (std::size_t i = 0; i < out.depth_in_color_m.size(); ++i) {
        const glm::dvec2 ray = color_rays.pixels()[i];
        if (std::isnan(ray.x)) continue;
        const glm::dvec3 through = to_depth(pose, {ray, 1}) - color_eye;
        const auto hit = scene.cast(color_eye, through);
        if (hit.object < 0) continue;
        out.depth_in_color_m.pixels()[i] = hit.t;
        out.object_in_color.pixels()[i] = hit.object;
        const glm::dvec3 point = color_eye + hit.t * through;
        const auto pixel = project(rig.depth, depth_fold, point);
        out.measured.pixels()[i] = pixel && inside(rig.depth, *pixel) && hit.t >= rig.min_depth_m &&
                                   all_around(out.object_in_depth, *pixel, clear_px, hit.object);
    }
    return out;
}

}  // namespace kino::reference
