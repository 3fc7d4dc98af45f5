#include "tests/calibration/solve/synthetic_boards.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <optional>

#include "calibration/projection.h"

namespace kino::test {
namespace {

constexpr double kPi = 3.14159265358979323846;

std::optional<glm::dvec2> inside(const Projection& camera, const glm::dvec3& point) {
    const auto px = camera.project(point);
    if (!px || px->x < 0 || px->y < 0 || px->x > camera.camera().width - 1 ||
        px->y > camera.camera().height - 1) {
        return std::nullopt;
    }
    return px;
}

}  // namespace

double normal(Random& random) {
    const double radius = std::sqrt(-2 * std::log(1 - random.real(0, 1)));
    return radius * std::cos(2 * kPi * random.real(0, 1));
}

RigParameters typical_rig() {
    RigParameters rig = default_kinect1_rig();
    rig.depth.fx = 581.3;
    rig.depth.fy = 582.1;
    rig.depth.cx = 315.2;
    rig.depth.cy = 243.7;
    rig.depth.k1 = -0.09;
    rig.depth.k2 = 0.18;
    rig.depth.p1 = 0.0008;
    rig.depth.p2 = -0.0005;
    CameraModel& color = *rig.color;
    color.fx = 528.4;
    color.fy = 527.2;
    color.cx = 325.1;
    color.cy = 251.6;
    color.k1 = 0.19;
    color.k2 = -0.4;
    color.p1 = -0.0011;
    color.p2 = 0.0009;
    rig.color_from_depth = {glm::angleAxis(0.02, glm::normalize(glm::dvec3(0.3, 0.9, -0.2))),
                            {-0.0251, 0.0007, -0.003}};
    return rig;
}

BoardScene make_scene(const RigParameters& rig, const BoardSceneOptions& options) {
    BoardScene scene{rig, {}, {}};
    for (int id = 0; id < options.columns * options.rows; ++id) {
        scene.corners_m.push_back(options.square_m *
                                  glm::dvec2(id % options.columns, id / options.columns));
    }
    const glm::dvec3 middle(scene.corners_m.back() / 2.0, 0);
    const Projection first(rig.depth);
    const Projection second(*rig.color);
    Random random(options.seed);
    while (static_cast<int>(scene.first_from_board.size()) < options.views) {
        const double around = random.real(0, 2 * kPi);
        const double tilt =
            random.real(options.least_tilt_deg, options.largest_tilt_deg) * kPi / 180;
        const glm::dquat rotation =
            glm::angleAxis(tilt, glm::dvec3(std::cos(around), std::sin(around), 0)) *
            glm::angleAxis(random.real(-0.3, 0.3), glm::dvec3(0, 0, 1));
        const double z = random.real(options.nearest_m, options.farthest_m);
        const double reach = 0.5 * options.spread;
        const glm::dvec3 place(z * random.real(-reach, reach),
                               z * random.real(-reach, reach) * 0.75, z);
        const Pose pose{glm::normalize(rotation), place - rotation * middle};
        const bool seen = std::all_of(
            scene.corners_m.begin(), scene.corners_m.end(), [&](const glm::dvec2& corner) {
                const glm::dvec3 p = pose * glm::dvec3(corner, 0);
                return inside(first, p) && inside(second, rig.color_from_depth * p);
            });
        if (seen) scene.first_from_board.push_back(pose);
    }
    return scene;
}

Shots photograph(const BoardScene& scene, double noise_px, std::uint64_t seed) {
    Random random(seed);
    const RigParameters& rig = scene.rig;
    Shots shots;
    shots.corners_m = scene.corners_m;
    shots.cameras = {{"infrared", rig.depth.width, rig.depth.height, {}},
                     {"color", rig.color->width, rig.color->height, {}}};
    const Projection first(rig.depth);
    const Projection second(*rig.color);
    for (std::size_t view = 0; view < scene.first_from_board.size(); ++view) {
        shots.names.push_back(fmt::format("view {}", view));
        for (CameraShots& camera : shots.cameras) camera.views.emplace_back();
        for (std::size_t id = 0; id < scene.corners_m.size(); ++id) {
            const glm::dvec3 p = scene.first_from_board[view] * glm::dvec3(scene.corners_m[id], 0);
            const glm::dvec2 a = *first.project(p);
            const glm::dvec2 b = *second.project(rig.color_from_depth * p);
            const auto noise = [&] {
                const double x = normal(random);
                return noise_px * glm::dvec2(x, normal(random));
            };
            shots.cameras[0].views.back().push_back({static_cast<int>(id), a + noise()});
            shots.cameras[1].views.back().push_back({static_cast<int>(id), b + noise()});
        }
    }
    return shots;
}

}  // namespace kino::test
