#pragma once

#include <glm/gtc/quaternion.hpp>
#include <opencv2/core.hpp>

#include "base/camera_model.h"

namespace kino {

// The task the peers were timed on (OpenCV, librealsense, Azure): a PrimeSense depth camera, a
// colour camera 25 mm beside it, turned by 5 mrad.
inline RigParameters make_rig(int width, int height, bool distorted) {
    RigParameters rig;
    rig.depth = {.width = width, .height = height, .fx = 575.8, .fy = 575.8};
    rig.depth.cx = (width - 1) / 2.0;
    rig.depth.cy = (height - 1) / 2.0;
    CameraModel color = rig.depth;
    color.fx = color.fy = 525;
    if (distorted) {
        color.k1 = 0.05;
        color.k2 = -0.1;
        color.p1 = 0.001;
        color.p2 = -0.001;
        color.k3 = 0.02;
    }
    rig.color = color;
    rig.color_from_depth = {glm::angleAxis(0.005, glm::dvec3(0, 1, 0)), {-0.025, 0, 0}};
    // OpenCV has no limits of range.
    rig.min_depth_m = 0;
    rig.max_depth_m = 65;
    return rig;
}

inline cv::Matx33d matrix(const CameraModel& c) {
    return {c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1};
}

inline cv::Matx44d matrix(const Pose& pose) {
    const glm::dmat4 m = pose.matrix();
    cv::Matx44d out;
    for (int row = 0; row < 4; ++row) {
        for (int column = 0; column < 4; ++column) out(row, column) = m[column][row];
    }
    return out;
}

}  // namespace kino
