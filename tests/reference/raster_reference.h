#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <span>

#include "base/image.h"

namespace kino::reference {

/// A coloured point. `position` is in whatever space RasterCamera takes, metres.
struct RasterPoint {
    glm::dvec3 position{0, 0, 0};
    Rgba8 color{};
};

/// Three indices into the points. Both faces are drawn.
using RasterTriangle = std::array<std::uint32_t, 3>;

/// How points reach the picture. Clip space is Vulkan's: y down, x and y in [-w, w], depth
/// reversed (z = w at the near plane, z = 0 infinitely far or at the far plane).
struct RasterCamera {
    int width = 0;   ///< px
    int height = 0;  ///< px
    glm::dmat4 clip_from_point{1.0};
    /// The view depth of p is dot(row, (p, 1)): metres along the optical axis,
    /// whatever the sign of the view's z axis.
    glm::dvec4 view_depth_row{0, 0, 1, 0};

    [[nodiscard]] double view_depth(const glm::dvec3& p) const {
        return view_depth_row.x * p.x + view_depth_row.y * p.y + view_depth_row.z * p.z +
               view_depth_row.w;
    }
};

/// A camera at the origin of camera axes (x right, y down, z forward) with pixel centres at
/// integers, as base/camera_model.h has it: pixel (u, v) is sampled at framebuffer (u+0.5, v+0.5).
/// Depth is reversed, the far plane infinite.
[[nodiscard]] RasterCamera pinhole_raster_camera(int width, int height, double fx, double fy,
                                                 double cx, double cy, double near_m);

/// What is nearest at a pixel.
struct RasterSample {
    static constexpr std::uint32_t kNothing = 0xFFFFFFFFu;

    double depth_m = std::numeric_limits<double>::infinity();  ///< view depth
    std::uint32_t id = kNothing;  ///< index of the point or the triangle
    /// Weights of the triangle's corners in space (perspective-correct), sum 1; (1,0,0) for points.
    std::array<double, 3> barycentric{0, 0, 0};
    Rgba8 color{0, 0, 0, 0};

    [[nodiscard]] bool covered() const { return id != kNothing; }
};

/// Half the side of a point's square on the screen, px, from its view depth in metres.
using HalfSizePx = std::function<double(double view_depth_m)>;

/// Every point colours the one pixel its projection falls into ([x, x+1) x [y, y+1) of framebuffer
/// coordinates). Points outside the near or far plane are not drawn. Equal depths: smallest index.
[[nodiscard]] Image<RasterSample> raster_points(const RasterCamera& camera,
                                                std::span<const RasterPoint> points);

/// Every point colours the pixels whose centres lie in the square [p - h, p + h) around its
/// projection, at one depth.
[[nodiscard]] Image<RasterSample> raster_squares(const RasterCamera& camera,
                                                 std::span<const RasterPoint> points,
                                                 const HalfSizePx& half_size_px);

/// Triangles sampled at pixel centres with the top-left rule; clipped at the near plane (and the
/// far one) as polygons; depth and colour perspective-correct. Equal depths: smallest index.
[[nodiscard]] Image<RasterSample> raster_triangles(const RasterCamera& camera,
                                                   std::span<const RasterPoint> points,
                                                   std::span<const RasterTriangle> triangles);

/// The nearer of two pictures of one camera, for scenes of points and triangles; ids of `b` are
/// moved up by `id_offset`.
[[nodiscard]] Image<RasterSample> nearer(const Image<RasterSample>& a, const Image<RasterSample>& b,
                                         std::uint32_t id_offset);

}  // namespace kino::reference
