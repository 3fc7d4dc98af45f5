#include "tests/reference/camera_reference.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>

namespace kino::reference {
namespace {

bool is_plain(const CameraModel& c) {
    return c.k1 == 0 && c.k2 == 0 && c.k3 == 0 && c.k4 == 0 && c.k5 == 0 && c.k6 == 0 &&
           c.p1 == 0 && c.p2 == 0;
}

double denominator(const CameraModel& c, double r) {
    return 1 + c.k4 * std::pow(r, 2) + c.k5 * std::pow(r, 4) + c.k6 * std::pow(r, 6);
}

struct Derivative {
    glm::dvec2 by_x, by_y;
};

Derivative derivative(const CameraModel& c, const glm::dvec2& p) {
    constexpr double kH = 1e-6;
    return {(distort(c, p + glm::dvec2(kH, 0)) - distort(c, p - glm::dvec2(kH, 0))) / (2 * kH),
            (distort(c, p + glm::dvec2(0, kH)) - distort(c, p - glm::dvec2(0, kH))) / (2 * kH)};
}

// Positive definite: positive trace and determinant of the symmetric 2x2 matrix.
bool one_to_one_around(const CameraModel& c, double r) {
    if (denominator(c, r) <= 0) return false;
    for (int i = 0; i < 360; ++i) {
        const double angle = i * std::numbers::pi / 180;
        const Derivative d = derivative(c, {r * std::cos(angle), r * std::sin(angle)});
        if (d.by_x.x + d.by_y.y <= 0) return false;
        if (d.by_x.x * d.by_y.y - d.by_x.y * d.by_y.x <= 0) return false;
    }
    return true;
}

}  // namespace

glm::dvec2 distort(const CameraModel& c, const glm::dvec2& ray) {
    const double x = ray.x;
    const double y = ray.y;
    const double r2 = x * x + y * y;
    const double r4 = r2 * r2;
    const double r6 = r4 * r2;
    const double radial =
        (1 + c.k1 * r2 + c.k2 * r4 + c.k3 * r6) / (1 + c.k4 * r2 + c.k5 * r4 + c.k6 * r6);
    return {x * radial + 2 * c.p1 * x * y + c.p2 * (r2 + 2 * x * x),
            y * radial + c.p1 * (r2 + 2 * y * y) + 2 * c.p2 * x * y};
}

double fold_radius(const CameraModel& camera) {
    if (is_plain(camera)) return std::numeric_limits<double>::infinity();
    double good = 0;
    double step = 0.01;
    while (good < 20 && step > 1e-7) {
        if (one_to_one_around(camera, good + step)) {
            good += step;
        } else {
            step /= 10;
        }
    }
    return good;
}

std::optional<glm::dvec2> project(const CameraModel& camera, double max_radius,
                                  const glm::dvec3& point) {
    if (std::isnan(point.x) || std::isnan(point.y) || !(point.z > 0)) return std::nullopt;
    const glm::dvec2 ray = glm::dvec2(point) / point.z;
    if (glm::length(ray) > max_radius) return std::nullopt;
    const glm::dvec2 d = distort(camera, ray);
    return glm::dvec2(camera.fx * d.x + camera.cx, camera.fy * d.y + camera.cy);
}

std::optional<glm::dvec2> unproject(const CameraModel& camera, double max_radius,
                                    const glm::dvec2& pixel) {
    const glm::dvec2 wanted((pixel.x - camera.cx) / camera.fx, (pixel.y - camera.cy) / camera.fy);
    if (is_plain(camera)) return wanted;
    glm::dvec2 ray(0, 0);
    double distance = glm::length(distort(camera, ray) - wanted);
    for (int i = 0; i < 200 && distance > 1e-14; ++i) {
        const Derivative d = derivative(camera, ray);
        const double determinant = d.by_x.x * d.by_y.y - d.by_y.x * d.by_x.y;
        const glm::dvec2 e = distort(camera, ray) - wanted;
        const glm::dvec2 step =
            glm::dvec2(d.by_y.y * e.x - d.by_y.x * e.y, d.by_x.x * e.y - d.by_x.y * e.x) /
            determinant;
        double length = 1;
        for (; length > 1e-6; length /= 2) {
            const glm::dvec2 tried = ray - length * step;
            if (glm::length(tried) > max_radius) continue;
            const double there = glm::length(distort(camera, tried) - wanted);
            if (there >= distance) continue;
            ray = tried;
            distance = there;
            break;
        }
        if (length <= 1e-6) break;
    }
    if (distance > 1e-9) return std::nullopt;
    return ray;
}

}  // namespace kino::reference
