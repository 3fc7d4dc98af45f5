#pragma once

#include <glm/mat4x4.hpp>
#include <optional>

#include "base/camera_model.h"
#include "base/pose.h"

namespace kino {

/// A general (off-axis) perspective in pixels, as of a pinhole camera without distortion: a view-
/// space point (x, y, z) falls on pixel (fx x/z + cx, fy y/z + cy), pixel centres at integers.
/// View space has camera axes: x right, y down, z forward, metres.
struct Projection {
    double fx = 0, fy = 0;  ///< px
    double cx = 0, cy = 0;  ///< px; anywhere, so a window's frustum fits too
    double near_m = 0.05;
    friend bool operator==(const Projection&, const Projection&) = default;
};

/// One picture to be made of a scene.
struct View {
    int id = 0;  ///< history belongs to a view
    int width = 0;
    int height = 0;
    Projection projection;
    Pose world_from_view;
    friend bool operator==(const View&, const View&) = default;
};

/// Symmetric perspective of the given vertical field of view.
[[nodiscard]] Projection perspective(double vertical_fov_rad, int width, int height,
                                     double near_m = 0.05);

/// What the depth camera itself sees, scaled to fit a picture of width x height (letterboxed).
/// At the camera's own size every depth pixel falls on the centre of one picture pixel.
[[nodiscard]] View sensor_view(const CameraModel& depth, const Pose& world_from_depth, int width,
                               int height);

/// Camera that looks from `eye` to `target`; `up` is the world's (y). Eye and target must differ;
/// looking straight along `up` keeps the last resort axis x.
[[nodiscard]] Pose look_at(const glm::dvec3& eye, const glm::dvec3& target,
                           const glm::dvec3& up = {0, 1, 0});

/// Vulkan clip from view space: y down, infinite far plane, reversed depth (near -> 1, inf -> 0).
[[nodiscard]] glm::dmat4 clip_from_view(const View& view);

/// Pixel (integer centres) of a world point; none where it is nearer than the near plane.
[[nodiscard]] std::optional<glm::dvec2> project_to_pixel(const View& view, const glm::dvec3& world);

}  // namespace kino
