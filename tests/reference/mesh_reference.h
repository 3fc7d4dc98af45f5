#pragma once

#include <array>
#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "base/image.h"
#include "viz/scene/scene.h"
#include "viz/scene/view.h"

namespace kino::test {

/// What the ray through a pixel's centre meets first.
struct MeshHit {
    int node = -1;  ///< index into Scene::meshes; -1: nothing
    std::uint32_t triangle = 0;
    double view_z_m = 0;
    glm::dvec3 view_normal{0};  ///< of the side that is seen, interpolated, unit
};

/// Every triangle against every pixel's ray, in double precision: the slow, obvious picture.
/// Skinned meshes are blended per vertex in double.
[[nodiscard]] Image<MeshHit> cast_meshes(const Scene& scene, const View& view);

/// Vertices of a node in world space: skinned if it has a pose; with normals.
struct WorldVertices {
    std::vector<glm::dvec3> positions;
    std::vector<glm::dvec3> normals;  ///< unit
};
[[nodiscard]] WorldVertices place_vertices(const MeshNode& node);

/// Whether a triangle has any part inside the view's frustum (near plane and four sides), by
/// clipping it as a polygon.
[[nodiscard]] bool in_frustum(const View& view, const std::array<glm::dvec3, 3>& view_corners);

}  // namespace kino::test
