#include "calibration/solve/initial.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <opencv2/calib3d.hpp>

#include "base/check.h"

namespace kino {
namespace {

void gather(const Shots& shots, const std::vector<ShotCorner>& view,
            std::vector<cv::Point3f>& board, std::vector<cv::Point2f>& seen) {
    for (const ShotCorner& corner : view) {
        const glm::dvec2 at = shots.corners_m[static_cast<std::size_t>(corner.id)];
        board.emplace_back(static_cast<float>(at.x), static_cast<float>(at.y), 0.0f);
        seen.emplace_back(static_cast<float>(corner.px.x), static_cast<float>(corner.px.y));
    }
}

}  // namespace

Lens initial_lens(const Shots& shots, std::size_t camera) {
    const CameraShots& own = shots.cameras[camera];
    const double guess = own.width / (2 * std::tan(0.5236));
    Lens lens{};
    lens[0] = lens[1] = guess;
    lens[2] = (own.width - 1) / 2.0;
    lens[3] = (own.height - 1) / 2.0;
    std::vector<std::vector<cv::Point3f>> boards;
    std::vector<std::vector<cv::Point2f>> seen;
    for (const auto& view : own.views) {
        if (view.size() < 6) continue;
        gather(shots, view, boards.emplace_back(), seen.emplace_back());
    }
    if (boards.empty()) return lens;
    try {
        const cv::Mat k = cv::initCameraMatrix2D(boards, seen, {own.width, own.height}, 1.0);
        const double f = k.at<double>(0, 0);
        if (std::isfinite(f) && f > 0.2 * own.width && f < 20 * own.width) lens[0] = lens[1] = f;
    } catch (const cv::Exception&) {
        // Points on a line: the guess has to do.
    }
    return lens;
}

std::optional<Pose> initial_pose(const Shots& shots, std::size_t camera, std::size_t view,
                                 const Lens& lens) {
    const auto& corners = shots.cameras[camera].views[view];
    if (corners.size() < 4) return std::nullopt;
    std::vector<cv::Point3f> board;
    std::vector<cv::Point2f> seen;
    gather(shots, corners, board, seen);
    const cv::Matx33d k(lens[0], 0, lens[2], 0, lens[1], lens[3], 0, 0, 1);
    const std::vector<double> distortion(lens.begin() + 4, lens.end());
    cv::Vec3d rotation;
    cv::Vec3d translation;
    try {
        // For flat boards, without iterations.
        if (!cv::solvePnP(board, seen, k, distortion, rotation, translation, false,
                          cv::SOLVEPNP_IPPE))
            return std::nullopt;
    } catch (const cv::Exception&) {
        return std::nullopt;
    }
    const Pose pose = pose_of(
        {rotation[0], rotation[1], rotation[2], translation[0], translation[1], translation[2]});
    if (!is_valid(pose) || !(translation[2] > 0)) return std::nullopt;
    return pose;
}

double rotation_angle_rad(const Pose& pose) {
    const glm::dvec3 axis(pose.rotation.x, pose.rotation.y, pose.rotation.z);
    return 2 * std::atan2(glm::length(axis), std::abs(pose.rotation.w));
}

Pose middle_pose(const std::vector<Pose>& poses) {
    KINO_CHECK(!poses.empty());
    const auto total = [&](const Pose& one) {
        double sum = 0;
        for (const Pose& other : poses) {
            const Pose step = inverse(one) * other;
            sum += glm::length(step.translation) + rotation_angle_rad(step);
        }
        return sum;
    };
    return *std::min_element(poses.begin(), poses.end(),
                             [&](const Pose& a, const Pose& b) { return total(a) < total(b); });
}

}  // namespace kino
