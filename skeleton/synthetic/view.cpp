#include "skeleton/synthetic/view.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>

#include "base/check.h"
#include "calibration/projection.h"

namespace kino {
namespace {

using glm::dmat3;
using glm::dvec3;

// Solids that reach nearer than this to the eye's plane may cover any pixel.
constexpr double kNearM = 0.02;

enum class Place : std::uint8_t { before, behind, around };

// Extremes of (x/z, y/z) over the ellipsoid center + shape * unit ball: the planes x = k z that
// touch it satisfy (cx - k cz)^2 = |shape^T (e_x - k e_z)|^2.
Place grow(const dvec3& c, const dmat3& shape, double lo[2], double hi[2], double& z_min) {
    const dmat3 s = shape * glm::transpose(shape);
    const double reach = std::sqrt(s[2][2]);
    if (c.z + reach <= 0) return Place::behind;
    if (c.z - reach < kNearM) return Place::around;
    z_min = std::min(z_min, c.z - reach);
    const double a = c.z * c.z - s[2][2];
    for (int axis = 0; axis < 2; ++axis) {
        const double b = c[axis] * c.z - s[axis][2];
        const double d = c[axis] * c[axis] - s[axis][axis];
        const double root = std::sqrt(std::max(0.0, b * b - a * d));
        lo[axis] = std::min(lo[axis], (b - root) / a);
        hi[axis] = std::max(hi[axis], (b + root) / a);
    }
    return Place::before;
}

}  // namespace

CastView::CastView(const CameraModel& camera, const Pose& view_from_world)
    : view_from_world_(view_from_world),
      ray_x_(camera.width, camera.height),
      ray_y_(camera.width, camera.height) {
    KINO_CHECK_EQ(camera.width % 8, 0);
    const Projection projection(camera);
    for (int y = 0; y < camera.height; ++y) {
        for (int x = 0; x < camera.width; ++x) {
            const glm::dvec2 ray = projection.unproject_clamped({x, y});
            ray_x_.at(x, y) = static_cast<float>(ray.x);
            ray_y_.at(x, y) = static_cast<float>(ray.y);
        }
    }
    find_extremes();
}

CastView CastView::shifted(double x_px, double y_px) const {
    CastView out = *this;
    const auto u = static_cast<float>(x_px), v = static_cast<float>(y_px);
    const auto shift = [&](const Image<float>& from, Image<float>& to) {
        const int right = width() - 1, bottom = height() - 1;
        for (int y = 0; y <= bottom; ++y) {
            const int above = std::max(y - 1, 0), below = std::min(y + 1, bottom);
            for (int x = 0; x <= right; ++x) {
                const int left = std::max(x - 1, 0), next = std::min(x + 1, right);
                const float dx = (from.at(next, y) - from.at(left, y)) / float(next - left);
                const float dy = (from.at(x, below) - from.at(x, above)) / float(below - above);
                to.at(x, y) = from.at(x, y) + u * dx + v * dy;
            }
        }
    };
    shift(ray_x_, out.ray_x_);
    shift(ray_y_, out.ray_y_);
    out.find_extremes();
    return out;
}

void CastView::find_extremes() {
    const float inf = std::numeric_limits<float>::infinity();
    column_max_.assign(static_cast<std::size_t>(width()), -inf);
    column_min_.assign(static_cast<std::size_t>(width()), inf);
    row_max_.assign(static_cast<std::size_t>(height()), -inf);
    row_min_.assign(static_cast<std::size_t>(height()), inf);
    for (int y = 0; y < height(); ++y) {
        for (int x = 0; x < width(); ++x) {
            const float rx = ray_x_.at(x, y), ry = ray_y_.at(x, y);
            const auto column = static_cast<std::size_t>(x), row = static_cast<std::size_t>(y);
            column_max_[column] = std::max(column_max_[column], rx);
            column_min_[column] = std::min(column_min_[column], rx);
            row_max_[row] = std::max(row_max_[row], ry);
            row_min_[row] = std::min(row_min_[row], ry);
        }
    }
    const auto make_monotone = [](std::vector<float>& max, std::vector<float>& min) {
        for (std::size_t i = 1; i < max.size(); ++i) max[i] = std::max(max[i], max[i - 1]);
        for (std::size_t i = min.size() - 1; i > 0; --i) min[i - 1] = std::min(min[i - 1], min[i]);
    };
    make_monotone(column_max_, column_min_);
    make_monotone(row_max_, row_min_);
}

raycast::Solid CastView::prepare(const Primitive& solid, std::int32_t id, double eye_x_m) const {
    raycast::Solid out;
    out.kind = solid.kind == Primitive::Kind::box ? raycast::Solid::box
               : solid.height == 0                ? raycast::Solid::ball
                                                  : raycast::Solid::cone;
    out.id = id;
    const dmat3 rotation = glm::mat3_cast(view_from_world_.rotation);
    const dvec3 origin = view_from_world_ * solid.origin_m - dvec3(eye_x_m, 0, 0);
    const dvec3 middle = origin + rotation * solid.axes[1] * (solid.height / 2);
    out.t0 = static_cast<float>(std::max(middle.z, 0.0));
    out.wx = static_cast<float>(-origin.x);
    out.wy = static_cast<float>(-origin.y);
    out.wz = static_cast<float>(static_cast<double>(out.t0) - origin.z);
    const dmat3 m = glm::inverse(rotation * solid.axes);
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) {
            out.m[3 * row + column] = static_cast<float>(m[column][row]);
        }
        out.half[row] = static_cast<float>(solid.half[row]);
    }
    out.radius_a = static_cast<float>(solid.radius_a);
    out.radius_b = static_cast<float>(solid.radius_b);
    out.height = static_cast<float>(solid.height);
    if (out.kind == raycast::Solid::cone) {
        const double s = (solid.radius_a - solid.radius_b) / solid.height;
        out.slope = static_cast<float>(s);
        out.cos2 = static_cast<float>(1 - s * s);
        out.side_lo = static_cast<float>(solid.radius_a * s);
        out.side_hi = static_cast<float>(solid.height + solid.radius_b * s);
    }
    return out;
}

