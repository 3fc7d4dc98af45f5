#include "base/camera_model.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <utility>

namespace kino {

Result<void> validate(const CameraModel& c, const std::string& name) {
    // 16384 bounds what a hostile calibration file can make us allocate.
    if (c.width <= 0 || c.height <= 0 || c.width > 16384 || c.height > 16384) {
        return fail(fmt::format("image size {}x{} is not usable", c.width, c.height), name,
                    "sizes run from 1 to 16384");
    }
    const std::array<std::pair<const char*, double>, 12> numbers = {{{"fx", c.fx},
                                                                     {"fy", c.fy},
                                                                     {"cx", c.cx},
                                                                     {"cy", c.cy},
                                                                     {"k1", c.k1},
                                                                     {"k2", c.k2},
                                                                     {"k3", c.k3},
                                                                     {"k4", c.k4},
                                                                     {"k5", c.k5},
                                                                     {"k6", c.k6},
                                                                     {"p1", c.p1},
                                                                     {"p2", c.p2}}};
    for (const auto& [key, value] : numbers) {
        if (!std::isfinite(value)) {
            return fail(fmt::format("calibration value {} is not a finite number", key), name);
        }
    }
    if (!(c.fx > 0) || !(c.fy > 0)) {
        return fail(fmt::format("focal length {} x {} px must be positive", c.fx, c.fy), name);
    }
    return {};
}

Result<void> validate(const RigParameters& rig) {
    KINO_TRY(validate(rig.depth, "depth camera"));
    if (rig.color) KINO_TRY(validate(*rig.color, "colour camera"));
    if (!is_valid(rig.color_from_depth)) {
        return fail("the pose from depth to colour is not a rigid transform", "color_from_depth");
    }
    const DisparityParameters& d = rig.disparity;
    if (!(d.reference_pixel_size_mm > 0) || !(d.reference_distance_cm > 0) ||
        !(d.emitter_distance_cm > 0) || !std::isfinite(d.const_shift) ||
        !std::isfinite(d.reference_pixel_size_mm * d.reference_distance_cm *
                       d.emitter_distance_cm)) {
        return fail("disparity parameters must be positive and finite", "disparity");
    }
    if (!(rig.min_depth_m >= 0) || !(rig.max_depth_m > rig.min_depth_m) ||
        !std::isfinite(rig.max_depth_m)) {
        return fail(
            fmt::format("depth range {} to {} m is empty", rig.min_depth_m, rig.max_depth_m),
            "depth range");
    }
    return {};
}

RigParameters default_kinect1_rig(int depth_width, int depth_height) {
    RigParameters rig;
    const double scale = depth_width / 640.0;
    rig.depth = {.width = depth_width,
                 .height = depth_height,
                 .fx = 571.26 * scale,
                 .fy = 571.26 * scale,
                 .cx = (depth_width - 1) / 2.0,
                 .cy = (depth_height - 1) / 2.0};
    rig.color = CameraModel{
        .width = 640, .height = 480, .fx = 531.15, .fy = 531.15, .cx = 319.5, .cy = 239.5};
    // The colour camera sits 25 mm to the side of the infrared one.
    rig.color_from_depth.translation = {-0.025, 0, 0};
    rig.min_depth_m = 0.4;
    rig.max_depth_m = 8.0;
    return rig;
}

}  // namespace kino
