#include "viz/scene/view.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace kino {

Projection perspective(double vertical_fov_rad, int width, int height, double near_m) {
    const double f = 0.5 * height / std::tan(0.5 * vertical_fov_rad);
    return {.fx = f, .fy = f, .cx = (width - 1) / 2.0, .cy = (height - 1) / 2.0, .near_m = near_m};
}

View sensor_view(const CameraModel& depth, const Pose& world_from_depth, int width, int height) {
    const double scale = std::min(static_cast<double>(width) / depth.width,
                                  static_cast<double>(height) / depth.height);
    // Scaling acts on pixel corners, centres sit half a pixel inside.
    const double left = (width - scale * depth.width) / 2;
    const double top = (height - scale * depth.height) / 2;
    return {.width = width,
            .height = height,
            .projection = {.fx = depth.fx * scale,
                           .fy = depth.fy * scale,
                           .cx = (depth.cx + 0.5) * scale + left - 0.5,
                           .cy = (depth.cy + 0.5) * scale + top - 0.5},
            .world_from_view = world_from_depth};
}

Pose look_at(const glm::dvec3& eye, const glm::dvec3& target, const glm::dvec3& up) {
    const glm::dvec3 forward = glm::normalize(target - eye);
    glm::dvec3 right = glm::cross(forward, up);
    if (glm::dot(right, right) < 1e-12) right = glm::dvec3(1, 0, 0);
    right = glm::normalize(right);
    const glm::dvec3 down = glm::cross(forward, right);
    return {glm::normalize(glm::quat_cast(glm::dmat3(right, down, forward))), eye};
}

View window_view(const WindowScreen& screen, const glm::dvec3& eye_m, int width, int height,
                 double near_m) {
    const glm::dvec3 eye{eye_m.x, eye_m.y, std::max(eye_m.z, kNearestEyeM)};
    const double px_per_m_x = width / screen.size_m.x;
    const double px_per_m_y = height / screen.size_m.y;
    // A point of the screen falls on one pixel wherever the eye is: that gives all four numbers.
    return {
        .width = width,
        .height = height,
        .projection = {.fx = eye.z * px_per_m_x,
                       .fy = eye.z * px_per_m_y,
                       .cx = (0.5 * screen.size_m.x + eye.x) * px_per_m_x - 0.5,
                       .cy = (0.5 * screen.size_m.y - eye.y) * px_per_m_y - 0.5,
                       .near_m = near_m},
        .world_from_view = screen.world_from_window * Pose{world_from_camera_axes().rotation, eye}};
}

Result<WindowScreen> window_from_corners(const std::array<glm::dvec3, 3>& corners,
                                         const glm::dvec3& viewer) {
    constexpr double kLeastSideM = 0.02;
    constexpr double kSquare = 0.035;  // sin of 2 degrees
    const char* const where = "the screen's corners";
    const glm::dvec3 along = corners[1] - corners[0];
    const glm::dvec3 up = corners[2] - corners[0];
    const glm::dvec2 size{glm::length(along), glm::length(up)};
    if (!(size.x >= kLeastSideM))
        return fail("the lower right is not apart from the lower left", where);
    if (!(size.y >= kLeastSideM))
        return fail("the upper left is not apart from the lower left", where);
    const glm::dvec3 x = along / size.x;
    if (!(std::abs(glm::dot(x, up / size.y)) <= kSquare)) {
        return fail("the upper left is not straight above the lower left", where,
                    "the three must form a right angle");
    }
    const glm::dvec3 y = glm::normalize(up - glm::dot(up, x) * x);
    const glm::dvec3 z = glm::cross(x, y);
    const glm::dvec3 center = corners[0] + 0.5 * (along + up);
    if (!(glm::dot(viewer - center, z) > 0)) {
        return fail("the screen is seen from behind: lower left and lower right may be swapped",
                    where);
    }
    return WindowScreen{
        .size_m = size,
        .world_from_window = {glm::normalize(glm::quat_cast(glm::dmat3(x, y, z))), center}};
}

glm::dmat4 clip_from_view(const View& view) {
    const Projection& p = view.projection;
    glm::dmat4 m(0.0);
    m[0][0] = 2 * p.fx / view.width;
    m[1][1] = 2 * p.fy / view.height;
    m[2][0] = 2 * (p.cx + 0.5) / view.width - 1;
    m[2][1] = 2 * (p.cy + 0.5) / view.height - 1;
    m[2][3] = 1;
    m[3][2] = p.near_m;
    return m;
}

std::optional<glm::dvec2> project_to_pixel(const View& view, const glm::dvec3& world) {
    const glm::dvec3 p = inverse(view.world_from_view) * world;
    if (!(p.z >= view.projection.near_m)) return std::nullopt;
    return glm::dvec2(view.projection.fx * p.x / p.z + view.projection.cx,
                      view.projection.fy * p.y / p.z + view.projection.cy);
}

}  // namespace kino
