#include "apps/stage/cutout.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <vector>

namespace kino {
namespace {

constexpr int kBlock = 4;  ///< px
/// Above the floor, so that what is left of it between the feet does not look like a rug.
constexpr double kFloorSkinM = 0.03;

struct Ball {
    glm::dvec3 center{0};
    double radius = 0;
};

/// What flesh adds to the margin round a joint.
double girth_of(Joint joint) {
    switch (joint) {
        case Joint::hip_center:
        case Joint::spine:
        case Joint::shoulder_center:
            return 0.09;
        case Joint::hip_left:
        case Joint::hip_right:
        case Joint::shoulder_left:
        case Joint::shoulder_right:
            return 0.05;
        case Joint::head:
            return 0.06;
        default:
            return 0;
    }
}

bool is_there(const JointPosition& joint) {
    return joint.state != JointState::lost && joint.position_m.z > 0.1f &&
           glm::length(joint.position_m) < 50.0f;
}

/// Who sits has no bones below the shoulders; the trunk hangs from them.
void add_trunk(const Body& body, double margin_m, std::vector<Ball>& balls) {
    const JointPosition& shoulders = body[Joint::shoulder_center];
    if (!is_there(shoulders) || is_there(body[Joint::hip_center])) return;
    for (int k = -2; k <= 6; ++k) {
        // y goes down.
        const glm::dvec3 at = glm::dvec3(shoulders.position_m) + glm::dvec3(0, 0.08 * k, 0);
        balls.push_back({at, margin_m + (k < 0 ? 0.02 : 0.14)});
    }
}

/// Spheres along every bone whose ends are known, close enough to overlap.
std::vector<Ball> balls_of(const BodyFrame& bodies, double margin_m) {
    std::vector<Ball> balls;
    for (const Body& body : bodies.bodies) {
        for (std::size_t i = 0; i < kJointCount; ++i) {
            const auto joint = static_cast<Joint>(i);
            const Joint parent = kJointParent[i];
            if (!is_there(body[joint])) continue;
            const glm::dvec3 to(body[joint].position_m);
            const double girth = margin_m + girth_of(joint);
            const bool whole = is_there(body[parent]);
            const glm::dvec3 from = whole ? glm::dvec3(body[parent].position_m) : to;
            const double from_girth = whole ? margin_m + girth_of(parent) : girth;
            const double length = glm::distance(from, to);
            if (length > 1.2) continue;
            const int steps = std::max(1, static_cast<int>(std::ceil(length / (0.5 * margin_m))));
            for (int k = 0; k <= steps; ++k) {
                const double t = static_cast<double>(k) / steps;
                balls.push_back({glm::mix(from, to, t), glm::mix(from_girth, girth, t)});
            }
        }
        add_trunk(body, margin_m, balls);
    }
    return balls;
}

struct Span {
    float near = std::numeric_limits<float>::max();
    float far = 0;
};

}  // namespace

std::shared_ptr<const DepthSurface> cut_out_people(const DepthSurface& surface,
                                                   const BodyFrame& bodies, double margin_m,
                                                   const Pose& world_from_depth,
                                                   std::optional<double> floor_y_m) {
    const int width = surface.depth_m.width(), height = surface.depth_m.height();
    const int columns = (width + kBlock - 1) / kBlock, rows = (height + kBlock - 1) / kBlock;
    // Which depths are kept along the ray of each block.
    std::vector<Span> spans(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
    const Image<RayXy>& rays = *surface.rays;
    const std::vector<Ball> balls = balls_of(bodies, margin_m);
    std::vector<glm::vec2> block_rays(spans.size(), glm::vec2(std::numeric_limits<float>::max()));
    for (int y = 0; y < rows; ++y) {
        for (int x = 0; x < columns; ++x) {
            const RayXy ray = rays.at(std::min(x * kBlock + kBlock / 2, width - 1),
                                      std::min(y * kBlock + kBlock / 2, height - 1));
            if (!std::isfinite(ray.x) || !std::isfinite(ray.y)) continue;
            block_rays[static_cast<std::size_t>(y * columns + x)] = {ray.x, ray.y};
        }
    }
    for (const Ball& ball : balls) {
        const auto near = static_cast<float>(ball.center.z - ball.radius);
        const auto far = static_cast<float>(ball.center.z + ball.radius);
        const glm::vec2 center(ball.center.x / ball.center.z, ball.center.y / ball.center.z);
        const auto aside = static_cast<float>(ball.radius / ball.center.z);
        for (std::size_t i = 0; i < spans.size(); ++i) {
            const glm::vec2 off = block_rays[i] - center;
            if (!(glm::dot(off, off) < aside * aside)) continue;
            spans[i].near = std::min(spans[i].near, near);
            spans[i].far = std::max(spans[i].far, far);
        }
    }
    auto cut = std::make_shared<DepthSurface>(surface);
    // World height of a point is a plane of its depth-camera coordinates.
    const glm::dvec3 up = glm::conjugate(world_from_depth.rotation) * glm::dvec3(0, 1, 0);
    const double lowest = floor_y_m ? *floor_y_m + kFloorSkinM : -1e9;
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            float& z = cut->depth_m.at(x, y);
            if (!(z > 0)) continue;
            const Span& span = spans[static_cast<std::size_t>(y / kBlock * columns + x / kBlock)];
            const RayXy ray = rays.at(x, y);
            const double height_m =
                world_from_depth.translation.y + z * (up.x * ray.x + up.y * ray.y + up.z);
            if (!(z > span.near && z < span.far && height_m > lowest)) z = 0;
        }
    }
    return cut;
}

}  // namespace kino
