#include "tests/scenes/raster_scenes.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "tests/reference/depth_mesh_reference.h"

namespace kino::test {

std::vector<NamedView> standard_views(const LiveDepth& live, const CameraModel& camera, int width,
                                      int height) {
    const Pose& wfd = live.world_from_depth;
    const glm::dvec3 up = wfd.rotation * glm::dvec3(0, -1, 0);
    const auto from = [&](const glm::dvec3& eye, const glm::dvec3& target) {
        return View{.width = width,
                    .height = height,
                    .projection = perspective(0.95, width, height),
                    .world_from_view = look_at(wfd * eye, wfd * target, up)};
    };
    // The nearest thing straight ahead, for the close-up.
    double ahead = 2.0;
    const Image<float>& depth = live.surface->depth_m;
    for (int y = depth.height() / 3; y < depth.height() * 2 / 3; ++y) {
        for (int x = depth.width() / 3; x < depth.width() * 2 / 3; ++x) {
            if (depth.at(x, y) > 0.4f) ahead = std::min(ahead, double{depth.at(x, y)});
        }
    }
    return {{"sensor", sensor_view(camera, wfd, width, height)},
            {"orbit", from({1.1, -0.6, 0.2}, {0, 0, 2.2})},
            {"close-up", from({0.15, -0.1, ahead - 0.25}, {0, 0, ahead + 1.0})},
            {"inside", from({0.1, 0.05, ahead + 0.25}, {-0.3, 0.1, ahead + 2.0})}};
}

Image<reference::RasterSample> reference_picture(const LiveDepth& live, const View& view) {
    const DepthSurface& surface = *live.surface;
    const Pose view_from_depth = inverse(view.world_from_view) * live.world_from_depth;
    std::vector<reference::RasterPoint> points(surface.depth_m.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        const double z = surface.depth_m.pixels()[i];
        const RayXy ray = surface.rays->pixels()[i];
        points[i].position = view_from_depth * glm::dvec3(ray.x * z, ray.y * z, z);
        if (!surface.color.empty()) points[i].color = surface.color.pixels()[i];
    }
    const Projection& k = view.projection;
    const reference::RasterCamera camera =
        reference::pinhole_raster_camera(view.width, view.height, k.fx, k.fy, k.cx, k.cy, k.near_m);
    if (live.style == DepthStyle::cloud) {
        for (std::size_t i = 0; i < points.size(); ++i) {
            // Out of sight: the reference draws every point it is given.
            if (!(surface.depth_m.pixels()[i] > 0)) points[i].position = {0, 0, -1};
        }
        return reference::raster_points(camera, points);
    }
    const auto triangles = reference::depth_grid_triangles(
        surface.depth_m,
        {.kind = live.edge_rule == EdgeRule::fixed ? reference::EdgeTest::Kind::fixed
                                                   : reference::EdgeTest::Kind::range_aware,
         .focal_px = surface.focal_px});
    Image<reference::RasterSample> picture = reference::raster_triangles(camera, points, triangles);
    const auto width = static_cast<std::uint32_t>(surface.depth_m.width());
    for (reference::RasterSample& sample : picture.pixels()) {
        if (!sample.covered()) continue;
        const reference::RasterTriangle& t = triangles[sample.id];
        const bool second = t[1] != t[0] + 1;
        const std::uint32_t corner = second ? t[0] - 1 : t[0];
        sample.id = 2 * (corner / width * (width - 1) + corner % width) + (second ? 1 : 0);
    }
    return picture;
}

Agreement compare_with_reference(const FrameResult& frame,
                                 const Image<reference::RasterSample>& reference) {
    Agreement out;
    for (int y = 0; y < reference.height(); ++y) {
        for (int x = 0; x < reference.width(); ++x) {
            const reference::RasterSample& want = reference.at(x, y);
            const float z = frame.surface.view_z_m.at(x, y);
            const bool covered = z > 0;
            out.reference_px += want.covered();
            out.covered_px += covered;
            if (!want.covered() && !covered) continue;
            ++out.union_px;
            if (!want.covered() || !covered) continue;
            const Rgba8 got = frame.picture.at(x, y);
            const bool same_color = std::abs(got.r - want.color.r) <= 2 &&
                                    std::abs(got.g - want.color.g) <= 2 &&
                                    std::abs(got.b - want.color.b) <= 2;
            const bool same_depth = std::abs(z - want.depth_m) <= 0.001;
            const bool same_id = !frame.surface.id.empty() && frame.surface.id.at(x, y) == want.id;
            if (same_id || (same_depth && same_color)) {
                ++out.agreeing_px;
            }
        }
    }
    return out;
}

double test_depth(const CameraModel& camera, int x, int y) {
    const double rx = (x - camera.cx) / camera.fx;
    const double ry = (y - camera.cy) / camera.fy;
    // Readings are missing in a scatter of pixels and in a stripe.
    if ((x * 7 + y * 13) % 97 == 0 || (x > camera.width * 4 / 5 && x < camera.width * 4 / 5 + 5)) {
        return 0;
    }
    double z = 3.2 + 0.1 * std::sin(9 * rx) + 0.3 * rx;           // a wavy wall
    if (ry > 0.05) z = std::min(z, 0.9 / ry);                     // the floor
    if (rx > 0.2 && ry > -0.3 && ry < 0.1) z = std::min(z, 1.8);  // a box: a step
    const double a = rx * rx + ry * ry + 1;                       // a sphere at (-0.3, -0.1, 1.6)
    const double b = -0.3 * rx - 0.1 * ry + 1.6;
    const double root = b * b - a * (0.3 * 0.3 + 0.1 * 0.1 + 1.6 * 1.6 - 0.35 * 0.35);
    if (root > 0) z = std::min(z, (b - std::sqrt(root)) / a);
    return z;
}

Rgba8 test_color(int x, int y) {
    // Smooth: at silhouettes two correct rasterisers may pick neighbouring pixels.
    return {static_cast<std::uint8_t>(128 + 100 * std::sin(x * 0.05)),
            static_cast<std::uint8_t>(128 + 100 * std::sin(y * 0.07)),
            static_cast<std::uint8_t>(128 + 60 * std::sin((x + y) * 0.03)), 255};
}

}  // namespace kino::test
