#pragma once

#include <optional>
#include <string>

#include "base/error.h"
#include "base/pose.h"

namespace kino {

/// Pinhole camera with Brown-Conrady distortion in OpenCV's order of terms. Camera axes: right-
/// handed, x right, y down, z forward, metres. Pixel centres are at integers: the image covers
/// [-0.5, width-0.5] x [-0.5, height-0.5].
struct CameraModel {
    int width = 0;                  ///< px
    int height = 0;                 ///< px
    double fx = 0, fy = 0;          ///< focal length, px
    double cx = 0, cy = 0;          ///< principal point, px
    double k1 = 0, k2 = 0, k3 = 0;  ///< radial numerator
    double k4 = 0, k5 = 0, k6 = 0;  ///< radial denominator (rational model)
    double p1 = 0, p2 = 0;          ///< tangential

    [[nodiscard]] bool has_distortion() const {
        return k1 != 0 || k2 != 0 || k3 != 0 || k4 != 0 || k5 != 0 || k6 != 0 || p1 != 0 || p2 != 0;
    }
    friend bool operator==(const CameraModel&, const CameraModel&) = default;
};

/// Kinect-type triangulation from the device's zero plane (libfreenect registration.c):
/// m = p ((raw - 4 S)/4 - 0.375), z_mm = 10 (m R/(E - m) + R). Lengths as the device states them.
struct DisparityParameters {
    double const_shift = 200;                 ///< S, px of the reference pattern
    double reference_pixel_size_mm = 0.1042;  ///< p
    double reference_distance_cm = 120;       ///< R
    double emitter_distance_cm = 7.5;         ///< E, projector to infrared camera
    friend bool operator==(const DisparityParameters&, const DisparityParameters&) = default;
};

/// Everything that is known about how one sensor's cameras stand to each other. A plain value;
/// calibration/rig.h puts it to work.
struct RigParameters {
    CameraModel depth;
    std::optional<CameraModel> color;  ///< none: a depth-only device or clip
    Pose color_from_depth;
    DisparityParameters disparity;
    double min_depth_m = 0.3;   ///< readings nearer are invalid
    double max_depth_m = 10.0;  ///< readings farther are invalid
    std::string serial;         ///< of the device, empty if unknown
    std::string note;           ///< what a user should know, e.g. "depth only, roughly metric"
    friend bool operator==(const RigParameters&, const RigParameters&) = default;
};

/// Refuses NaN, zero or negative focal lengths, empty images and ranges, bad poses; says which.
[[nodiscard]] Result<void> validate(const CameraModel& camera, const std::string& name);
[[nodiscard]] Result<void> validate(const RigParameters& rig);

/// Kinect v1 defaults (docs/overview.md): depth 571.26 px at 640x480, colour 531.15 px, 25 mm
/// baseline, principal points at the image centres, no distortion.
[[nodiscard]] RigParameters default_kinect1_rig(int depth_width = 640, int depth_height = 480);

}  // namespace kino
