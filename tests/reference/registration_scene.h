#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "base/camera_model.h"
#include "base/frame.h"
#include "base/image.h"

namespace kino::reference {

/// Rectangles and balls in the depth camera's space, cut by rays in closed form: what both cameras
/// of a rig would see if they measured without error.
struct RegistrationScene {
    struct Rectangle {
        glm::dvec3 centre;
        glm::dvec3 half_x;  ///< from the centre to the middle of a side
        glm::dvec3 half_y;  ///< at right angles to half_x
    };
    struct Ball {
        glm::dvec3 centre;
        double radius = 0;
    };
    std::vector<Rectangle> rectangles;
    std::vector<Ball> balls;

    /// Nearest along origin + t direction, t > 0; `object` counts rectangles first, then balls.
    struct Hit {
        double t = 0;
        int object = -1;  ///< -1: nothing
    };
    [[nodiscard]] Hit cast(const glm::dvec3& origin, const glm::dvec3& direction) const;
};

/// A room: slanted walls, boxes, a ball, and rods from 1 to 40 mm thick.
[[nodiscard]] RegistrationScene registration_room();

/// What the depth camera measures, without noise: whole units; pixels without a ray hold 0.
[[nodiscard]] DepthFrame depth_frame(const RegistrationScene& scene, const RigParameters& rig,
                                     const Image<glm::dvec2>& depth_rays,
                                     double metres_per_unit = 0.0001);

/// What is true of the pixels of both cameras.
struct RegistrationTruth {
    /// Of each colour pixel, m from the colour camera; 0 where its ray meets nothing.
    Image<double> depth_in_color_m;
    Image<int> object_in_color;
    /// 1 where the depth camera sees that point too, at least `clear_px` depth pixels away from
    /// everything that stands before it, and inside its picture.
    Image<std::uint8_t> measured;
    /// Of each depth pixel: 1 where the colour camera sees its point, and inside its picture.
    Image<std::uint8_t> seen_by_color;
    Image<int> object_in_depth;
};
[[nodiscard]] RegistrationTruth registration_truth(const RegistrationScene& scene,
                                                   const RigParameters& rig,
                                                   const Image<glm::dvec2>& depth_rays,
                                                   const Image<glm::dvec2>& color_rays,
                                                   double clear_px = 1);

}  // namespace kino::reference
