#pragma once

#include <array>
#include <cstdint>
#include <glm/mat4x4.hpp>
#include <vector>

#include "viz/scene/scene.h"
#include "viz/scene/view.h"
#include "viz/surface/mesh_pool.h"
#include "viz/surface/mesh_shared.h"

namespace kino {

/// Which nodes of a scene a pass draws.
enum class MeshFilter : std::uint8_t {
    opaque,  ///< material opacity at least 1, in the order of the scene
    blended  ///< below 1: farthest first (by the view depth of the bounding sphere's centre)
};

/// Every MaterialKind.
constexpr std::uint32_t kAllKinds = ~0u;

/// The draws of one view as the host makes them, before any culling.
struct MeshTable {
    std::vector<shared::MeshDraw> rows;
    std::vector<shared::MeshSkin> skins;  ///< what must be skinned before
    std::vector<glm::vec4> joint_rows;    ///< KINO_SKIN_*_ROWS a joint, of object_from_bind
    std::uint32_t skinned_vertices = 0;
    std::uint32_t formats = 0;  ///< bit mask of KINO_FORMAT_*
    std::uint32_t refused = 0;  ///< nodes whose matrices are not finite
    bool textured = false;
};

/// World poses are composed with the view in double and handed over relative to the camera.
/// Nodes without a mesh in the pool are left out.
/// Of materials of the kinds whose bit (1 << MaterialKind) is set.
[[nodiscard]] MeshTable make_mesh_table(const Scene& scene, const View& view, const MeshPool& pool,
                                        MeshFilter filter, std::uint32_t kinds = kAllKinds);

[[nodiscard]] bool is_blended(const Scene& scene, const MeshNode& node);
[[nodiscard]] MaterialKind kind_of(const Scene& scene, const MeshNode& node);

/// Largest factor by which `m` stretches any direction: its largest singular value, rounded up.
[[nodiscard]] double largest_stretch(const glm::dmat3& m);

/// Unit inward normals of the four planes through the eye, view space.
[[nodiscard]] std::array<glm::dvec3, 4> side_planes(const View& view);

/// Whether a view-space sphere may reach into the picture: false only where it provably does not,
/// and for what is not finite or has a negative radius. The culling shader's own test, in double.
[[nodiscard]] bool may_be_seen(const std::array<glm::dvec3, 4>& sides, double near_m,
                               const glm::dvec3& center, double radius_m);

/// The indirect call that draws a row.
[[nodiscard]] VkDrawIndexedIndirectCommand call_of(const shared::MeshDraw& draw, std::uint32_t row);

}  // namespace kino
