#pragma once

#include <array>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <optional>

#include "base/camera_model.h"
#include "base/error.h"
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

/// A screen that is looked through as through a window. Window space: origin in its centre, x to
/// the viewer's right, y up, z towards the viewer, metres.
struct WindowScreen {
    glm::dvec2 size_m{0.52, 0.32};
    Pose world_from_window;
    friend bool operator==(const WindowScreen&, const WindowScreen&) = default;
};

/// Nearer to the screen than this no eye is taken to be: the frustum would open without bound.
constexpr double kNearestEyeM = 0.15;

/// What an eye at `eye_m` (window space) sees through the screen, which the picture fills: the
/// general perspective of Kooima ("Generalized Perspective Projection", 2009), in pixels. An eye
/// nearer than kNearestEyeM, or behind the screen, is moved straight out to it.
[[nodiscard]] View window_view(const WindowScreen& screen, const glm::dvec3& eye_m, int width,
                               int height, double near_m = 0.05);

/// The screen with these corners (lower left, lower right, upper left as its viewer sees it), in
/// the world. Fails, naming the corner, where they are no rectangle within 2 degrees, too close
/// together, or seen from behind by an eye at `viewer`.
[[nodiscard]] Result<WindowScreen> window_from_corners(const std::array<glm::dvec3, 3>& corners,
                                                       const glm::dvec3& viewer);

/// Vulkan clip from view space: y down, infinite far plane, reversed depth (near -> 1, inf -> 0).
[[nodiscard]] glm::dmat4 clip_from_view(const View& view);

/// Pixel (integer centres) of a world point; none where it is nearer than the near plane.
[[nodiscard]] std::optional<glm::dvec2> project_to_pixel(const View& view, const glm::dvec3& world);

}  // namespace kino
