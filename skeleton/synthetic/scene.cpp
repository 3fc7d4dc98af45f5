#include "skeleton/synthetic/scene.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "calibration/projection.h"
#include "skeleton/synthetic/body_flesh.h"

namespace kino {
namespace {

using glm::dvec3;

// A joint within this distance behind a surface still counts as seen: it lies inside the flesh.
constexpr double kJointDepthM = 0.02;

double hit_box(const dvec3& o, const dvec3& d, const dvec3& half, double t_max) {
    double enter = -INFINITY, leave = INFINITY;
    for (int axis = 0; axis < 3; ++axis) {
        const double a = (-half[axis] - o[axis]) / d[axis], b = (half[axis] - o[axis]) / d[axis];
        enter = std::max(enter, std::min(a, b));
        leave = std::min(leave, std::max(a, b));
    }
    return enter <= leave && enter > 0 ? std::min(enter, t_max) : t_max;
}

double hit_ball(const dvec3& o, const dvec3& d, double radius, double t_max) {
    const double a = glm::dot(d, d), b = glm::dot(o, d), c = glm::dot(o, o) - radius * radius;
    const double disc = b * b - a * c;
    if (disc < 0) return t_max;
    const double t = (-b - std::sqrt(disc)) / a;
    return t > 0 ? std::min(t, t_max) : t_max;
}

double hit_cone(const Primitive& p, const dvec3& o, const dvec3& d, double t_max) {
    double t = hit_ball(o, d, p.radius_a, t_max);
    if (p.height == 0) return t;
    t = hit_ball(o - dvec3(0, p.height, 0), d, p.radius_b, t);
    const double s = (p.radius_a - p.radius_b) / p.height, c2 = 1 - s * s;
    const double k = p.radius_a - s * o.y;
    const double a = c2 * (d.x * d.x + d.z * d.z) - s * s * d.y * d.y;
    const double b = c2 * (o.x * d.x + o.z * d.z) + s * d.y * k;
    const double c = c2 * (o.x * o.x + o.z * o.z) - k * k;
    const double disc = b * b - a * c;
    if (disc < 0) return t;
    const double side = (-b - std::sqrt(disc)) / a, y = o.y + side * d.y;
    const bool on_side = y >= p.radius_a * s && y <= p.height + p.radius_b * s;
    return on_side && side > 0 ? std::min(side, t) : t;
}

bool finite(const dvec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

}  // namespace

double first_hit(std::span<const Primitive> solids, const dvec3& origin, const dvec3& direction,
                 double t_max) {
    double t = t_max;
    for (const Primitive& p : solids) {
        const glm::dmat3 to_local = glm::inverse(p.axes);
        const dvec3 o = to_local * (origin - p.origin_m), d = to_local * direction;
        t = p.kind == Primitive::Kind::box ? hit_box(o, d, p.half, t) : hit_cone(p, o, d, t);
    }
    return t;
}

void SyntheticScene::person_at(double t_s, std::vector<Primitive>& out) const {
    out.clear();
    if (person) append_flesh(pose_body(pose(t_s)), out);
}

std::vector<Body> SyntheticScene::bodies_at(double t_s) const {
    if (!person) return {};
    const PosedBody posed = pose_body(pose(t_s));
    const Pose depth_from_world = inverse(world_from_depth);
    const Projection projection(rig.depth);
    Body body;
    body.id = 1;
    for (std::size_t i = 0; i < kJointCount; ++i) {
        const dvec3 seen = depth_from_world * posed.joint_m[i];
        const auto pixel = projection.project(seen);
        const bool in_picture = pixel && pixel->x >= -0.5 && pixel->y >= -0.5 &&
                                pixel->x < rig.depth.width - 0.5 &&
                                pixel->y < rig.depth.height - 0.5;
        const dvec3 line = posed.joint_m[i] - world_from_depth.translation;
        const double reach = 1 - kJointDepthM / std::max(glm::length(line), kJointDepthM);
        const bool hidden = first_hit(furniture, world_from_depth.translation, line, reach) < reach;
        const bool tracked = in_picture && !hidden;
        body.joints[i] = {glm::vec3(seen), tracked ? JointState::tracked : JointState::inferred,
                          tracked ? 1.0f : 0.5f};
    }
    return {body};
}

SyntheticScene make_scene(Motion motion, int width, int height) {
    SyntheticScene scene;
    scene.furniture = make_furniture();
    scene.motion = motion;
    const double tilt = -3.0 * 3.14159265358979323846 / 180;
    scene.world_from_depth =
        Pose{glm::angleAxis(tilt, dvec3(1, 0, 0)), dvec3(0, 1.05, 0)} * world_from_camera_axes();
    scene.rig = default_kinect1_rig(width, height);
    CameraModel color;
    color.width = 640;
    color.height = 480;
    color.fx = 527.4;
    color.fy = 526.6;
    color.cx = 322.7;
    color.cy = 243.1;
    color.k1 = 0.062;
    color.k2 = -0.11;
    color.p1 = 0.0006;
    color.p2 = -0.0009;
    scene.rig.color = scaled(color, width, height);
    scene.rig.color_from_depth = {glm::normalize(glm::dquat(1.0, 0.0020, -0.0031, 0.0012)),
                                  {-0.025, 0.0006, -0.0011}};
    scene.rig.serial = "synthetic";
    scene.rig.note = "made by computation, not recorded";
    return scene;
}

Result<void> validate(const SyntheticScene& scene) {
    KINO_TRY(validate(scene.rig));
    if (!is_valid(scene.world_from_depth)) {
        return fail("the camera's pose is not a rigid transform of finite numbers",
                    "world_from_depth");
    }
    for (const Primitive& p : scene.furniture) {
        if (!finite(p.origin_m) || !finite(p.axes[0]) || !finite(p.axes[1]) || !finite(p.axes[2]) ||
            !std::isfinite(p.height + p.radius_a + p.radius_b) || !finite(p.half)) {
            return fail("a solid of the scene has a size or place that is not finite", "furniture");
        }
    }
    if (!(scene.seconds > 0) || !(scene.seconds < 3600)) {
        return fail("the recording's length is not between 0 and an hour", "seconds");
    }
    const dvec3 size = scene.room.max_m - scene.room.min_m;
    if (!finite(size) || !(size.x > 0) || !(size.y > 0) || !(size.z > 0)) {
        return fail("the room is empty or not finite", "room");
    }
    return {};
}

}  // namespace kino
