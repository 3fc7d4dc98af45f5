#include "apps/demo/solid.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "apps/stage/stage.h"

namespace kino::demo {
namespace {

/// Of the way from the player to the camera: where the glass is.
constexpr double kGlassPart = 0.72;
/// A sheet catches what is this far behind it.
constexpr double kSheetM = 0.3;

struct Placed {
    glm::dvec3 at{0}, scale{1};
    glm::dmat3 turn{1};
};

Placed taken_apart(const glm::dmat4& m) {
    Placed placed{.at = glm::dvec3(m[3])};
    for (int k = 0; k < 3; ++k) {
        const double length = glm::length(glm::dvec3(m[k]));
        placed.scale[k] = length;
        placed.turn[k] = length > 1e-9 ? glm::dvec3(m[k]) / length : glm::dvec3(0);
        if (!(length > 1e-9)) placed.turn[k][k] = 1;
    }
    return placed;
}

void add_walls(const SceneMesh& mesh, const Placed& placed, std::vector<Solid>& out) {
    const glm::dvec3 half = 0.5 * mesh.size_m * placed.scale;
    const glm::dvec3 middle = placed.at + placed.turn * glm::dvec3(0, half.y, 0);
    for (int axis = 0; axis < 3; ++axis) {
        for (const double side : {-1.0, 1.0}) {
            const glm::dvec3 normal = -side * placed.turn[axis];
            out.push_back({.kind = SolidKind::half_space,
                           .normal = normal,
                           .offset_m = glm::dot(normal, middle) - half[axis]});
        }
    }
}

Contact pushed_out_of_box(const glm::dvec3& local, const glm::dvec3& half, double radius) {
    int axis = 0;
    double least = 1e300;
    for (int k = 0; k < 3; ++k) {
        const double deep = half[k] - std::abs(local[k]);
        if (deep < least) least = deep, axis = k;
    }
    Contact contact{.normal = glm::dvec3(0), .depth_m = least + radius};
    contact.normal[axis] = local[axis] < 0 ? -1 : 1;
    return contact;
}

/// From the nearest point of a convex solid that the ball's middle is outside of.
std::optional<Contact> from_nearest(const glm::dvec3& local, const glm::dvec3& nearest,
                                    double radius) {
    const double distance = glm::distance(local, nearest);
    if (!(distance < radius)) return std::nullopt;
    if (distance < 1e-9) return Contact{.normal = {0, 1, 0}, .depth_m = radius};
    return Contact{.normal = (local - nearest) / distance, .depth_m = radius - distance};
}

std::optional<Contact> touch_box(const glm::dvec3& local, const glm::dvec3& half, double radius) {
    const glm::dvec3 nearest = glm::clamp(local, -half, half);
    if (nearest == local) return pushed_out_of_box(local, half, radius);
    return from_nearest(local, nearest, radius);
}

std::optional<Contact> touch_cylinder(const glm::dvec3& local, const glm::dvec3& half,
                                      double radius) {
    const double out = std::hypot(local.x, local.z);
    const glm::dvec3 aside =
        out > 1e-9 ? glm::dvec3(local.x / out, 0, local.z / out) : glm::dvec3(1, 0, 0);
    if (out < half.x && std::abs(local.y) < half.y) {
        if (half.x - out < half.y - std::abs(local.y)) {
            return Contact{.normal = aside, .depth_m = half.x - out + radius};
        }
        return Contact{.normal = {0, local.y < 0 ? -1 : 1, 0},
                       .depth_m = half.y - std::abs(local.y) + radius};
    }
    glm::dvec3 nearest = std::min(out, half.x) * aside;
    nearest.y = std::clamp(local.y, -half.y, half.y);
    return from_nearest(local, nearest, radius);
}

}  // namespace

std::optional<Contact> touch(const Solid& solid, const glm::dvec3& at_m, double radius_m) {
    if (solid.kind == SolidKind::half_space) {
        const double depth = radius_m + solid.offset_m - glm::dot(solid.normal, at_m);
        if (!(depth > 0)) return std::nullopt;
        return Contact{.normal = solid.normal, .depth_m = depth};
    }
    const glm::dvec3 local = glm::transpose(solid.stage_from_solid) * (at_m - solid.center_m);
    std::optional<Contact> contact;
    switch (solid.kind) {
        case SolidKind::half_space:
            break;
        case SolidKind::sheet:
            if (std::abs(local.x) < solid.half_m.x && std::abs(local.z) < solid.half_m.z &&
                local.y < radius_m && local.y > -kSheetM) {
                contact = Contact{.depth_m = radius_m - local.y};
            }
            break;
        case SolidKind::box:
            contact = touch_box(local, solid.half_m, radius_m);
            break;
        case SolidKind::sphere:
            contact = from_nearest(local, glm::dvec3(0), radius_m + solid.half_m.x);
            break;
        case SolidKind::cylinder:
            contact = touch_cylinder(local, solid.half_m, radius_m);
            break;
    }
    if (contact) contact->normal = solid.stage_from_solid * contact->normal;
    return contact;
}

RoomBox room_of(const SceneFile& file) {
    RoomBox box;
    for (const SceneMesh& mesh : file.meshes) {
        if (mesh.shape != SceneShape::room) continue;
        for (const glm::dmat4& place : mesh_places(mesh)) {
            const Placed placed = taken_apart(place);
            const glm::dvec3 half = 0.5 * mesh.size_m * placed.scale;
            glm::dvec3 reach(0);
            for (int k = 0; k < 3; ++k) reach += glm::abs(placed.turn[k]) * half[k];
            const glm::dvec3 middle = placed.at + placed.turn * glm::dvec3(0, half.y, 0);
            const glm::dvec3 off = glm::abs(glm::dvec3(0, 1, 0) - middle);
            if (off.x >= reach.x || off.y >= reach.y || off.z >= reach.z) continue;
            return {.least_m = middle - reach, .most_m = middle + reach, .walls = true};
        }
    }
    return box;
}

std::vector<Solid> solids_of(const SceneFile& file) {
    std::vector<Solid> solids, last;
    const bool has_room = room_of(file).walls;
    for (const SceneMesh& mesh : file.meshes) {
        for (const glm::dmat4& place : mesh_places(mesh)) {
            const Placed placed = taken_apart(place);
            Solid solid{.center_m = placed.at,
                        .stage_from_solid = placed.turn,
                        .half_m = 0.5 * mesh.size_m * placed.scale};
            const glm::dvec3 up_half = placed.turn * glm::dvec3(0, solid.half_m.y, 0);
            switch (mesh.shape) {
                case SceneShape::box:
                    break;
                case SceneShape::sphere:
                    solid.kind = SolidKind::sphere;
                    solid.half_m.x = (solid.half_m.x + solid.half_m.y + solid.half_m.z) / 3;
                    break;
                case SceneShape::cylinder:
                    solid.kind = SolidKind::cylinder;
                    solid.half_m.x = 0.5 * (solid.half_m.x + solid.half_m.z);
                    break;
                case SceneShape::column:
                    solid.kind = SolidKind::cylinder;
                    solid.half_m.x = 0.5 * (solid.half_m.x + solid.half_m.z);
                    solid.center_m += up_half;
                    break;
                case SceneShape::chair:
                    solid.center_m += up_half;
                    break;
                case SceneShape::plane:
                    solid.kind = SolidKind::sheet;
                    break;
                case SceneShape::room:
                    // One that the stage is in; nobody could be in another one as well.
                    if (has_room && last.empty()) add_walls(mesh, placed, last);
                    continue;
                case SceneShape::gltf:
                    continue;
            }
            solids.push_back(solid);
        }
    }
    const double glass_z =
        file.camera.target_m.z + kGlassPart * (file.camera.eye_m.z - file.camera.target_m.z);
    last.push_back({.kind = SolidKind::half_space,
                    .normal = {0, 0, -1},
                    .offset_m = -std::max(glass_z, 0.8),
                    .screen = true});
    last.push_back({.kind = SolidKind::half_space});  // the floor
    solids.insert(solids.end(), last.begin(), last.end());
    return solids;
}

}  // namespace kino::demo
