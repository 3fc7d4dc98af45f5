#include "calibration/projection.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "base/check.h"

namespace kino {
namespace {

// tan(87 degrees): no pinhole picture shows more, and rational models mean nothing out there.
constexpr double kWidestRadius = 20;
constexpr int kNewtonSteps = 10;

struct Radial {
    double factor;  // g(s)
    double slope;   // dg/ds
    double denominator;
};

Radial radial(const CameraModel& c, double s) {
    const double n = 1 + s * (c.k1 + s * (c.k2 + s * c.k3));
    const double d = 1 + s * (c.k4 + s * (c.k5 + s * c.k6));
    const double dn = c.k1 + s * (2 * c.k2 + s * 3 * c.k3);
    const double dd = c.k4 + s * (2 * c.k5 + s * 3 * c.k6);
    return {n / d, (dn * d - n * dd) / (d * d), d};
}

// The derivative's eigenvalues are g and g + 2 s g' from the radial part; the tangential part
// shifts them by 6 |p| r at most.
bool one_to_one_at(const CameraModel& c, double r) {
    const double s = r * r;
    const Radial g = radial(c, s);
    const double least = std::min(g.factor, g.factor + 2 * s * g.slope);
    return g.denominator > 0 && least - 6 * std::hypot(c.p1, c.p2) * r > 0;
}

double find_max_radius(const CameraModel& c) {
    constexpr double kStep = 1.0 / 1024;
    double good = 0;
    while (good < kWidestRadius && one_to_one_at(c, good + kStep)) good += kStep;
    if (good >= kWidestRadius) return kWidestRadius;
    double bad = good + kStep;
    for (int i = 0; i < 50; ++i) {
        const double middle = (good + bad) / 2;
        (one_to_one_at(c, middle) ? good : bad) = middle;
    }
    return good;
}

glm::dvec2 apply(const CameraModel& c, const glm::dvec2& ray) {
    const double x = ray.x;
    const double y = ray.y;
    const double s = x * x + y * y;
    const double g = radial(c, s).factor;
    return {g * x + 2 * c.p1 * x * y + c.p2 * (s + 2 * x * x),
            g * y + c.p1 * (s + 2 * y * y) + 2 * c.p2 * x * y};
}

// r with g(r^2) r = target, by Newton kept inside a shrinking bracket; max_radius if there is none.
double invert_radial(const CameraModel& c, double target, double max_radius) {
    double low = 0;
    double high = max_radius;
    double r = std::min(target, max_radius);
    for (int i = 0; i < 60; ++i) {
        const Radial g = radial(c, r * r);
        const double error = g.factor * r - target;
        (error > 0 ? high : low) = r;
        const double slope = g.factor + 2 * r * r * g.slope;
        double next = r - error / slope;
        if (!(next >= low && next <= high)) next = (low + high) / 2;
        if (std::abs(next - r) <= 1e-15 * (1 + r)) return next;
        r = next;
    }
    return r;
}

}  // namespace

Projection::Projection(const CameraModel& camera)
    : camera_(camera),
      distorted_(camera.has_distortion()),
      max_radius_(distorted_ ? find_max_radius(camera) : std::numeric_limits<double>::infinity()) {}

std::optional<glm::dvec2> Projection::distort(const glm::dvec2& ray) const {
    // Written so that NaN fails.
    const double r = std::hypot(ray.x, ray.y);
    if (!(r <= max_radius_) || !std::isfinite(r)) return std::nullopt;
    return distorted_ ? apply(camera_, ray) : ray;
}

std::optional<glm::dvec2> Projection::undistort(const glm::dvec2& distorted) const {
    const double target = std::hypot(distorted.x, distorted.y);
    if (!std::isfinite(target)) return std::nullopt;
    if (!distorted_ || target == 0) return distorted;
    const CameraModel& c = camera_;
    glm::dvec2 ray = distorted * (invert_radial(c, target, max_radius_) / target);
    for (int i = 0;; ++i) {
        const glm::dvec2 error = apply(c, ray) - distorted;
        const bool solved = glm::length(error) <= 1e-14 * (1 + target);
        if (solved || i == kNewtonSteps) {
            if (!(glm::length(error) <= 1e-12 * (1 + target))) return std::nullopt;
            return ray;
        }
        const double x = ray.x;
        const double y = ray.y;
        const Radial g = radial(c, x * x + y * y);
        const double xx = g.factor + 2 * g.slope * x * x + 2 * c.p1 * y + 6 * c.p2 * x;
        const double xy = 2 * g.slope * x * y + 2 * c.p1 * x + 2 * c.p2 * y;
        const double yy = g.factor + 2 * g.slope * y * y + 6 * c.p1 * y + 2 * c.p2 * x;
        const double determinant = xx * yy - xy * xy;
        if (!(std::abs(determinant) > 1e-300)) return std::nullopt;
        ray -= glm::dvec2(yy * error.x - xy * error.y, xx * error.y - xy * error.x) / determinant;
        const double r = std::hypot(ray.x, ray.y);
        if (r > max_radius_) ray *= max_radius_ / r;
    }
}

std::optional<glm::dvec2> Projection::project(const glm::dvec3& point) const {
    if (!(point.z > 0) || !std::isfinite(point.z)) return std::nullopt;
    const auto ray = distort({point.x / point.z, point.y / point.z});
    if (!ray) return std::nullopt;
    return glm::dvec2(camera_.fx * ray->x + camera_.cx, camera_.fy * ray->y + camera_.cy);
}

std::optional<glm::dvec2> Projection::unproject(const glm::dvec2& pixel) const {
    return undistort({(pixel.x - camera_.cx) / camera_.fx, (pixel.y - camera_.cy) / camera_.fy});
}

glm::dvec2 Projection::unproject_clamped(const glm::dvec2& pixel) const {
    KINO_CHECK(std::isfinite(pixel.x) && std::isfinite(pixel.y));
    if (const auto ray = unproject(pixel)) return *ray;
    const glm::dvec2 outward((pixel.x - camera_.cx) / camera_.fx,
                             (pixel.y - camera_.cy) / camera_.fy);
    return outward * (max_radius_ / glm::length(outward));
}

CameraModel scaled(const CameraModel& camera, int width, int height) {
    CameraModel out = camera;
    const double sx = static_cast<double>(width) / camera.width;
    const double sy = static_cast<double>(height) / camera.height;
    out.width = width;
    out.height = height;
    out.fx *= sx;
    out.fy *= sy;
    out.cx = (camera.cx + 0.5) * sx - 0.5;
    out.cy = (camera.cy + 0.5) * sy - 0.5;
    return out;
}

CameraModel cropped(const CameraModel& camera, int left, int top, int width, int height) {
    CameraModel out = camera;
    out.width = width;
    out.height = height;
    out.cx -= left;
    out.cy -= top;
    return out;
}

}  // namespace kino
