#pragma once

#include <vector>

#include "base/image.h"
#include "tests/reference/raster_reference.h"

namespace kino::reference {

/// Which triangles of a depth grid are torn: those whose corners differ by `threshold_m` or more.
struct EdgeTest {
    enum class Kind { fixed, range_aware };
    Kind kind = Kind::range_aware;
    double fixed_m = 0.075;    ///< for Kind::fixed
    double focal_px = 571.26;  ///< of the depth camera, for Kind::range_aware

    /// `nearest_m` is the smallest depth of the triangle. Range-aware, in metres:
    /// T(z) = 3 * 0.00307 z^2 + tan(80 deg) z / f, three quantisation steps of a Kinect v1
    /// (Khoshelham & Elberink 2012) plus the step of a surface seen 80 degrees off its normal.
    [[nodiscard]] double threshold_m(double nearest_m) const;
};

/// Readings up to this are no readings; a float, because depth images hold floats.
constexpr float kNearestValidDepthM = 0.1f;

/// Triangles of the pixel grid, two a cell: (00, 10, 01) and (10, 11, 01), where 10 is one pixel
/// to the right of 00 and 01 one below. A triangle is kept iff its three depths are valid and its
/// largest depth difference is below the threshold. Indices are y * width + x; cells row by row.
[[nodiscard]] std::vector<RasterTriangle> depth_grid_triangles(const Image<float>& depth_m,
                                                               const EdgeTest& test);

/// Points in camera space, one a pixel, for an undistorted camera; colour white where `color` is
/// empty. Pixels without a reading lie at the origin.
[[nodiscard]] std::vector<RasterPoint> depth_grid_points(const Image<float>& depth_m, double fx,
                                                         double fy, double cx, double cy,
                                                         const Image<Rgba8>& color = {});

}  // namespace kino::reference
