#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "apps/pipeline/processed_frame.h"
#include "viz/scene/scene.h"

namespace kino {

/// Where the things in a depth frame are: what cameras turn around and lights are hung about.
struct ScenePlace {
    glm::dvec3 center{0};  ///< world; at median depth, in the middle of what is seen
    Pose world_from_depth;
    double distance_m = 2;  ///< from the depth camera to the centre
};

/// Measures a sample of the points. A frame without points is taken to be about 2 m ahead.
[[nodiscard]] ScenePlace measure_place(const ProcessedFrame& frame);

/// A set-up that suits bare depth: a key light from the upper left, a warm and a cool lamp to
/// either side, between the camera and the things.
[[nodiscard]] std::vector<Light> studio_lights(const ScenePlace& place);

}  // namespace kino
