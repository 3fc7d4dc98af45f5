#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/reference/light_reference.h"
#include "viz/scene/scene.h"
#include "viz/scene/view.h"

namespace kino::test {

/// Solids that a ray can be cast at, so that a surface exists without anything drawn. World.
struct Solid {
    enum class Kind : std::uint8_t { sphere, box, room } kind = Kind::sphere;
    glm::dvec3 center{0};
    glm::dvec3 half{1};  ///< half extents; sphere: radius in x. A room is a box seen from inside
    Rgba8 color{200, 200, 200, 255};
    std::uint32_t material = 0;
};
[[nodiscard]] reference::LitSurface surface_of(const std::vector<Solid>& solids, const View& view,
                                               bool with_objects = false);

/// A surface, its view and its lights.
struct LitScene {
    std::string name;
    Scene scene;
    View view;
    std::vector<Solid> solids;
    reference::LitSurface surface;
};

/// A room with boxes and balls in it and lights of any kind and size, all by chance.
[[nodiscard]] LitScene random_lit_scene(std::uint64_t seed, int width, int height, int lights);

/// The cases that break cullers, by name.
[[nodiscard]] std::vector<LitScene> adversarial_lit_scenes(int width, int height);

/// The source's measurement: a hall full of columns and `lights` small lights, radii such that a
/// pixel needs `wanted_mean` of them (found by bisection on every eighth pixel).
[[nodiscard]] LitScene source_scene(int width, int height, int lights, double wanted_mean);

/// Near columns before a far wall, and lights in the gap: great differences of depth in most tiles.
[[nodiscard]] LitScene colonnade(int width, int height, int lights);

/// 3,072 lights need a radius of this for the mean wanted (source_scene() finds it); the cut-off
/// eps gives light of intensity I a radius sqrt(I / eps).
[[nodiscard]] double radius_of(double intensity, double eps);

}  // namespace kino::test
