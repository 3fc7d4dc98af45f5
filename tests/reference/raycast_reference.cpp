#include "tests/reference/raycast_reference.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>

#include "calibration/disparity.h"
#include "tests/reference/registration_reference.h"

namespace kino::reference {
namespace {

using glm::dvec3;

constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr double kNearM = 1e-3;
constexpr double kShadowMarginM = 1e-3;
constexpr std::int32_t kRoomPlanes = 6;

// The ball at fraction s of a round cone's axis, cut by a local ray.
struct BallOnAxis {
    const Primitive& cone;
    dvec3 origin, direction;

    [[nodiscard]] dvec3 from_center(double s) const {
        return origin - dvec3(0, s * cone.height, 0);
    }
    [[nodiscard]] double discriminant(double s) const {
        const double r = cone.radius_a + s * (cone.radius_b - cone.radius_a);
        const dvec3 oc = from_center(s);
        // |d|^2 r^2 - |o x d|^2: the distance of the line from the centre, against the radius.
        const dvec3 moment = glm::cross(oc, direction);
        return glm::dot(direction, direction) * r * r - glm::dot(moment, moment);
    }
    [[nodiscard]] double entry(double s) const {
        return (-glm::dot(from_center(s), direction) - std::sqrt(std::max(discriminant(s), 0.0))) /
               glm::dot(direction, direction);
    }
};

double golden_minimum(const BallOnAxis& ball, double lo, double hi) {
    constexpr double kGolden = 0.6180339887498949;
    double a = hi - kGolden * (hi - lo), b = lo + kGolden * (hi - lo);
    double at_a = ball.entry(a), at_b = ball.entry(b);
    for (int i = 0; i < 90; ++i) {
        if (at_a < at_b) {
            hi = b;
            b = a;
            at_b = at_a;
            a = hi - kGolden * (hi - lo);
            at_a = ball.entry(a);
        } else {
            lo = a;
            a = b;
            at_a = at_b;
            b = lo + kGolden * (hi - lo);
            at_b = ball.entry(b);
        }
    }
    return std::min({at_a, at_b, ball.entry(lo), ball.entry(hi)});
}

double enter_round_cone(const Primitive& cone, const dvec3& origin, const dvec3& direction) {
    const BallOnAxis ball{cone, origin, direction};
    // The discriminant is a quadratic in s: its roots cut the axis into pieces that the ray's line
    // meets or misses as a whole.
    const double d0 = ball.discriminant(0), d1 = ball.discriminant(1);
    const double dm = ball.discriminant(0.5);
    const double a = 2 * (d0 + d1 - 2 * dm), b = d1 - d0 - a;
    double first = 0, second = 0;
    const double under = b * b - 4 * a * d0;
    if (under > 0) {
        const double q = -0.5 * (b + std::copysign(std::sqrt(under), b));
        first = std::clamp(a != 0 ? q / a : 0.0, 0.0, 1.0);
        second = std::clamp(q != 0 ? d0 / q : 0.0, 0.0, 1.0);
    }
    const std::array<double, 4> cuts = {0, std::min(first, second), std::max(first, second), 1};
    double best = kNever;
    for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
        if (cuts[i] == cuts[i + 1]) continue;
        if (ball.discriminant((cuts[i] + cuts[i + 1]) / 2) < 0) continue;
        best = std::min(best, golden_minimum(ball, cuts[i], cuts[i + 1]));
    }
    return best;
}

// The face that is hit is the one whose rectangle holds the point and whose outside the ray comes
// from.
double enter_box(const dvec3& half, const dvec3& origin, const dvec3& direction) {
    double best = kNever;
    for (int face = 0; face < 6; ++face) {
        const int axis = face / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
        const double outward = face % 2 == 0 ? -1 : 1;
        if (direction[axis] * outward >= 0) continue;
        const double t = (outward * half[axis] - origin[axis]) / direction[axis];
        const dvec3 p = origin + direction * t;
        if (std::abs(p[u]) <= half[u] && std::abs(p[v]) <= half[v]) best = std::min(best, t);
    }
    return best;
}

RayHit hit_room(const RoomBox& room, const dvec3& origin, const dvec3& direction) {
    RayHit hit{kNever, -1};
    for (int face = 0; face < 6; ++face) {
        const int axis = face / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
        const double wall = face % 2 == 0 ? room.min_m[axis] : room.max_m[axis];
        const double t = (wall - origin[axis]) / direction[axis];
        if (!(t > 0)) continue;
        const dvec3 p = origin + direction * t;
        constexpr double kSeam = 1e-12;
        if (p[u] < room.min_m[u] - kSeam || p[u] > room.max_m[u] + kSeam ||
            p[v] < room.min_m[v] - kSeam || p[v] > room.max_m[v] + kSeam) {
            continue;
        }
        if (t < hit.t) hit = {t, face};
    }
    return hit;
}

}  // namespace

