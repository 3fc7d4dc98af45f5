#include "tests/reference/raster_reference.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <tuple>
#include <utility>
#include <vector>

#include "base/check.h"

namespace kino::reference {

namespace {

using Polygon = std::vector<glm::dvec4>;  // clip space

glm::dvec4 to_clip(const RasterCamera& camera, const glm::dvec3& p) {
    return camera.clip_from_point * glm::dvec4(p, 1.0);
}

bool between_planes(const glm::dvec4& clip) {
    return clip.w > 0 && clip.z >= 0 && clip.z <= clip.w;
}

glm::dvec2 to_framebuffer(const RasterCamera& camera, const glm::dvec4& clip) {
    return {(clip.x / clip.w + 1) * 0.5 * camera.width,
            (clip.y / clip.w + 1) * 0.5 * camera.height};
}

/// First and one past the last pixel whose centre lies in [from, to).
std::pair<int, int> centres_between(double from, double to, int size) {
    const auto pixel = [size](double edge) {
        return static_cast<int>(std::clamp(std::ceil(edge - 0.5), 0.0, static_cast<double>(size)));
    };
    return {pixel(from), pixel(to)};
}

void keep_nearer(RasterSample& sample, const RasterSample& other) {
    // Samples arrive by rising id, so that "smaller" alone keeps the smallest of equal depths.
    if (other.depth_m < sample.depth_m) sample = other;
}

/// Sutherland & Hodgman, Reentrant polygon clipping (1974), against inside(v) = dot(plane, v) >= 0.
Polygon clip(const Polygon& polygon, const glm::dvec4& plane) {
    Polygon kept;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const glm::dvec4& from = polygon[i];
        const glm::dvec4& to = polygon[(i + 1) % polygon.size()];
        const double from_side = glm::dot(plane, from);
        const double to_side = glm::dot(plane, to);
        if (from_side >= 0) kept.push_back(from);
        if ((from_side >= 0) == (to_side >= 0)) continue;
        // Always from the inside out: neighbours that share this edge must get the same point.
        const bool leaves = from_side >= 0;
        const glm::dvec4& inner = leaves ? from : to;
        const glm::dvec4& outer = leaves ? to : from;
        const double inner_side = leaves ? from_side : to_side;
        const double outer_side = leaves ? to_side : from_side;
        kept.push_back(inner + (inner_side / (inner_side - outer_side)) * (outer - inner));
    }
    return kept;
}

/// Twice the signed area of (a, b, p); positive where p is to the right of a->b on the screen (y
/// down). Exactly antisymmetric in a and b, so that neighbours agree about their shared edge.
double edge_side(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& p) {
    const auto side = [&p](const glm::dvec2& from, const glm::dvec2& to) {
        return (to.x - from.x) * (p.y - from.y) - (to.y - from.y) * (p.x - from.x);
    };
    return std::tie(a.x, a.y) < std::tie(b.x, b.y) ? side(a, b) : -side(b, a);
}

bool is_top_left(const glm::dvec2& a, const glm::dvec2& b) {
    return b.y < a.y || (b.y == a.y && b.x > a.x);
}

/// `corners` runs clockwise on the screen (y down).
bool covers(const std::vector<glm::dvec2>& corners, const glm::dvec2& p) {
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const glm::dvec2& a = corners[i];
        const glm::dvec2& b = corners[(i + 1) % corners.size()];
        if (a == b) continue;
        const double side = edge_side(a, b, p);
        if (side < 0 || (side == 0 && !is_top_left(a, b))) return false;
    }
    return true;
}

double signed_area(const std::vector<glm::dvec2>& corners) {
    double area = 0;
    for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
        const glm::dvec2 u = corners[i] - corners[0];
        const glm::dvec2 v = corners[i + 1] - corners[0];
        area += 0.5 * (u.x * v.y - u.y * v.x);
    }
    return area;
}

