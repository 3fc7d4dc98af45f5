#pragma once

#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

namespace kino {

/// What a pixel of the synthetic world shows. 1..20 are the person's parts: the joint (in the order
/// of base/body.h) that the flesh belongs to, plus one.
using PartId = std::uint8_t;
constexpr PartId kPartNone = 0;
constexpr PartId kPartFloor = 32;
constexpr PartId kPartCeiling = 33;
constexpr PartId kPartBackWall = 34;
constexpr PartId kPartFrontWall = 35;
constexpr PartId kPartLeftWall = 36;
constexpr PartId kPartRightWall = 37;
constexpr PartId kPartTable = 40;
constexpr PartId kPartChair = 41;
constexpr PartId kPartShelf = 42;
constexpr PartId kPartThing = 43;
constexpr PartId kPartLamp = 44;
constexpr PartId kPartPlant = 45;
constexpr PartId kPartPicture = 46;
[[nodiscard]] constexpr bool is_body_part(PartId part) {
    return part >= 1 && part <= 20;
}

enum class Covering : std::uint8_t {
    skin,
    lips,
    hair,
    eye_white,
    eye_iris,
    shirt,
    shirt_print,
    trousers,
    belt,
    shoe,
    sole,
    watch,
    wood,
    dark_wood,
    white_paint,
    metal,
    black,
    red,
    orange,
    yellow,
    green,
    leaf,
    blue,
    teal,
    purple,
    cream,
    clay,
    shade_cloth,
    picture,
    floor,
    wall,
    ceiling,
};
constexpr int kMaterialCount = 32;

/// One solid of the scene, seen only from outside (a camera within it looks through it). A point is
/// origin + axes * local. The axes may scale, so a round cone may have an elliptic cross section.
struct Primitive {
    enum class Kind : std::uint8_t { round_cone, box };
    Kind kind = Kind::round_cone;
    glm::dvec3 origin_m{0};
    glm::dmat3 axes{1};
    /// Round cone, local: hull of the ball of radius_a at 0 and of radius_b at (0, height, 0).
    /// Either height is 0 (a ball of radius_a) or height > |radius_a - radius_b|.
    double height = 0, radius_a = 0, radius_b = 0;
    glm::dvec3 half{0};  ///< box, local: |p| <= half
    PartId part = kPartNone;
    Covering material = Covering::black;
};

/// Hull of two balls; a zero length, or one ball inside the other, gives the larger ball.
/// Radii > 0, metres.
[[nodiscard]] Primitive round_cone(const glm::dvec3& a, const glm::dvec3& b, double radius_a,
                                   double radius_b, PartId part, Covering material);

/// As above with the cross section scaled by `wide` along `side` (made orthogonal to the axis) and
/// by `deep` across it.
[[nodiscard]] Primitive flat_cone(const glm::dvec3& a, const glm::dvec3& b, double radius_a,
                                  double radius_b, const glm::dvec3& side, double wide, double deep,
                                  PartId part, Covering material);

/// `rotation` columns are the directions of the radii.
[[nodiscard]] Primitive ellipsoid(const glm::dvec3& center, const glm::dmat3& rotation,
                                  const glm::dvec3& radii, PartId part, Covering material);

[[nodiscard]] Primitive box(const glm::dvec3& center, const glm::dvec3& half, PartId part,
                            Covering material, const glm::dmat3& rotation = glm::dmat3(1));

}  // namespace kino