std::optional<CastView::Outline> CastView::outline(const Primitive& solid, double eye_x_m) const {
    const dmat3 rotation = glm::mat3_cast(view_from_world_.rotation);
    const dmat3 axes = rotation * solid.axes;
    const dvec3 origin = view_from_world_ * solid.origin_m - dvec3(eye_x_m, 0, 0);
    constexpr double kInf = std::numeric_limits<double>::infinity();
    double lo[2] = {kInf, kInf}, hi[2] = {-kInf, -kInf}, z_min = kInf;
    int behind = 0, around = 0, parts = 2;
    const auto count = [&](Place place) {
        behind += place == Place::behind;
        around += place == Place::around;
    };
    if (solid.kind == Primitive::Kind::box) {
        parts = 8;
        for (int corner = 0; corner < 8; ++corner) {
            const dvec3 sign(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
            count(grow(origin + axes * (solid.half * sign), dmat3(0), lo, hi, z_min));
        }
    } else {
        // A hull's outline is the hull of the outlines.
        count(grow(origin, axes * solid.radius_a, lo, hi, z_min));
        count(grow(origin + axes[1] * solid.height, axes * solid.radius_b, lo, hi, z_min));
    }
    if (behind == parts) return std::nullopt;
    if (behind + around > 0) return Outline{-kInf, kInf, -kInf, kInf, 0};
    return Outline{lo[0], hi[0], lo[1], hi[1], z_min};
}

raycast::Rect CastView::pixels(const Outline& o) const {
    // Float rays are rounded; a hair's width keeps the rectangle conservative.
    constexpr float kHair = 1e-5f;
    const auto first = [](const std::vector<float>& max, double at) {
        return static_cast<int>(
            std::lower_bound(max.begin(), max.end(), static_cast<float>(at) - kHair) - max.begin());
    };
    const auto last = [](const std::vector<float>& min, double at) {
        return static_cast<int>(
            std::upper_bound(min.begin(), min.end(), static_cast<float>(at) + kHair) - min.begin());
    };
    return {first(column_max_, o.x0), first(row_max_, o.y0), last(column_min_, o.x1),
            last(row_min_, o.y1)};
}

raycast::Rect CastView::bounds(const Primitive& solid) const {
    const auto o = outline(solid, 0);
    return o ? pixels(*o) : raycast::Rect{};
}

raycast::Rect CastView::shadow_bounds(const Primitive& solid, double eye_x_m) const {
    auto o = outline(solid, eye_x_m);
    if (!o) return {};
    if (!(o->z_min > 0)) return everything();
    // A pixel with ray x and depth z is seen from there along x - eye_x/z, and z > z_min.
    o->x1 += eye_x_m / o->z_min;
    return pixels(*o);
}

raycast::Rect join(const raycast::Rect& a, const raycast::Rect& b) {
    if (!any_pixel(a)) return b;
    if (!any_pixel(b)) return a;
    return {std::min(a.x0, b.x0), std::min(a.y0, b.y0), std::max(a.x1, b.x1), std::max(a.y1, b.y1)};
}

raycast::Rect intersect(const raycast::Rect& a, const raycast::Rect& b) {
    return {std::max(a.x0, b.x0), std::max(a.y0, b.y0), std::min(a.x1, b.x1), std::min(a.y1, b.y1)};
}

}  // namespace kino
