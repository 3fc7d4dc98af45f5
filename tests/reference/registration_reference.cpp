#include "tests/reference/registration_reference.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/reference/camera_reference.h"

namespace kino::reference {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

double decode(const RigParameters& rig, const DepthFrame& frame, std::uint16_t raw) {
    double z = 0;
    double low = rig.min_depth_m;
    double high = rig.max_depth_m;
    if (frame.unit == DepthUnit::linear) {
        if (raw == 0 || raw == 65535) return 0;
        z = raw * frame.metres_per_unit;
    } else {
        if (raw >= 2047) return 0;
        const DisparityParameters& d = rig.disparity;
        const double m = d.reference_pixel_size_mm * ((raw - 4.0 * d.const_shift) / 4 - 0.375);
        const double r = d.reference_distance_cm;
        z = 10 * (m * r / (d.emitter_distance_cm - m) + r) / 1000;
        low = std::max(low, 0.3);
        high = std::min(high, 10.0);
    }
    return z > low - 1e-9 && z < high + 1e-9 ? z : 0;
}

glm::dvec3 turn(const glm::dquat& q, const glm::dvec3& p) {
    const double w = q.w, x = q.x, y = q.y, z = q.z;
    return {
        (1 - 2 * (y * y + z * z)) * p.x + 2 * (x * y - w * z) * p.y + 2 * (x * z + w * y) * p.z,
        2 * (x * y + w * z) * p.x + (1 - 2 * (x * x + z * z)) * p.y + 2 * (y * z - w * x) * p.z,
        2 * (x * z - w * y) * p.x + 2 * (y * z + w * x) * p.y + (1 - 2 * (x * x + y * y)) * p.z};
}

void keep_nearest(double& place, double z) {
    if (place == 0 || z < place) place = z;
}

}  // namespace

Image<glm::dvec2> rays(const CameraModel& camera) {
    const double limit = fold_radius(camera);
    Image<glm::dvec2> out(camera.width, camera.height);
    for (int y = 0; y < camera.height; ++y) {
        for (int x = 0; x < camera.width; ++x) {
            out.at(x, y) = unproject(camera, limit, {x, y}).value_or(glm::dvec2(kNaN));
        }
    }
    return out;
}

Registration register_depth(const RigParameters& rig, const Image<glm::dvec2>& depth_rays,
                            const DepthFrame& frame, double occlusion_margin_m) {
    const int width = frame.raw.width();
    const int height = frame.raw.height();
    const CameraModel& color = *rig.color;
    const double limit = fold_radius(color);
    const double ratio = std::max(color.fx / rig.depth.fx, color.fy / rig.depth.fy);
    int square = 1;
    while (square < ratio - 0.1 && square < std::max(color.width, color.height)) ++square;

    Registration out{Image<double>(width, height, 0),
                     Image<glm::dvec2>(width, height, glm::dvec2(kNaN)),
                     Image<double>(width, height, 0),
                     Image<glm::dvec2>(width, height, glm::dvec2(kNaN)),
                     Image<double>(width, height, 0),
                     Image<std::uint8_t>(width, height, 0),
                     Image<double>(color.width, color.height, 0)};
    Image<double> squares(color.width / square + 1, color.height / square + 1, 0);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const double z = decode(rig, frame, frame.raw.at(x, y));
            out.depth_m.at(x, y) = z;
            const glm::dvec2 ray = depth_rays.at(x, y);
            if (z == 0 || std::isnan(ray.x)) continue;
            const glm::dvec3 seen = turn(rig.color_from_depth.rotation, {z * ray.x, z * ray.y, z}) +
                                    rig.color_from_depth.translation;
            const auto uv = project(color, limit, seen);
            if (!uv) continue;
            out.place.at(x, y) = *uv;
            out.place_z.at(x, y) = seen.z;
            const double column = std::nearbyint(uv->x);
            const double row = std::nearbyint(uv->y);
            if (!(uv->x >= -0.5 && uv->x < color.width - 0.5)) continue;
            if (!(uv->y >= -0.5 && uv->y < color.height - 0.5)) continue;
            out.uv.at(x, y) = *uv;
            out.z_in_color.at(x, y) = seen.z;
            const int u = static_cast<int>(column);
            const int v = static_cast<int>(row);
            keep_nearest(out.depth_in_color_m.at(u, v), seen.z);
            keep_nearest(squares.at(u / square, v / square), seen.z);
        }
    }
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const double z = out.z_in_color.at(x, y);
            if (z == 0) continue;
            const glm::dvec2 uv = out.uv.at(x, y);
            const double nearest = squares.at(static_cast<int>(std::nearbyint(uv.x)) / square,
                                              static_cast<int>(std::nearbyint(uv.y)) / square);
            const double two_steps = 2 * 0.00307 * z * z;
            out.hidden.at(x, y) = z > nearest + occlusion_margin_m + two_steps ? 1 : 0;
        }
    }
    return out;
}

}  // namespace kino::reference
