#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <vector>

#include "viz/scene/scene_file.h"

namespace kino::demo {

enum class SolidKind : std::uint8_t {
    half_space,  ///< free where normal . p >= offset
    sheet,       ///< a rectangle with one side, x by z, free above
    box,
    sphere,
    cylinder  ///< along y
};

/// Something that balls bounce off, in stage space.
struct Solid {
    SolidKind kind = SolidKind::box;
    glm::dvec3 center_m{0};
    glm::dmat3 stage_from_solid{1};  ///< a rotation
    glm::dvec3 half_m{0.5};          ///< sphere: x is the radius; cylinder: x radius, y half height
    glm::dvec3 normal{0, 1, 0};      ///< half-spaces only
    double offset_m = 0;
    bool screen = false;  ///< the glass before the picture: felt, not seen
};

struct Contact {
    glm::dvec3 normal{0, 1, 0};  ///< out of the solid, unit length
    double depth_m = 0;          ///< that a ball is in it; > 0
};

/// Where a ball touches; empty: nowhere. Always finite for finite places.
[[nodiscard]] std::optional<Contact> touch(const Solid& solid, const glm::dvec3& at_m,
                                           double radius_m);

/// Edges of the room that a person on the stage is in: least and most, stage space.
struct RoomBox {
    glm::dvec3 least_m{-8, 0, -20}, most_m{8, 8, 8};
    bool walls = false;  ///< the scene has a room; else these are just far
};
[[nodiscard]] RoomBox room_of(const SceneFile& file);

/// What of a scene's meshes a ball can hit, the floor, and the glass in front of its camera; those
/// that nothing can be behind come last. Boxes, chairs and columns are what they look like, but
/// for chairs, which are boxes; ellipsoids are balls of their mean radius; models are not there.
[[nodiscard]] std::vector<Solid> solids_of(const SceneFile& file);

}  // namespace kino::demo