RaycastWorld raycast_world(const SyntheticScene& scene, double t_s) {
    RaycastWorld world{&scene, scene.furniture, {}, {}};
    std::vector<Primitive> person;
    scene.person_at(t_s, person);
    for (std::size_t i = 0; i < scene.furniture.size(); ++i) {
        world.ids.push_back(static_cast<std::int32_t>(i));
    }
    for (const Primitive& p : person) {
        world.ids.push_back(static_cast<std::int32_t>(world.solids.size()) + kRoomPlanes);
        world.solids.push_back(p);
    }
    for (const Primitive& p : world.solids) world.to_local.push_back(glm::inverse(p.axes));
    return world;
}

double enter_solid(const Primitive& solid, const glm::dmat3& to_local, const dvec3& origin,
                   const dvec3& direction, double from) {
    const dvec3 o = to_local * (origin - solid.origin_m), d = to_local * direction;
    const double t = solid.kind == Primitive::Kind::box ? enter_box(solid.half, o, d)
                                                        : enter_round_cone(solid, o, d);
    return t > from ? t : kNever;
}

RayHit cast_ray(const RaycastWorld& world, const dvec3& origin, const dvec3& direction) {
    RayHit hit = hit_room(world.scene->room, origin, direction);
    if (hit.id >= 0) hit.id += static_cast<std::int32_t>(world.scene->furniture.size());
    for (std::size_t i = 0; i < world.solids.size(); ++i) {
        const double t = enter_solid(world.solids[i], world.to_local[i], origin, direction, kNearM);
        if (t < hit.t) hit = {t, world.ids[i]};
    }
    return hit;
}

RaycastPicture raycast_depth(const SyntheticScene& scene, double t_s) {
    const CameraModel& camera = scene.rig.depth;
    const Image<glm::dvec2> camera_rays = rays(camera);
    const RaycastWorld world = raycast_world(scene, t_s);
    const Disparity disparity(scene.rig.disparity, scene.rig.min_depth_m, scene.rig.max_depth_m);
    const Pose& pose = scene.world_from_depth;
    const dvec3 emitter(scene.emitter_x_m(), 0, 0);
    RaycastPicture out{Image<double>(camera.width, camera.height),
                       Image<std::int32_t>(camera.width, camera.height, -1),
                       Image<std::uint8_t>(camera.width, camera.height),
                       Image<std::uint16_t>(camera.width, camera.height, Disparity::kNoReading)};
    for (int y = 0; y < camera.height; ++y) {
        for (int x = 0; x < camera.width; ++x) {
            const glm::dvec2 ray = camera_rays.at(x, y);
            const dvec3 direction(ray.x, ray.y, 1);
            const RayHit hit = cast_ray(world, pose.translation, pose.rotation * direction);
            if (hit.id < 0) continue;
            out.depth_m.at(x, y) = hit.t;
            out.id.at(x, y) = hit.id;
            // t of the emitter's ray counts depth too, so both rays compare.
            const dvec3 from_emitter = direction - emitter / hit.t;
            bool lit = true;
            for (std::size_t i = 0; lit && i < world.solids.size(); ++i) {
                lit = !(enter_solid(world.solids[i], world.to_local[i], pose * emitter,
                                    pose.rotation * from_emitter, kNearM) < hit.t - kShadowMarginM);
            }
            out.lit.at(x, y) = lit ? 1 : 0;
            if (lit) out.raw.at(x, y) = disparity.raw(hit.t);
        }
    }
    return out;
}

}  // namespace kino::reference