/// Weights of the unclipped triangle in space at a pixel, by homogeneous coordinates (Olano &
/// Greer, Triangle scan conversion using 2D homogeneous coordinates, 1997): solving
/// sum b_i (x_i, y_i, w_i) ~ (ndc_x, ndc_y, 1) needs no clipped corners.
std::array<double, 3> weights_at(const std::array<glm::dvec4, 3>& clip, const glm::dvec2& ndc) {
    const auto xyw = [&clip](int i) {
        const auto& v = clip[static_cast<std::size_t>(i % 3)];
        return glm::dvec3(v.x, v.y, v.w);
    };
    std::array<double, 3> weights{};
    double sum = 0;
    for (int i = 0; i < 3; ++i) {
        const double weight =
            glm::dot(glm::cross(xyw(i + 1), xyw(i + 2)), glm::dvec3(ndc.x, ndc.y, 1));
        weights[static_cast<std::size_t>(i)] = weight;
        sum += weight;
    }
    for (double& weight : weights) weight /= sum;
    return weights;
}

std::uint8_t to_byte(double value) {
    return static_cast<std::uint8_t>(std::clamp(std::floor(value + 0.5), 0.0, 255.0));
}

class TriangleRaster {
  public:
    TriangleRaster(const RasterCamera& camera, std::span<const RasterPoint> points,
                   Image<RasterSample>& out)
        : camera_(camera), points_(points), out_(out) {}

    void draw(const RasterTriangle& triangle, std::uint32_t id) {
        std::array<glm::dvec4, 3> corners_clip;
        for (std::size_t i = 0; i < 3; ++i) {
            KINO_CHECK_LT(triangle[i], points_.size());
            corners_clip[i] = to_clip(camera_, points_[triangle[i]].position);
        }
        Polygon polygon(corners_clip.begin(), corners_clip.end());
        polygon = clip(polygon, {0, 0, -1, 1});
        polygon = clip(polygon, {0, 0, 1, 0});

        std::vector<glm::dvec2> corners;
        for (const glm::dvec4& corner : polygon) {
            if (!(corner.w > 0)) return;
            corners.push_back(to_framebuffer(camera_, corner));
        }
        const double area = signed_area(corners);
        if (corners.size() < 3 || area == 0 || !std::isfinite(area)) return;
        if (area < 0) std::reverse(corners.begin(), corners.end());

        const auto by_x = [](const glm::dvec2& a, const glm::dvec2& b) { return a.x < b.x; };
        const auto by_y = [](const glm::dvec2& a, const glm::dvec2& b) { return a.y < b.y; };
        const auto [left, right] = std::minmax_element(corners.begin(), corners.end(), by_x);
        const auto [top, bottom] = std::minmax_element(corners.begin(), corners.end(), by_y);
        const auto [x_begin, x_end] = centres_between(left->x, right->x + 1, camera_.width);
        const auto [y_begin, y_end] = centres_between(top->y, bottom->y + 1, camera_.height);
        for (int y = y_begin; y < y_end; ++y) {
            for (int x = x_begin; x < x_end; ++x) {
                if (!covers(corners, {x + 0.5, y + 0.5})) continue;
                keep_nearer(out_.at(x, y), sample(triangle, corners_clip, id, x, y));
            }
        }
    }

  private:
    [[nodiscard]] RasterSample sample(const RasterTriangle& triangle,
                                      const std::array<glm::dvec4, 3>& corners_clip,
                                      std::uint32_t id, int x, int y) const {
        const glm::dvec2 ndc{(x + 0.5) / camera_.width * 2 - 1, (y + 0.5) / camera_.height * 2 - 1};
        RasterSample result;
        result.id = id;
        result.barycentric = weights_at(corners_clip, ndc);
        result.depth_m = 0;
        std::array<double, 4> rgba{};
        for (std::size_t i = 0; i < 3; ++i) {
            const RasterPoint& point = points_[triangle[i]];
            const double weight = result.barycentric[i];
            result.depth_m += weight * camera_.view_depth(point.position);
            rgba[0] += weight * point.color.r;
            rgba[1] += weight * point.color.g;
            rgba[2] += weight * point.color.b;
            rgba[3] += weight * point.color.a;
        }
        result.color = {to_byte(rgba[0]), to_byte(rgba[1]), to_byte(rgba[2]), to_byte(rgba[3])};
        return result;
    }

