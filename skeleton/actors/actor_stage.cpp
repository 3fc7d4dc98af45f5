#include "skeleton/actors/actor_stage.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

namespace kino {
namespace {

using glm::dmat3;
using glm::dvec3;

dmat3 yawed(double rad) {
    return glm::mat3_cast(glm::angleAxis(rad, dvec3(0, 1, 0)));
}

Primitive block(const dvec3& center, const dvec3& half, const dmat3& turn = dmat3(1)) {
    return box(center, half, kPartThing, Covering::wood, turn);
}

}  // namespace

Pose camera_pose(double height_m, double tilt_down_rad) {
    Pose pose;
    pose.rotation = glm::normalize(glm::angleAxis(-tilt_down_rad, dvec3(1, 0, 0)) *
                                   world_from_camera_axes().rotation);
    pose.translation = {0, height_m, 0};
    return pose;
}

void to_view(const Pose& view_from_world, std::vector<glm::vec3>& points) {
    const glm::mat3 turn(glm::mat3_cast(view_from_world.rotation));
    const glm::vec3 shift(view_from_world.translation);
    for (glm::vec3& p : points) p = turn * p + shift;
}

double seat_height(const ActorBody& body, const std::vector<glm::vec3>& posed) {
    double lowest = 1e9;
    for (std::size_t i = 0; i < body.first_two_sided; ++i) {
        const BodyPart part = body.part[i];
        if (part != BodyPart::belly_left && part != BodyPart::belly_right &&
            part != BodyPart::thigh_left_high && part != BodyPart::thigh_right_high) {
            continue;
        }
        for (const std::uint32_t v : body.triangles[i]) {
            lowest = std::min(lowest, static_cast<double>(posed[v].y));
        }
    }
    return lowest;
}

void add_chair(ActorRandom& random, const dvec3& at, const dvec3& forward, double seat_m,
               std::vector<Primitive>& out) {
    const double yaw = std::atan2(forward.x, forward.z);
    const dmat3 turn = yawed(yaw);
    const double half = random.in(0.19, 0.27), thick = random.in(0.015, 0.05);
    const auto place = [&](double x, double y, double z) {
        return dvec3(at.x, 0, at.z) + turn * dvec3(x, y, z);
    };
    const double seat_z = random.in(-0.02, 0.08);
    out.push_back(block(place(0, seat_m - thick, seat_z), {half, thick, half}, turn));
    if (random.chance(0.75)) {  // a back; armchairs are wider
        const double high = random.in(0.20, 0.40);
        out.push_back(block(place(0, seat_m + high, seat_z - half - 0.04),
                            {half * random.in(0.8, 1.0), high, 0.02}, turn));
    }
    if (random.chance(0.2)) {
        for (const double s : {-1.0, 1.0}) {
            out.push_back(
                block(place(s * (half + 0.07), seat_m + 0.1, seat_z), {0.04, 0.10, half}, turn));
        }
    }
    if (random.chance(0.4)) {  // closed below
        out.push_back(block(place(0, seat_m / 2, seat_z),
                            {half, std::max(0.02, seat_m / 2 - thick), half}, turn));
    } else {
        for (const double sx : {-1.0, 1.0}) {
            for (const double sz : {-1.0, 1.0}) {
                out.push_back(
                    block(place(sx * (half - 0.02), seat_m / 2, seat_z + sz * (half - 0.02)),
                          {0.02, seat_m / 2, 0.02}, turn));
            }
        }
    }
}

void add_table(ActorRandom& random, const dvec3& at, double yaw_rad, std::vector<Primitive>& out) {
    const dmat3 turn = yawed(yaw_rad);
    const double top = random.in(0.68, 0.80), wide = random.in(0.4, 0.9),
                 deep = random.in(0.25, 0.5);
    const auto place = [&](double x, double y, double z) {
        return dvec3(at.x, 0, at.z) + turn * dvec3(x, y, z);
    };
    out.push_back(block(place(0, top, 0), {wide, 0.02, deep}, turn));
    if (random.chance(0.35)) {
        out.push_back(block(place(0, top / 2, deep - 0.03), {wide, top / 2 - 0.01, 0.015}, turn));
    }
    for (const double sx : {-1.0, 1.0}) {
        for (const double sz : {-1.0, 1.0}) {
            out.push_back(block(place(sx * (wide - 0.04), top / 2, sz * (deep - 0.04)),
                                {0.025, top / 2, 0.025}, turn));
        }
    }
    const int things = static_cast<int>(random.below(4));
    for (int i = 0; i < things; ++i) {
        const dvec3 size(random.in(0.03, 0.25), random.in(0.02, 0.20), random.in(0.02, 0.12));
        out.push_back(block(
            place(random.in(-wide, wide) * 0.8, top + 0.02 + size.y, random.in(-deep, deep) * 0.7),
            size, turn * yawed(random.in(-0.5, 0.5))));
    }
}

void add_thing(ActorRandom& random, const dvec3& at, std::vector<Primitive>& out) {
    const dmat3 turn = yawed(random.in(0, M_PI));
    if (random.chance(0.3)) {
        const double radius = random.in(0.05, 0.25), high = random.in(0.3, 1.3);
        out.push_back(round_cone({at.x, radius, at.z}, {at.x, high, at.z}, radius,
                                 radius * random.in(0.4, 1.0), kPartThing, Covering::wood));
        return;
    }
    const dvec3 half(random.in(0.1, 0.5), random.in(0.15, 0.9), random.in(0.1, 0.35));
    out.push_back(block({at.x, half.y, at.z}, half, turn));
}

void add_room(double x0, double x1, double z0, double z1, double height_m,
              std::vector<Primitive>& out) {
    constexpr double kThick = 0.5;
    const dvec3 middle((x0 + x1) / 2, height_m / 2, (z0 + z1) / 2);
    const dvec3 half((x1 - x0) / 2 + kThick, height_m / 2 + kThick, (z1 - z0) / 2 + kThick);
    for (int axis = 0; axis < 3; ++axis) {
        for (const double s : {-1.0, 1.0}) {
            dvec3 center = middle, size = half;
            size[axis] = kThick / 2;
            center[axis] += s * (half[axis] - kThick / 2);
            out.push_back(block(center, size));
        }
    }
}

}  // namespace kino
