#include "calibration/solve/view_checks.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include "calibration/solve/initial.h"

namespace kino {
namespace {

constexpr std::size_t kLeastViews = 3;
constexpr double kLeastTiltDeg = 5;
constexpr double kLeastCoverage = 0.25;
constexpr int kFieldsX = 8;
constexpr int kFieldsY = 6;

std::string_view part_of_picture(const CameraShots& camera) {
    glm::dvec2 sum(0);
    double count = 0;
    for (const auto& view : camera.views) {
        for (const ShotCorner& corner : view) {
            sum += corner.px;
            ++count;
        }
    }
    const glm::dvec2 middle = sum / std::max(1.0, count);
    const double x = middle.x / camera.width;
    const double y = middle.y / camera.height;
    constexpr std::array<std::string_view, 9> kNames = {
        "the upper left corner", "the upper edge", "the upper right corner",
        "the left edge",         "the middle",     "the right edge",
        "the lower left corner", "the lower edge", "the lower right corner"};
    const auto third = [](double v) { return v < 0.4 ? 0 : v < 0.6 ? 1 : 2; };
    return kNames[static_cast<std::size_t>(third(y) * 3 + third(x))];
}

}  // namespace

double coverage(const CameraShots& camera) {
    std::array<bool, kFieldsX * kFieldsY> hit{};
    for (const auto& view : camera.views) {
        for (const ShotCorner& corner : view) {
            const int x = static_cast<int>((corner.px.x + 0.5) / camera.width * kFieldsX);
            const int y = static_cast<int>((corner.px.y + 0.5) / camera.height * kFieldsY);
            hit[static_cast<std::size_t>(std::clamp(y, 0, kFieldsY - 1) * kFieldsX +
                                         std::clamp(x, 0, kFieldsX - 1))] = true;
        }
    }
    return static_cast<double>(std::count(hit.begin(), hit.end(), true)) / (kFieldsX * kFieldsY);
}

double largest_tilt_deg(const Shots& shots, std::size_t camera) {
    const CameraShots& own = shots.cameras[camera];
    const auto size = static_cast<double>(own.width);
    const Lens lens = {size, size, (size - 1) / 2, (own.height - 1) / 2.0};
    std::vector<glm::dvec3> normals;
    for (std::size_t view = 0; view < own.views.size(); ++view) {
        if (const auto pose = initial_pose(shots, camera, view, lens)) {
            normals.push_back(pose->rotation * glm::dvec3(0, 0, 1));
        }
    }
    double least = 1;
    for (const auto& a : normals) {
        for (const auto& b : normals) least = std::min(least, std::abs(glm::dot(a, b)));
    }
    return std::acos(std::clamp(least, -1.0, 1.0)) * 180 / 3.14159265358979323846;
}

Result<void> check_views(const Shots& shots, std::size_t camera) {
    const CameraShots& own = shots.cameras[camera];
    const auto seen = static_cast<std::size_t>(std::count_if(
        own.views.begin(), own.views.end(), [](const auto& view) { return !view.empty(); }));
    if (seen < kLeastViews) {
        return fail(fmt::format("{} view{} the board; at least {} are needed", seen,
                                seen == 1 ? " shows" : "s show", kLeastViews),
                    own.name, "take 15 to 30 pictures with the board in all parts and tilts");
    }
    const double tilt = largest_tilt_deg(shots, camera);
    if (tilt < kLeastTiltDeg) {
        return fail(fmt::format("all boards are parallel to each other within {:.1f} degrees: the "
                                "focal length cannot be told from the distance",
                                tilt),
                    own.name, "tilt the board by 20 to 45 degrees, to each side once");
    }
    const double covered = coverage(own);
    if (covered < kLeastCoverage) {
        return fail(fmt::format("the boards are in one part of the picture only ({}, {:.0f} % of "
                                "its fields): the lens elsewhere stays unknown",
                                part_of_picture(own), 100 * covered),
                    own.name, "bring the board to every corner of the picture, and nearer");
    }
    return {};
}

}  // namespace kino