    const RasterCamera& camera_;
    std::span<const RasterPoint> points_;
    Image<RasterSample>& out_;
};

RasterSample point_sample(const RasterCamera& camera, const RasterPoint& point, std::size_t id) {
    return {.depth_m = camera.view_depth(point.position),
            .id = static_cast<std::uint32_t>(id),
            .barycentric = {1, 0, 0},
            .color = point.color};
}

}  // namespace

RasterCamera pinhole_raster_camera(int width, int height, double fx, double fy, double cx,
                                   double cy, double near_m) {
    RasterCamera camera{.width = width, .height = height};
    camera.clip_from_point = glm::dmat4(0.0);
    camera.clip_from_point[0][0] = 2 * fx / width;
    camera.clip_from_point[2][0] = (2 * cx + 1) / width - 1;
    camera.clip_from_point[1][1] = 2 * fy / height;
    camera.clip_from_point[2][1] = (2 * cy + 1) / height - 1;
    camera.clip_from_point[3][2] = near_m;
    camera.clip_from_point[2][3] = 1;
    return camera;
}

Image<RasterSample> raster_points(const RasterCamera& camera, std::span<const RasterPoint> points) {
    Image<RasterSample> out(camera.width, camera.height);
    for (std::size_t i = 0; i < points.size(); ++i) {
        const glm::dvec4 clip = to_clip(camera, points[i].position);
        if (!between_planes(clip)) continue;
        const glm::dvec2 at = to_framebuffer(camera, clip);
        if (!(at.x >= 0 && at.y >= 0 && at.x < camera.width && at.y < camera.height)) continue;
        keep_nearer(out.at(static_cast<int>(at.x), static_cast<int>(at.y)),
                    point_sample(camera, points[i], i));
    }
    return out;
}

Image<RasterSample> raster_squares(const RasterCamera& camera, std::span<const RasterPoint> points,
                                   const HalfSizePx& half_size_px) {
    Image<RasterSample> out(camera.width, camera.height);
    for (std::size_t i = 0; i < points.size(); ++i) {
        const glm::dvec4 clip = to_clip(camera, points[i].position);
        if (!between_planes(clip)) continue;
        const glm::dvec2 at = to_framebuffer(camera, clip);
        const RasterSample sample = point_sample(camera, points[i], i);
        const double half = half_size_px(sample.depth_m);
        if (!std::isfinite(at.x) || !std::isfinite(at.y) || !(half > 0)) continue;
        const auto [x_begin, x_end] = centres_between(at.x - half, at.x + half, camera.width);
        const auto [y_begin, y_end] = centres_between(at.y - half, at.y + half, camera.height);
        for (int y = y_begin; y < y_end; ++y) {
            for (int x = x_begin; x < x_end; ++x) keep_nearer(out.at(x, y), sample);
        }
    }
    return out;
}

Image<RasterSample> raster_triangles(const RasterCamera& camera,
                                     std::span<const RasterPoint> points,
                                     std::span<const RasterTriangle> triangles) {
    Image<RasterSample> out(camera.width, camera.height);
    TriangleRaster raster(camera, points, out);
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        raster.draw(triangles[i], static_cast<std::uint32_t>(i));
    }
    return out;
}

Image<RasterSample> nearer(const Image<RasterSample>& a, const Image<RasterSample>& b,
                           std::uint32_t id_offset) {
    KINO_CHECK(a.width() == b.width() && a.height() == b.height());
    Image<RasterSample> out = a;
    for (std::size_t i = 0; i < out.size(); ++i) {
        RasterSample moved = b.pixels()[i];
        if (moved.covered()) moved.id += id_offset;
        keep_nearer(out.pixels()[i], moved);
    }
    return out;
}

}  // namespace kino::reference
