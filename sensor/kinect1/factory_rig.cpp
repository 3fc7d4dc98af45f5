#include "sensor/kinect1/factory_rig.h"

#include <fmt/format.h>

#include "sensor/kinect1/color_fit.h"
#include "sensor/kinect1/registration_map.h"

namespace kino::kinect1 {
namespace {

constexpr double kWorstRmsPx = 1;
constexpr double kWorstPx = 4;

void show_high_resolution(CameraModel& color) {
    constexpr int kLinesAbove = 32;
    color.width = 1280;
    color.height = 1024;
    color.fx *= 2;
    color.fy *= 2;
    color.cx = 2 * color.cx + 0.5;
    color.cy = 2 * color.cy + 0.5 + kLinesAbove;
}

}  // namespace

RigParameters factory_rig(const FactoryData& data, CameraMode color, const std::string& serial) {
    RigParameters rig = default_kinect1_rig();
    rig.serial = serial;
    rig.disparity = disparity_of(data);
    const char* const disparity =
        data.zero_plane ? "the device's zero plane" : "default zero plane";
    const auto fall_back = [&](const std::string& why) {
        rig.note = fmt::format("default cameras, {}: {}", disparity, why);
    };
    if (!data.registration || !data.zero_plane) {
        fall_back(data.problems.empty() ? "the device keeps no registration" : data.problems);
    } else {
        const ZeroPlane& plane = *data.zero_plane;
        CameraModel depth = rig.depth;
        depth.fx = depth.fy = plane.reference_distance_cm / (2 * plane.reference_pixel_size_mm);
        const RegistrationMap map(*data.registration, data.padding, plane);
        const ColorFit fit = fit_color_camera(
            [&map](int x, int y, double z) { return map.at(x, y, z); }, depth,
            RegistrationMap::kWidth, RegistrationMap::kHeight, plane.color_distance_cm / 100);
        if (fit.rms_px <= kWorstRmsPx && fit.max_px <= kWorstPx &&
            validate(fit.color, "colour camera")) {
            rig.depth = depth;
            rig.color = fit.color;
            rig.color_from_depth = fit.color_from_depth;
            rig.note = fmt::format(
                "factory calibration, {:.2f} px rms, {:.2f} px at worst against "
                "the device's own tables",
                fit.rms_px, fit.max_px);
        } else {
            fall_back("no camera comes near the device's registration tables");
        }
    }
    if (color == CameraMode::color_bayer_high) show_high_resolution(*rig.color);
    return rig;
}

}  // namespace kino::kinect1
