#include "calibration/solve/reprojection.h"

#include <glm/geometric.hpp>

namespace kino {
namespace {

// By a pose's six numbers, of a value with gradient `by_point` where the pose puts `p`. With
// d(R(w) p)/dw = -R [p]x J(w) the rotation's part is J^T (p x R^T by_point).
void put_pose(const PreparedPose& pose, const glm::dvec3& p, const glm::dvec3& by_point,
              double* out) {
    const glm::dvec3 rotation = glm::cross(p, by_point * pose.rotation) * pose.jacobian;
    for (int i = 0; i < 3; ++i) {
        out[i] = rotation[i];
        out[i + 3] = by_point[i];
    }
}

}  // namespace

PreparedPose prepare(const TurnedPose& pose) {
    const glm::dvec3 w(pose[0], pose[1], pose[2]);
    return {rotation_of(w), right_jacobian(w), {pose[3], pose[4], pose[5]}};
}

bool reproject(const double* lens, const PreparedPose* camera_from_first,
               const PreparedPose& first_from_board, const glm::dvec2& corner_m, glm::dvec2& px,
               ReprojectionJacobian* jacobian) {
    const glm::dvec3 corner(corner_m, 0);
    const glm::dvec3 first = first_from_board.rotation * corner + first_from_board.translation;
    const glm::dvec3 p = camera_from_first
                             ? camera_from_first->rotation * first + camera_from_first->translation
                             : first;
    if (!(p.z > 1e-6)) return false;
    const auto [fx, fy, cx, cy] = std::array{lens[0], lens[1], lens[2], lens[3]};
    const auto [k1, k2, p1, p2] = std::array{lens[4], lens[5], lens[6], lens[7]};
    const auto [k3, k4, k5, k6] = std::array{lens[8], lens[9], lens[10], lens[11]};
    const double x = p.x / p.z;
    const double y = p.y / p.z;
    const double s = x * x + y * y;
    const double numerator = 1 + s * (k1 + s * (k2 + s * k3));
    const double denominator = 1 + s * (k4 + s * (k5 + s * k6));
    if (!(denominator > 1e-6)) return false;
    const double g = numerator / denominator;
    const double dx = g * x + 2 * p1 * x * y + p2 * (s + 2 * x * x);
    const double dy = g * y + p1 * (s + 2 * y * y) + 2 * p2 * x * y;
    px = {fx * dx + cx, fy * dy + cy};
    if (!jacobian) return true;

    const double slope = ((k1 + s * (2 * k2 + s * 3 * k3)) * denominator -
                          numerator * (k4 + s * (2 * k5 + s * 3 * k6))) /
                         (denominator * denominator);
    const double xx = g + 2 * slope * x * x + 2 * p1 * y + 6 * p2 * x;
    const double xy = 2 * slope * x * y + 2 * p1 * x + 2 * p2 * y;
    const double yy = g + 2 * slope * y * y + 6 * p1 * y + 2 * p2 * x;
    const double inverse_z = 1 / p.z;
    const glm::dvec3 du = fx * inverse_z * glm::dvec3(xx, xy, -(xx * x + xy * y));
    const glm::dvec3 dv = fy * inverse_z * glm::dvec3(xy, yy, -(xy * x + yy * y));

    const double up = 1 / denominator;
    const double down = -g / denominator;
    const std::array<double, 12> by_x = {dx,
                                         0,
                                         1,
                                         0,
                                         s * up * x,
                                         s * s * up * x,
                                         2 * x * y,
                                         s + 2 * x * x,
                                         s * s * s * up * x,
                                         s * down * x,
                                         s * s * down * x,
                                         s * s * s * down * x};
    const std::array<double, 12> by_y = {0,
                                         dy,
                                         0,
                                         1,
                                         s * up * y,
                                         s * s * up * y,
                                         s + 2 * y * y,
                                         2 * x * y,
                                         s * s * s * up * y,
                                         s * down * y,
                                         s * s * down * y,
                                         s * s * s * down * y};
    for (std::size_t i = 0; i < 12; ++i) {
        jacobian->lens[i] = i < 4 ? by_x[i] : fx * by_x[i];
        jacobian->lens[i + 12] = i < 4 ? by_y[i] : fy * by_y[i];
    }
    glm::dvec3 du_first = du;
    glm::dvec3 dv_first = dv;
    if (camera_from_first) {
        put_pose(*camera_from_first, first, du, jacobian->camera.data());
        put_pose(*camera_from_first, first, dv, jacobian->camera.data() + 6);
        du_first = du * camera_from_first->rotation;
        dv_first = dv * camera_from_first->rotation;
    } else {
        jacobian->camera.fill(0);
    }
    put_pose(first_from_board, corner, du_first, jacobian->board.data());
    put_pose(first_from_board, corner, dv_first, jacobian->board.data() + 6);
    return true;
}

}  // namespace kino
