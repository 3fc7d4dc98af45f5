#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "base/image.h"
#include "viz/scene/mesh_asset.h"
#include "viz/surface/mesh_shared.h"

namespace kino {

/// Vertices of one mesh as words of the static pool, ready for the fetch of their format
/// (viz/surface/mesh_fetch.glsl). `first` counts from the start of these words in the format's own
/// unit: 32 bytes (static), 16 (grid: its head; cloud), 12 (quantized).
struct PackedVertices {
    std::uint32_t format = KINO_FORMAT_STATIC;
    std::vector<std::uint32_t> words;
    std::uint32_t corners = 0;  ///< how many numbers an index may have
    /// quantized: object = center + half * snorm.
    glm::vec3 center{0};
    glm::vec3 half{1};
};

/// F0: position, normal, uv as floats: 32 bytes.
[[nodiscard]] PackedVertices pack_static(const MeshAsset& mesh);
/// F3: a recorded point cloud; triangles take the colour of their first corner. 16 bytes.
[[nodiscard]] PackedVertices pack_cloud(std::span<const glm::vec3> positions,
                                        std::span<const Rgba8> colors);
/// F4: positions in 16-bit steps of their box, octahedral normals: 12 bytes, no uv.
[[nodiscard]] PackedVertices pack_quantized(const MeshAsset& mesh);

/// F2: a depth picture that the vertex shader unprojects itself; no vertex is stored. Corner
/// numbers run over cells, six each; a triangle with a corner without reading, or over an edge,
/// has no area. At most 65,535 units of depth.
struct DepthGrid {
    Image<std::uint16_t> depth;
    float metres_per_unit = 0.001f;
    float fx = 0, fy = 0, cx = 0, cy = 0;  ///< px, a plain pinhole's
    float edge_m = 0.075f;                 ///< corners that differ by more are not joined
};
[[nodiscard]] PackedVertices pack_grid(const DepthGrid& grid);

/// Whether a draw's bit field can hold these; checked when tables are built, not cut off.
[[nodiscard]] constexpr bool fits_draw_id(std::uint32_t format, std::uint64_t first_vertex) {
    return format < (1u << KINO_FORMAT_BITS) &&
           first_vertex < (std::uint64_t{1} << KINO_FIRST_VERTEX_BITS);
}

}  // namespace kino
